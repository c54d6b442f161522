"""Response spectra: the exact response of linear oscillators to an acceleration that is linear between samples.

Source: N. C. Nigam and P. C. Jennings, Calculation of response spectra from strong-motion earthquake records, Bull.
Seism. Soc. Am. 59 (1969). Their recursion x(i+1) = A x(i) + B (a(i), a(i+1)) is run as a digital filter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product

SAMPLES_PER_PERIOD = 60  # samples per period at least; crests between them are found by a cubic

TERMS = 16  # of the series of exp(x), |x| ≤ 0.5: the next one is below 1e-18


class ResponseSpectrum(NamedTuple):
    """Response spectrum, largest absolute responses; all but `periods` are (..., n_periods), as the records given."""

    periods: np.ndarray  # [s], (n_periods,)
    displacement: np.ndarray  # SD: relative to the base [m]
    velocity: np.ndarray  # SV: relative to the base [m/s]
    acceleration: np.ndarray  # SA: absolute [m/s2]
    pseudo_acceleration: np.ndarray  # PSA = ω² SD [m/s2]


class OscillatorFilter(NamedTuple):
    """Response of one oscillator as filters of the base acceleration: numerators, start, common denominator."""

    displacement: np.ndarray  # (3,)
    velocity: np.ndarray  # (3,)
    denominator: np.ndarray  # (3,)
    start: np.ndarray  # state of the two filters for a(0) = 1 and an oscillator at rest, (2, 2)


def periods(shortest: float = 0.02, longest: float = 4.0, count: int = 120) -> np.ndarray:
    """Choose periods for a picture [s], evenly spread over the logarithm, (count,)."""
    return functions.geometric(shortest, longest, count)


def response_spectrum(
    accelerations: np.ndarray, step: float, periods: np.ndarray, damping: float = 0.05, points: int = SAMPLES_PER_PERIOD
) -> ResponseSpectrum:
    """Compute the response spectrum of one or several records: while they last, and in the free vibration after
    them.

    accelerations  of the base [m/s2], (..., n), linear between samples `step` [s] apart; oscillators start at rest
    periods        > 0 [s], (n_periods,)
    damping        ratio to critical, below 1
    points         the record is subdivided until that many samples lie in a period
    """
    records = np.atleast_1d(np.asarray(accelerations, float))
    finer: dict[int, np.ndarray] = {1: records}
    peaks = np.zeros((3, *records.shape[:-1], len(periods)))
    for k, period in enumerate(periods):
        division = max(1, int(np.ceil(points * step / period)))
        if division not in finer:
            finer = {1: records, division: subdivided(records, division)}  # the last one is enough: periods are sorted
        omega = 2.0 * np.pi / period
        u, v = responses(finer[division], oscillator(omega, damping, step / division))
        after = free_vibration(u[..., -1:], v[..., -1:], omega, damping)
        during = _peaks(u, v, finer[division], omega, damping, step / division)
        peaks[..., k] = np.maximum(during, _peaks(*after, 0.0, omega, damping, period / SAMPLES_PER_PERIOD))
    frequencies = 2.0 * np.pi / np.asarray(periods)
    return ResponseSpectrum(np.asarray(periods), peaks[0], peaks[1], peaks[2], frequencies**2 * peaks[0])


def _peaks(
    u: np.ndarray, v: np.ndarray, ground: np.ndarray | float, omega: float, damping: float, step: float
) -> np.ndarray:
    """Largest |u|, |v| and absolute acceleration of oscillators at samples `step` apart, (3, ...)."""
    total = omega * omega * u + 2.0 * damping * omega * v  # = −(absolute acceleration)
    acceleration = -ground - total  # relative to the base
    rate = omega * omega * v + 2.0 * damping * omega * acceleration
    return np.stack([crest(u, step * v), crest(v, step * acceleration), crest(total, step * rate)])


def pseudo_accelerations(accelerations: np.ndarray, filters: list[OscillatorFilter], omegas: np.ndarray) -> np.ndarray:
    """Compute PSA [m/s2] at the samples' own step, for loops that ask again and again, (..., n_periods).

    All filters go through the samples together; scipy.signal, for one after the other, takes half a second to load.
    """
    b0, b1, b2 = np.stack([one.displacement for one in filters], axis=1)
    _, a1, a2 = np.stack([one.denominator for one in filters], axis=1)
    starts = np.stack([one.start[0] for one in filters], axis=1)
    samples = np.moveaxis(accelerations, -1, 0)[..., None]
    moved = np.empty((len(samples), *accelerations.shape[:-1], len(filters)))
    now, then = samples[0] * starts[0], samples[0] * starts[1]  # the transposed second direct form, as of lfilter
    for sample, u in zip(samples, moved):
        np.add(b0 * sample, now, out=u)
        now = then + b1 * sample - a1 * u
        then = b2 * sample - a2 * u
    return omegas**2 * peak(np.moveaxis(moved, 0, -1))


def oscillator(omega: float, damping: float, step: float) -> OscillatorFilter:
    """Compute the exact recursion of an oscillator under an acceleration that is linear over each step.

    u'' + 2ζω u' + ω² u = −a. Both components of the state obey y(i+1) − tr y(i) + det y(i−1) = Σ b a with the same
    trace and determinant of A (Cayley–Hamilton).
    """
    a, now, then = recursion(omega, damping, step)
    trace, det = a[0, 0] + a[1, 1], a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    numerators = []
    for i, j in ((0, 1), (1, 0)):
        numerators.append(
            [then[i], now[i] + a[i, j] * then[j] - a[j, j] * then[i], a[i, j] * now[j] - a[j, j] * now[i]]
        )
    b = np.array(numerators)
    start = np.stack((-b[:, 0], now - b[:, 1]), axis=1)  # so that y(0) = 0 and y(1) = now a(0) + then a(1)
    return OscillatorFilter(b[0], b[1], np.array([1.0, -trace, det]), start)


def recursion(omega: float, damping: float, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the step matrices of x(i+1) = A x(i) + now a(i) + then a(i+1), x = (u, u'): A (2, 2), now (2,), then
    (2,).

    From one exponential of the state (ω² u, ω u', a, change of a over the step), which has none of the cancellation
    of the closed formulas at small ω · step.
    """
    angle = omega * step
    enlarged = np.zeros((4, 4))
    enlarged[0, 1] = angle
    enlarged[1] = [-angle, -2.0 * damping * angle, -angle, 0.0]
    enlarged[2, 3] = 1.0
    scale = np.array([omega**2, omega])
    grown = exponential(enlarged)[:2]
    a = grown[:, :2] * scale / scale[:, None]
    return a, (grown[:, 2] - grown[:, 3]) / scale, grown[:, 3] / scale


