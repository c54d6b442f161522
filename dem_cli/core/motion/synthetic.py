"""Artificial accelerograms that fit a response spectrum, in the manner of SIMQKE.

Sources: D. A. Gasparini and E. H. Vanmarcke, Simulated earthquake motions compatible with prescribed response spectra,
MIT R76-4 (1976); E. H. Vanmarcke, Structural response to earthquakes (1976), for the power spectrum of a response
spectrum. The scheme and its numbers: docs/motion.md.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import inverse
from dem_cli.core.motion.eurocode import TargetSpectrum
from dem_cli.core.motion.record import Accelerogram, record
from dem_cli.core.motion.spectrum import OscillatorFilter, oscillator, pseudo_accelerations

Return = Callable[[np.ndarray], np.ndarray]  # of histories (..., n) to rest
LOWEST_FREQUENCY, HIGHEST_FREQUENCY = 0.10, 35.0  # Hz: sines of the motion
EQUIVALENT = 10.0  # s: of stationary motion that the power spectrum is for
QUANTILE = 0.5  # chance that the peak response stays below the spectrum
CONTROLLED = (0.03, 4.0)  # s: periods at which the spectrum is corrected
CONTROLS = 80
LEAST = 0.92  # of the target: lower places count in the choice of the best iteration (Eurocode 8 allows 0.90)
WAVELET = 6.0  # time steps: period of the wavelet that raises a peak
END_LEVEL = 0.05  # of the envelope at the end of the decay


class ArtificialSuite(NamedTuple):
    """Parameters of a suite of artificial accelerograms."""

    target: TargetSpectrum  # that their response spectra meet
    duration: float = 20.0  # of each [s]
    rise: float = 2.0  # how long it grows, with the square of time [s]
    plateau: float = 10.0  # how long it stays strong [s]
    time_step: float = 0.01  # between samples [s]
    n_records: int = 1
    iterations: int = 12  # corrections towards the target


def suite(asked: ArtificialSuite, seed: int, stream: int = 0) -> list[Accelerogram]:
    """Generate `n_records` records; record i depends on (seed, stream, i) and on nothing else that is random."""
    count = round(asked.duration / asked.time_step)
    times = asked.duration / count * np.arange(count + 1)
    histories = accelerograms(
        asked.target, times, envelope(times, asked.rise, asked.plateau), asked.iterations,
        [np.random.default_rng([seed, stream, i]) for i in range(asked.n_records)],
    )  # fmt: skip
    return [record(times, history) for history in histories]


def envelope(times: np.ndarray, rise: float, plateau: float) -> np.ndarray:
    """Compute the envelope: (t/rise)² up to `rise`, 1 for `plateau`, then, if time is left, an exponential down to
    0.05, (n,)."""
    end = rise + plateau
    decay = -functions.log(END_LEVEL) / max(times[-1] - end, 1e-9)
    return np.where(
        times < end, np.minimum(times / rise, 1.0) ** 2, functions.exp(-decay * np.maximum(times - end, 0.0))
    )


def power_spectrum(target: TargetSpectrum, omegas: np.ndarray) -> np.ndarray:
    """Compute the one-sided power spectrum G [m2/s3] of a stationary motion whose response spectrum is the target,
    (n,).

    G(ω) = [Sa²/r² − ∫₀^ω G dω] / [ω (π/(4ξ') − 1)], ξ' = ξ/(1 − exp(−2ξωs)), s = 10 s, r the peak factor with
    probability p = 0.5 (Vanmarcke 1976). `omegas` even and increasing [rad/s].
    """
    damping = target.damping / (1.0 - functions.exp(-2.0 * target.damping * omegas * EQUIVALENT))
    crossings = omegas * EQUIVALENT / (2.0 * np.pi) / -functions.log(QUANTILE)
    bandwidth = functions.power(4.0 * damping / np.pi, 0.6)
    inner = (
        2.0
        * crossings
        * (1.0 - functions.exp(-bandwidth * np.sqrt(np.pi * functions.log(np.maximum(2.0 * crossings, 1.01)))))
    )
    peak_factor = np.sqrt(2.0 * functions.log(np.maximum(inner, 1.1)))
    variances = (target(2.0 * np.pi / omegas) / peak_factor) ** 2
    widths = omegas * (np.pi / (4.0 * damping) - 1.0)
    power, below, step = np.empty(len(omegas)), 0.0, omegas[1] - omegas[0]
    for k in range(len(omegas)):
        power[k] = max((variances[k] - below) / widths[k], 0.0)
        below += power[k] * step
    return power


def accelerograms(
    target: TargetSpectrum, times: np.ndarray, shape: np.ndarray, iterations: int, generators: list[np.random.Generator]
) -> np.ndarray:
    """Generate one history per generator [m/s2], (count, n), each from rest to rest where it started.

    Sines with the power of the target and random phases, times the envelope `shape` (n,). Then `iterations` times
    every amplitude is multiplied by the target over the spectrum reached at its frequency; the best of all is kept,
    and where its peak is below that of the target it is raised to it by a short wavelet.
    """
    step, n = times[1] - times[0], len(times) - 1
    orders = np.arange(int(np.ceil(LOWEST_FREQUENCY * times[-1])), int(HIGHEST_FREQUENCY * times[-1]) + 1)
    orders = orders[orders <= n // 2 - 1]
    omegas = 2.0 * np.pi / times[-1] * orders
    amplitudes = np.sqrt(2.0 * power_spectrum(target, omegas) * (omegas[1] - omegas[0]))
    phases = np.array([generator.uniform(0.0, 2.0 * np.pi, len(orders)) for generator in generators])
    unit = np.exp(1j * phases)
    controls, filters, wanted = _controls(target, step)
    rest = _at_rest(times, shape)
    strengths = np.tile(amplitudes, (len(generators), 1))
    best, least = np.zeros((len(generators), n + 1)), np.full(len(generators), np.inf)
    for i in range(iterations + 1):
        histories = rest(shape * _sum_of_sines(strengths * unit, orders, n))
        ratios = pseudo_accelerations(histories, filters, controls) / wanted
        badness = _badness(ratios)
        better = badness < least
        best[better], least[better] = histories[better], badness[better]
        if i < iterations:
            strengths = strengths / _at(omegas, controls, ratios)
    return np.stack([_raised(history, target.ground, times, rest) for history in best])


def _controls(target: TargetSpectrum, step: float) -> tuple[np.ndarray, list[OscillatorFilter], np.ndarray]:
    """Circular frequencies at which the spectrum is corrected, their oscillators, and the target there."""
    shortest = max(CONTROLLED[0], 2.0 * step)
    omegas = 2.0 * np.pi / functions.geometric(shortest, CONTROLLED[1], CONTROLS)[::-1]
    return omegas, [oscillator(w, target.damping, step) for w in omegas], target(2.0 * np.pi / omegas)


def _sum_of_sines(coefficients: np.ndarray, orders: np.ndarray, n: int) -> np.ndarray:
    """Σ Re(c exp(i 2π k j/n)) at j = 0 … n; the last sample is the first again, (count, n + 1)."""
    spectrum = np.zeros((len(coefficients), n // 2 + 1), complex)
    spectrum[:, orders] = coefficients
    one = np.fft.irfft(spectrum, n) * (0.5 * n)
    return np.concatenate((one, one[:, :1]), axis=1)


def _at_rest(times: np.ndarray, shape: np.ndarray) -> Return:
    """Return a function that corrects histories so that no velocity and no displacement is left at the end. It
    takes from them two multiples of the envelope, plain and times t (of an acceleration that is linear between
    samples)."""
    step = times[1] - times[0]
    to_velocity = np.full(len(times), step)
    to_velocity[[0, -1]] *= 0.5
    to_displacement = to_velocity * (times[-1] - times)
    to_displacement[0] -= step**2 / 6.0
    to_displacement[-1] += step**2 / 6.0
    functionals = np.stack((to_velocity, to_displacement))
    forms = np.stack((shape, shape * times / times[-1]))
    solve = inverse(product(functionals, forms.T))

    def corrected(histories: np.ndarray) -> np.ndarray:
        for _ in range(2):  # the second time takes the rounding of the first
            left = np.einsum("...j,kj->...k", histories, functionals)  # a matrix product would start threads for this
            histories = histories - product(product(left, solve.T), forms)
        return histories

    return corrected


def _raised(history: np.ndarray, ground: float, times: np.ndarray, rest: Return) -> np.ndarray:
    """Add a Ricker wavelet to the largest sample of a history (n,), so that this becomes `ground` [m/s2].

    The wavelet is so short that it hardly moves an oscillator of longer period.
    """
    for _ in range(4):  # the return to rest takes a little of the peak again
        top = np.abs(history).argmax()
        missing = ground - abs(history[top])
        if missing <= 0.0:
            break
        x = np.pi / WAVELET * np.arange(-top, len(times) - top)
        wavelet = (1.0 - 2.0 * x * x) * functions.exp(-x * x)
        history = rest(history + 1.0001 * np.sign(history[top]) * missing * wavelet)
    return history


def _at(omegas: np.ndarray, controls: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    """Ratios of the spectrum, interpolated to the frequencies of the sines, (count, n_sines)."""
    return np.stack([np.interp(functions.log(omegas), functions.log(controls), row) for row in ratios])


def _badness(ratios: np.ndarray) -> np.ndarray:
    """Root mean square of log ratios, with places below what Eurocode 8 allows counted on top, (count,)."""
    return np.sqrt((functions.log(ratios) ** 2).mean(axis=1)) + np.maximum(LEAST - ratios, 0.0).max(axis=1)
