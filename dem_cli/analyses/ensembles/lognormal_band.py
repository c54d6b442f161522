"""Confidence limits of a lognormal fit of few records: median, dispersion and shares from the whole likelihood.

The limits are quantiles of the likelihood of the bounds times a prior, Jeffreys's times the dispersion σ, over the mean
logarithm μ and σ. For capacities that are known closely the prior is 1/σ and the limits are the exact ones of normal
samples: Student's t for the median, χ² for the dispersion, the noncentral t for shares (right Haar prior: Datta and
Ghosh 1995). Levels as far apart as the capacities scatter, and capacities beyond the levels, are in the likelihood; how
often the limits then hold the true values is in docs/fragility.md. Nothing is drawn at random.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr

from dem_cli.analyses.ensembles.lognormal import log_shares
from dem_cli.core.arithmetic import functions
from dem_cli.core.engine.dynamic_settings import StatisticsSettings
from dem_cli.core.engine.settings import DEFAULT

FAR = 30.0  # standard deviations, beyond which nothing lies


class Band(NamedTuple):
    """Confidence limits of a lognormal distribution."""

    median: tuple[float, float]
    dispersion: tuple[float, float]
    low: np.ndarray  # of the share below each requested intensity, (n,)
    high: np.ndarray


class _Known(NamedTuple):
    """Logarithms of the bounds of all capacities, for the likelihood."""

    pairs: np.ndarray  # that differ, (n_pairs, 2)
    weights: np.ndarray  # how many records have them, (n_pairs,)
    between: float  # records that both stood and fell
    middle: float  # mean of theirs
    blur: float  # variance that the distance of the levels adds
    levels: tuple[float, float]  # the lowest and the highest


class _Likely(NamedTuple):
    """Probabilities on a grid, (n, m), of mean logarithms and of their dispersions, (n,)."""

    means: np.ndarray
    dispersions: np.ndarray
    probabilities: np.ndarray


def confidence_band(
    bounds: np.ndarray, at: np.ndarray, confidence: float, levels: tuple[float, float],
    statistics: StatisticsSettings = DEFAULT.statistics,
) -> Band | None:  # fmt: skip
    """Compute the confidence limits of `fit`: bounds (n_records, n_structures, 2), at (m,) intensities.

    Structures under one record count as one record together, as they mostly fall together: with much scatter between
    them the limits are wider than need be. None where fewer than two records both stood and fell.
    """
    known = _known(bounds, levels)
    if known is None or known.between < statistics.fewest_known:
        return None
    likely = _likely(known, statistics.grid)
    tails = [0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)]
    medians = functions.exp(_quantiles(likely.means, likely.probabilities, tails))
    rows = likely.probabilities.sum(axis=1)
    spreads = functions.exp(np.interp(tails, np.cumsum(rows) - 0.5 * rows, functions.log(likely.dispersions)))
    scores = [(math.log(a) - likely.means) / likely.dispersions[:, None] for a in at]
    shares = functions.exp(log_ndtr(np.array([_quantiles(score, likely.probabilities, tails) for score in scores])))
    return Band(tuple(medians.tolist()), tuple(spreads.tolist()), shares[:, 0], shares[:, 1])


def _known(bounds: np.ndarray, levels: tuple[float, float]) -> _Known | None:
    """Prepare the bounds of capacities for the likelihood; None where no capacity has two."""
    logs = functions.log(bounds.reshape(-1, 2))
    pairs, counts = np.unique(logs, axis=0, return_counts=True)
    weights = counts / bounds.shape[1]
    inside = np.isfinite(pairs).all(axis=1)
    between = float(weights[inside].sum())
    if between == 0.0:
        return None
    middle = float(np.average(pairs[inside].mean(axis=1), weights=weights[inside]))
    blur = float(np.average(np.diff(pairs[inside])[:, 0] ** 2, weights=weights[inside])) / 12.0
    return _Known(pairs, weights, between, middle, blur, (math.log(levels[0]), math.log(levels[1])))


def _likely(known: _Known, points: int) -> _Likely:
    """Find the grid of likely values in three steps: of (μ − middle)/σ, and of log σ."""
    blur, reach = math.sqrt(known.blur), 10.0 / math.sqrt(known.between)
    finite = known.pairs[np.isfinite(known.pairs)]
    u = np.linspace(-4.0 - reach, 4.0 + reach, points)
    logs = np.linspace(math.log(blur) - 6.0, math.log(blur + float(np.ptp(finite))) + 1.0 + reach, points)
    probabilities = _probabilities(known, u, logs)
    for _ in range(2):
        u, logs = _where(u, probabilities.sum(axis=0)), _where(logs, probabilities.sum(axis=1))
        probabilities = _probabilities(known, u, logs)
    dispersions = functions.exp(logs)
    return _Likely(known.middle + u * dispersions[:, None], dispersions, probabilities)


def _where(values: np.ndarray, weights: np.ndarray, least: float = 1e-5) -> np.ndarray:
    """Narrow a range of values to the part with weight, with the same number of values."""
    heavy = np.flatnonzero(weights > least * weights.max())
    return np.linspace(values[max(heavy[0] - 1, 0)], values[min(heavy[-1] + 1, len(values) - 1)], len(values))


def _probabilities(known: _Known, u: np.ndarray, logs: np.ndarray) -> np.ndarray:
    """Compute the probability of each log σ and u = (μ − middle)/σ, (n, m), from likelihood and prior."""
    dispersions = functions.exp(logs)[:, None]

    def scores(value: float) -> np.ndarray:
        return (value - known.middle) / dispersions - u

    likelihood = np.zeros((len(logs), len(u)))
    for (low, high), weight in zip(known.pairs, known.weights):
        likelihood += weight * log_shares(scores(low), scores(high))
    information = _information(*(np.clip(scores(level), -FAR, FAR) for level in known.levels))
    squares = dispersions[:, 0] ** 2 + known.blur  # σ is resolved down to the levels' distance
    grouped = 3.0 * logs - functions.log(squares)
    found = likelihood + 0.5 * functions.log(np.maximum(information, 1e-300)) + grouped[:, None]
    found = functions.exp(found - found.max())
    return found / found.sum()


def _information(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Compute the determinant of Fisher's information of a capacity about (μ, σ), times σ⁴.

    low, high: scores of the lowest and the highest level, beyond which capacities are censored. Moments of the normal
    distribution between them, and the squared rate of the share beyond each over that share.
    """
    inside = functions.exp(log_shares(low, high))
    f, g = (functions.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi) for z in (low, high))
    below = f * functions.exp(functions.log(f) - log_ndtr(low))
    above = g * functions.exp(functions.log(g) - log_ndtr(-high))
    first, second = f - g, inside + low * f - high * g
    third = 2.0 * first + low**2 * f - high**2 * g
    fourth = 3.0 * second + low**2 * low * f - high**2 * high * g
    about_mean = second + below + above
    about_both = third - first + low * below + high * above
    about_spread = fourth - 2.0 * second + inside + low**2 * below + high**2 * above
    return about_mean * about_spread - about_both**2


def _quantiles(values: np.ndarray, probabilities: np.ndarray, tails: list[float]) -> np.ndarray:
    """Return the weighted quantiles of values."""
    order = np.argsort(values, axis=None)
    weights = probabilities.ravel()[order]
    return np.interp(tails, np.cumsum(weights) - 0.5 * weights, values.ravel()[order])