def exponential(matrix: np.ndarray) -> np.ndarray:
    """Compute exp of a small matrix (n, n) by its series, halved until that converges fast.

    SciPy's expm starts threads, even for a 4 × 4 matrix: a hundred times slower where other work is going on.
    """
    halvings = max(0, int(np.ceil(math.log2(np.abs(matrix).sum(axis=1).max()))) + 1)
    part = matrix / 2.0**halvings
    total = term = np.eye(len(matrix))
    for k in range(1, TERMS):
        term = product(term, part) / k
        total = total + term
    for _ in range(halvings):
        total = product(total, total)
    return total


def responses(accelerations: np.ndarray, one: OscillatorFilter) -> tuple[np.ndarray, np.ndarray]:
    """Compute relative displacement and velocity of an oscillator at the samples, like `accelerations` (..., n)."""
    from scipy.signal import lfilter

    first = accelerations[..., :1]
    u, _ = lfilter(one.displacement, one.denominator, accelerations, zi=first * one.start[0])
    v, _ = lfilter(one.velocity, one.denominator, accelerations, zi=first * one.start[1])
    return u, v


def free_vibration(u: np.ndarray, v: np.ndarray, omega: float, damping: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute displacement and velocity over the period after a state (..., 1), without acceleration, (..., POINTS
    + 1)."""
    damped, rate = omega * np.sqrt(1.0 - damping * damping), damping * omega
    times = np.linspace(0.0, 2.0 * np.pi / omega, SAMPLES_PER_PERIOD + 1)
    decay, cosine, sine = functions.exp(-rate * times), np.cos(damped * times), np.sin(damped * times)
    return (
        decay * (u * cosine + (v + rate * u) / damped * sine),
        decay * (v * cosine - (rate * v + omega * omega * u) / damped * sine),
    )


def subdivided(records: np.ndarray, division: int) -> np.ndarray:
    """Divide each time step into `division` parts, linear between the samples."""
    n = records.shape[-1]
    shares = np.arange(division) / division
    parts = records[..., :-1, None] + shares * np.diff(records)[..., None]
    return np.concatenate((parts.reshape(*records.shape[:-1], (n - 1) * division), records[..., -1:]), axis=-1)


def crest(histories: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Find the largest absolute value of each, also between samples: of the cubic with the slopes given there.

    histories, slopes per step (..., n); result (...,). The error is of fourth order in the step.
    """
    n = histories.shape[-1]
    rows, rates = histories.reshape(-1, n), slopes.reshape(-1, n)
    one = np.arange(len(rows))
    top = np.abs(rows).argmax(axis=-1)
    rising = rows[one, top] * rates[one, top] > 0.0  # the crest comes after the sample
    a = np.clip(np.where(rising, top, top - 1), 0, n - 2)
    x0, x1, m0, m1 = rows[one, a], rows[one, a + 1], rates[one, a], rates[one, a + 1]
    turns = m0 * m1 < 0.0
    t = np.where(turns, m0 / np.where(turns, m0 - m1, 1.0), 0.0)
    between = x0 + t * (m0 + t * (3.0 * (x1 - x0) - 2.0 * m0 - m1 + t * (m0 + m1 - 2.0 * (x1 - x0))))
    return np.maximum(np.abs(rows[one, top]), np.abs(between)).reshape(histories.shape[:-1])


def peak(histories: np.ndarray) -> np.ndarray:
    """Find the largest absolute value of each, the crest of the parabola through its largest sample and the
    neighbours.

    histories (..., n), result (...,).
    """
    n = histories.shape[-1]
    rows = histories.reshape(-1, n)
    one = np.arange(len(rows))
    top = np.abs(rows).argmax(axis=-1)
    middle = rows[one, top]
    left, right = rows[one, np.maximum(top - 1, 0)] - middle, rows[one, np.minimum(top + 1, n - 1)] - middle
    bend, slope = left + right, right - left
    within = (top > 0) & (top < n - 1) & (bend * middle < 0.0)
    crest = middle - np.where(within, 0.125 * slope**2 / np.where(within, bend, 1.0), 0.0)
    return np.abs(crest).reshape(histories.shape[:-1])
