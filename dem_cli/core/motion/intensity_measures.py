"""Intensity measures of a ground motion: strength, duration, and fit to a response spectrum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.motion.eurocode import LONGEST_PERIOD, TargetSpectrum
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.spectrum import response_spectrum
from dem_cli.core.motion.units import STANDARD_GRAVITY

SIGNIFICANT = (0.05, 0.95)  # shares of the Arias intensity between which the strong part lies
SHORTEST = 0.04  # s: where a comparison with a spectrum begins when T1 is not known
PERIODS = 100  # of a comparison
LEAST_MEAN = 0.90  # EN 1998-1 3.2.3.1.2(4)c
MOST_SAMPLES = 100_000  # samples


class IntensityMeasures(NamedTuple):
    """Intensity measures of one ground motion."""

    duration: float  # [s]
    acceleration: float  # largest absolute values [m/s2]
    velocity: float  # [m/s]
    displacement: float  # [m]
    arias: float  # π/(2g) ∫ a² dt [m/s]
    significant: float  # time between 5 % and 95 % of it [s]


class SpectrumFit(NamedTuple):
    """Fit of a suite of motions to a target spectrum, in the terms of EN 1998-1 3.2.3.1.2(4)."""

    periods: np.ndarray  # compared at [s], (n,)
    ratios: np.ndarray  # pseudo-acceleration over target, (n_motions, n)
    mean_peak: float  # mean of the peak accelerations over the ground acceleration of the target
    least_mean: float  # lowest mean ratio
    meets: bool  # mean peak ≥ 1 and lowest mean ratio ≥ 0.90


def strength(motion: Motion) -> IntensityMeasures:
    """Compute the intensity measures of a motion, from samples as close as it is made of."""
    times = motion.times(MOST_SAMPLES)
    acceleration = motion.acceleration(times)
    growth = np.diff(times) * 0.5 * (acceleration[1:] ** 2 + acceleration[:-1] ** 2)
    energy = np.concatenate(([0.0], np.cumsum(growth)))
    begin, end = np.interp(np.array(SIGNIFICANT) * energy[-1], energy, times)
    return IntensityMeasures(
        motion.duration,
        motion.peak,
        float(np.abs(motion.velocity(times)).max()),
        float(np.abs(motion.displacement(times)).max()),
        float(0.5 * np.pi / STANDARD_GRAVITY * energy[-1]),
        float(end - begin),
    )


def compared_periods(first_period: float | None = None) -> np.ndarray:
    """Periods at which Eurocode 8 compares, 0.2 T1 to 2 T1; where T1 is not known, 0.04 s to 4 s, (n,)."""
    low, high = (SHORTEST, LONGEST_PERIOD) if first_period is None else (0.2 * first_period, 2.0 * first_period)
    return functions.geometric(low, high, PERIODS)


def fit(motions: Sequence[Motion], target: TargetSpectrum, first_period: float | None = None) -> SpectrumFit:
    """Compare a suite of motions with its target spectrum."""
    periods = compared_periods(first_period)
    ratios = spectra(motions, periods, target.damping) / target(periods)
    mean_peak = float(np.mean([motion.peak for motion in motions])) / target.ground
    least_mean = float(ratios.mean(axis=0).min())
    meets = mean_peak >= 1.0 - 1e-9 and least_mean >= LEAST_MEAN
    return SpectrumFit(periods, ratios, mean_peak, least_mean, meets)


def spectra(motions: Sequence[Motion], periods: np.ndarray, damping: float) -> np.ndarray:
    """Compute the pseudo-acceleration of each motion [m/s2], (n_motions, n_periods)."""
    found = []
    for motion in motions:
        times = motion.times(MOST_SAMPLES)
        history = motion.acceleration(times)
        found.append(response_spectrum(history, times[1] - times[0], periods, damping).pseudo_acceleration)
    return np.array(found)
