"""Confidence of a lognormal fit: the exact limits of normal samples, and how often limits hold the true values."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import brentq

from dem_cli.analyses.ensembles.capacities import distribution
from dem_cli.analyses.ensembles.lognormal_band import confidence_band
from dem_cli.core.engine.settings import DEFAULT

MEDIAN, DISPERSION, AT = 1.3, 0.3, 1.1
TAILS = np.array([0.05, 0.95])
SETS, CLOSE_ENOUGH = 200, 6.0  # synthetic sets of records; % of them, of the standard errors below

# What a study can know of a capacity: all levels and, in the comments, the share that is beyond them.
LEVELS = {
    "close": np.arange(0.02, 6.0, 0.02),
    "far apart": np.arange(0.2, 6.0, 0.2),  # half a dispersion
    "too low": np.arange(0.05, 1.45, 0.05),  # 40 % never fell
    "few": np.arange(1.0, 1.6, 0.05),  # 19 % fell at the lowest, 28 % never
}


def between(values: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Bounds of capacities, (n_records, 1, 2)."""
    ends = np.concatenate([[0.0], levels, [np.inf]])
    i = np.searchsorted(levels, values)
    return np.stack([ends[i], ends[i + 1]], axis=-1)[:, None]


def known(values: np.ndarray) -> np.ndarray:
    """Bounds so close that there is nothing between them."""
    return np.stack([values * (1.0 - 1e-7), values * (1.0 + 1e-7)], axis=-1)[:, None]


def band(bounds: np.ndarray, levels: tuple[float, float] = (1e-60, 1e60), grid: int = DEFAULT.statistics.grid):
    return confidence_band(bounds, np.array([AT]), 0.9, levels, replace(DEFAULT.statistics, grid=grid))


@pytest.mark.parametrize("n", [3, 5, 20])
def test_closely_known_capacities_have_the_exact_limits_of_normal_samples(n):
    """Student's t, χ² and the noncentral t, within 0.5 % of the distance of the limits."""
    logs = np.random.default_rng(n).normal(0.2, DISPERSION, n)
    mean, spread = logs.mean(), logs.std(ddof=1)
    means = mean + spread / math.sqrt(n) * stats.t(n - 1).ppf(TAILS)
    spreads = spread * np.sqrt((n - 1) / stats.chi2(n - 1).ppf(TAILS[::-1]))
    seen = math.sqrt(n) * (math.log(AT) - mean) / spread
    scores = [brentq(lambda z, p=p: stats.nct(n - 1, z * math.sqrt(n)).cdf(seen) - p, -2.5, 2.5) for p in TAILS[::-1]]
    found = band(known(np.exp(logs)))
    assert np.log(found.median) == pytest.approx(means, abs=0.005 * np.ptp(means))
    assert np.log(found.dispersion) == pytest.approx(np.log(spreads), abs=0.005 * np.ptp(np.log(spreads)))
    assert stats.norm.ppf([found.low[0], found.high[0]]) == pytest.approx(scores, abs=0.005 * np.ptp(scores))


@pytest.mark.parametrize(
    ("kind", "n"), [(kind, n) for kind in ("close", "few") for n in (5, 10, 20)] + [("far apart", 5), ("too low", 5)]
)
def test_ninety_percent_limits_hold_the_true_values_in_ninety_percent_of_sets(kind, n):
    """Of the sets that have limits; standard error of a share of 90 %: 2.1 %. Resampled records held the true
    dispersion in 52 % of sets of 5 and in 71 % of sets of 20."""
    levels, generator, held, sets = LEVELS[kind], np.random.default_rng(n), np.zeros(3), 0
    share = stats.norm.cdf(math.log(AT / MEDIAN) / DISPERSION)
    for _ in range(SETS):
        values = MEDIAN * np.exp(generator.normal(0.0, DISPERSION, n))
        found = band(between(values, levels), (levels[0], levels[-1]), grid=32)
        if found is None:
            continue
        sets += 1
        limits = (found.median, found.dispersion, (found.low[0], found.high[0]))
        held += [low <= true <= high for (low, high), true in zip(limits, (MEDIAN, DISPERSION, share))]
    assert sets > 0.8 * SETS
    assert 100.0 * held / sets == pytest.approx(90.0, abs=CLOSE_ENOUGH)


def test_levels_farther_apart_than_the_scatter_leave_the_dispersion_open_below():
    """Five capacities in one interval of 0.1: the limit above is that with which 5 % of sets look like that."""
    found = band(np.tile([1.25, 1.35], (5, 1))[:, None], (0.05, 6.0))
    low, high = math.log(1.25 / 1.3), math.log(1.35 / 1.3)
    exact = brentq(lambda s: (stats.norm.cdf(high / s) - stats.norm.cdf(low / s)) ** 5 - 0.05, 1e-3, 1.0)
    assert found.dispersion[0] < 0.1 * exact
    assert found.dispersion[1] == pytest.approx(exact, rel=0.3)
    assert 1.25 < found.median[0] < 1.3 < found.median[1] < 1.35


def test_structures_under_one_record_do_not_count_as_more_records():
    values = np.exp(np.random.default_rng(4).normal(0.2, DISPERSION, 8))
    once, often = known(values), np.tile(known(values), (1, 6, 1))
    assert band(often).median == pytest.approx(band(once).median, rel=1e-9)
    assert band(often).dispersion == pytest.approx(band(once).dispersion, rel=1e-9)


def test_limits_close_in_on_the_true_values_with_more_records():
    values = MEDIAN * np.exp(np.random.default_rng(7).normal(0.0, DISPERSION, 1000))
    found = band(between(values, LEVELS["few"]), (1.0, 1.55))
    assert np.log(found.median) == pytest.approx(math.log(MEDIAN), abs=0.04)
    assert found.dispersion == pytest.approx((DISPERSION, DISPERSION), rel=0.15)


@pytest.mark.parametrize("bounds", [[[1.0, 1.1]], [[1.0, 1.1]] + 9 * [[3.0, np.inf]], 5 * [[0.0, 1.0]]])
def test_fewer_than_two_capacities_with_both_bounds_have_no_limits(bounds):
    bounds = np.array(bounds)[:, None]
    assert band(bounds, (1.0, 3.0)) is None
    found = distribution(bounds, [1.0, 1.1, 3.0], 0.9)
    assert found["confidence"] is None
    assert not found["curve"] or "low" not in found["curve"]
