"""A lognormal distribution of capacities that are known within bounds only, by maximum likelihood.

A capacity lies between two intensities: the structure stood at the one and fell at the other. Below the first
intensity (0, x] and above the last (x, ∞) it is censored. The same estimate as scipy.stats.lognorm.fit with
CensoredData, in a hundredth of its time, which a bootstrap needs.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import log_ndtr

from dem_cli.engine.settings import DEFAULT


class Lognormal(NamedTuple):
    """median, and dispersion: standard deviation of the logarithm."""

    median: float
    dispersion: float

    def share(self, intensities: np.ndarray) -> np.ndarray:
        """Share of capacities below intensities."""
        return np.exp(log_ndtr(np.log(intensities / self.median) / self.dispersion))


class Band(NamedTuple):
    """Confidence of a fit, from resampled records."""

    median: tuple[float, float]
    dispersion: tuple[float, float]
    low: np.ndarray  # of the share below each intensity asked for, (n,)
    high: np.ndarray
    resamples: int


def fit(lower: np.ndarray, upper: np.ndarray, narrowest: float = DEFAULT.statistics.narrowest) -> Lognormal | None:
    """The most likely distribution of capacities between lower (≥ 0) and upper (≤ ∞) bounds, (n,).

    None where the bounds leave it open: nothing fell, or all fell at once.
    """
    with np.errstate(divide="ignore"):
        a, b = np.log(lower), np.log(upper)
    inside = np.isfinite(a) & np.isfinite(b)
    if not np.isfinite(b).any() or not np.isfinite(a).any():
        return None
    known = np.where(np.isfinite(a), a, b)
    middles = np.where(inside, 0.5 * (known + np.where(inside, b, 0.0)), known)
    least, most = math.log(narrowest), math.log(10.0)
    start = [float(middles.mean()), float(np.clip(np.log(middles.std() + 1e-3), least, most))]

    def badness(at: np.ndarray) -> float:
        return -float(_log_shares((a - at[0]) / math.exp(at[1]), (b - at[0]) / math.exp(at[1])).sum())

    spread = float(np.ptp(middles)) + 1.0
    bounds = [(middles.min() - spread, middles.max() + spread), (least, most)]
    found = minimize(badness, start, method="Nelder-Mead", bounds=bounds, options={"xatol": 1e-6, "fatol": 1e-9})
    return Lognormal(math.exp(found.x[0]), math.exp(found.x[1]))


def _log_shares(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """log(Φ(b) − Φ(a)), a < b, without cancellation in the upper tail; not below −700, which is never."""
    flip = a > 0.0
    low, high = np.where(flip, -b, a), np.where(flip, -a, b)
    upper = log_ndtr(high)
    ratio = np.exp(np.minimum(log_ndtr(low) - upper, 0.0))
    return np.maximum(upper + np.log1p(-np.minimum(ratio, 1.0 - 1e-16)), -700.0)


def bootstrap(
    lower: np.ndarray,
    upper: np.ndarray,
    at: np.ndarray,
    confidence: float,
    seed: int,
    resamples: int,
    narrowest: float = DEFAULT.statistics.narrowest,
) -> Band | None:
    """Confidence of `fit` by resampling records: lower, upper (n_records, n_variants), at (m,) intensities.

    Resamples without a fit are left out; None where more than half have none.
    """
    n = len(lower)
    generator = np.random.default_rng(seed)
    fits = []
    for _ in range(resamples):
        pick = generator.integers(0, n, n)
        found = fit(lower[pick].ravel(), upper[pick].ravel(), narrowest)
        if found is not None:
            fits.append(found)
    if len(fits) <= 0.5 * resamples:
        return None
    tails = [50.0 * (1.0 - confidence), 50.0 * (1.0 + confidence)]
    low, high = np.percentile([found.share(at) for found in fits], tails, axis=0)
    medians, dispersions = (np.percentile([f[i] for f in fits], tails).tolist() for i in (0, 1))
    return Band(tuple(medians), tuple(dispersions), low, high, len(fits))
