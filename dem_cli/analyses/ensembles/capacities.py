"""Collapse capacities of records from runs at several intensities."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.analyses.ensembles.batch import ShakingTrial
from dem_cli.analyses.ensembles.lognormal import Lognormal, fit
from dem_cli.analyses.ensembles.lognormal_band import confidence_band
from dem_cli.analyses.ensembles.shaken_run import ShakenRunResult
from dem_cli.core.arithmetic import functions
from dem_cli.core.engine.dynamic_settings import StatisticsSettings
from dem_cli.core.engine.settings import DEFAULT


class Bounds(NamedTuple):
    """Bounds of a collapse capacity: the intensity survived and the one that caused collapse."""

    lower: float  # 0: fell at the lowest that was tried
    upper: float  # infinite: never fell


Outcomes = dict[float, bool]  # collapsed at an intensity, ascending; without runs that failed or still moved


def outcomes(done: Mapping[ShakingTrial, ShakenRunResult], structure: int, record: int) -> Outcomes:
    """Collect all runs of one structure under one record."""
    found = {
        trial.intensity: run.collapsed
        for trial, run in done.items()
        if (trial.structure, trial.record) == (structure, record) and run.collapsed is not None
    }
    return dict(sorted(found.items()))


def bounds_of(found: Outcomes) -> Bounds | None:
    """Return the lowest intensity that caused collapse, and the next lower one tried; None: never tried."""
    if not found:
        return None
    upper = min((a for a, fell in found.items() if fell), default=math.inf)
    return Bounds(max((a for a, fell in found.items() if not fell and a < upper), default=0.0), upper)


def survived_above(found: Outcomes) -> list[float]:
    """Return the intensities survived above one that caused collapse."""
    lowest = min((a for a, fell in found.items() if fell), default=math.inf)
    return [a for a, fell in found.items() if not fell and a > lowest]


def between(bounds: np.ndarray) -> tuple[float, float]:
    """Return the bounds of the median collapse intensity without a distribution; the upper one may be infinite.

    bounds: (n_records, n_structures, 2). Of an even number the lower and the upper one of the two in the middle count.
    """
    lower, upper = np.sort(bounds.reshape(-1, 2), axis=0).T
    return float(lower[(len(lower) - 1) // 2]), float(upper[len(upper) // 2])


def distribution(
    bounds: np.ndarray, levels: Sequence[float], confidence: float, statistics: StatisticsSettings = DEFAULT.statistics
) -> dict[str, Any]:
    """Fit the lognormal distribution with its confidence and fragility curve, as keys of the summary.

    bounds: (n_records, n_structures, 2). Of one run for each level nothing is fitted: it is one draw.
    """
    found = None
    if bounds[:, :, 0].size > 1:
        found = fit(bounds[:, :, 0].ravel(), bounds[:, :, 1].ravel(), statistics.narrowest)
    if found is None:
        return {"median": None, "dispersion": None, "confidence": None, "curve": None}
    at = _range(found, levels, statistics.points)
    curve, sure = {"intensity": at, "share": found.share(at)}, None
    band = confidence_band(bounds, at, confidence, (levels[0], levels[-1]), statistics)
    if band is not None:
        curve |= {"low": band.low, "high": band.high}
        sure = {"level": confidence, "median": band.median, "dispersion": band.dispersion, "resamples": None}
    return {"median": found.median, "dispersion": found.dispersion, "confidence": sure, "curve": curve}


def _range(found: Lognormal, levels: Sequence[float], points: int) -> np.ndarray:
    """Return the intensities of the curve: all tried, and 99 % of the distribution as far as that is near."""
    low = min(levels[0], max(found.median * math.exp(-2.6 * found.dispersion), 0.5 * levels[0]))
    high = max(levels[-1], min(found.median * math.exp(2.6 * found.dispersion), 1.5 * levels[-1]))
    return np.linspace(low, high, points)


def split(bounds: np.ndarray) -> dict[str, float] | None:
    """Split the dispersion between records and structures, by analysis of variance of logarithms.

    Of records under which every structure stood and fell at some intensity. bounds: (n_records, n_structures, 2).
    None: fewer than two of these, or one structure.
    """
    whole = ((bounds[:, :, 0] > 0.0) & np.isfinite(bounds[:, :, 1])).all(axis=1)
    n = bounds.shape[1]
    if whole.sum() < 2 or n < 2:
        return None
    logs = functions.log(bounds[whole]).mean(axis=2)
    within = float(logs.var(axis=1, ddof=1).mean())
    between = max(float(logs.mean(axis=1).var(ddof=1)) - within / n, 0.0)
    return {"records": math.sqrt(between), "perturbation": math.sqrt(within), "of_records": int(whole.sum())}
