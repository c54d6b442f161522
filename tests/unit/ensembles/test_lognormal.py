"""The lognormal fit with censoring, against scipy's own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from dem_cli.analyses.ensembles.lognormal import fit


def bounds(seed: int, step: float = 0.05, n: int = 20, dispersion: float = 0.15):
    """Capacities around 1.3, known to lie between levels."""
    values = 1.3 * np.exp(np.random.default_rng(seed).normal(0.0, dispersion, n))
    lower = np.floor(values / step) * step
    return lower, lower + step


@pytest.mark.parametrize("seed", range(4))
def test_as_scipy_fits_censored_data(seed):
    lower, upper = bounds(seed)
    lower[:3], upper[-4:] = 0.0, np.inf  # censored on both sides
    data = stats.CensoredData(interval=np.column_stack([lower[3:-4], upper[3:-4]]), left=upper[:3], right=lower[-4:])
    dispersion, _, median = stats.lognorm.fit(data, floc=0.0)
    found = fit(lower, upper)
    assert found.median == pytest.approx(median, rel=2e-4)
    assert found.dispersion == pytest.approx(dispersion, rel=1e-3)
    at = np.array([1.0, 1.3, 1.7])
    assert found.share(at) == pytest.approx(stats.lognorm.cdf(at, dispersion, scale=median), abs=1e-3)


def test_closely_known_capacities_have_the_moments_of_their_logarithms():
    values = np.exp(np.random.default_rng(5).normal(0.2, 0.3, 40))
    found = fit(values * (1.0 - 1e-6), values * (1.0 + 1e-6))
    assert np.log(found.median) == pytest.approx(np.log(values).mean(), abs=1e-4)
    assert found.dispersion == pytest.approx(np.log(values).std(), rel=1e-3)


def test_nothing_fell_or_all_fell_at_once_says_nothing():
    ones = np.ones(5)
    assert fit(ones, np.inf * ones) is None
    assert fit(0.0 * ones, ones) is None


def test_never_collapsed_records_raise_the_median():
    lower, upper = bounds(1)
    assert fit(np.append(lower, [2.0] * 10), np.append(upper, [np.inf] * 10)).median > fit(lower, upper).median
