"""Piecewise polynomials of time: scipy's, to the last digit, without loading it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PPoly

from dem_cli.core.motion.piecewise_polynomial import AT_ONCE, PiecewisePolynomial


@pytest.mark.parametrize("n_pieces", [1, 2, 60])
@pytest.mark.parametrize("powers", [1, 2, 4])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_values_and_integrals_are_those_of_scipy(n_pieces, powers, order):
    random = np.random.default_rng(10 * n_pieces + powers)
    x = np.concatenate(([0.0], np.cumsum(random.uniform(1e-3, 0.1, n_pieces))))
    c = random.normal(size=(powers, n_pieces))
    mine, theirs = PiecewisePolynomial(c, x), PPoly(c, x)
    if order:
        mine, theirs = mine.antiderivative(order), theirs.antiderivative(order)
    times = np.concatenate((x, random.uniform(-0.1, x[-1] + 0.1, AT_ONCE)))  # in two parts, some outside
    np.testing.assert_array_equal(mine.c, theirs.c)
    np.testing.assert_array_equal(mine(times), theirs(times))
    np.testing.assert_array_equal(mine(times.reshape(1, -1)), theirs(times.reshape(1, -1)))
    assert mine(x[-1]) == theirs(x[-1])
    assert mine(np.zeros(0)).shape == (0,)
