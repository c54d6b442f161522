"""LU factors of sparse matrices without the rest of scipy's linear algebra."""

import numpy as np
import pytest
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import splu

from dem_cli.core.limit import sparse_factors
from dem_cli.core.limit.sparse_factors import factors_of


def grid(n):
    """Springs between n² places, other ones either way, (n², n²)."""
    line = diags([-1.0, 2.5, -1.25], [-1, 0, 1], shape=(n, n))
    one = diags([1.0], [0], shape=(n, n))
    from scipy.sparse import kron

    return csc_matrix(kron(line, one) + kron(one, line))


@pytest.mark.parametrize("order", ["MMD_AT_PLUS_A", "NATURAL"])
@pytest.mark.parametrize("alone", [True, False])
def test_factors_are_those_of_scipy(order, alone, monkeypatch):
    if not alone:
        monkeypatch.setattr(sparse_factors, "_routine", lambda: None)
    matrix, right = grid(9), np.arange(81.0)
    found = factors_of(matrix, order, 0.1)
    ours = splu(matrix, permc_spec=order, diag_pivot_thresh=0.1, options={"SymmetricMode": True})
    assert np.array_equal(found.perm_c, ours.perm_c)
    assert np.array_equal(found.solve(right), ours.solve(right))
    assert np.allclose(matrix @ found.solve(right), right, atol=1e-10)


def test_the_routine_is_found_here_and_is_that_of_scipy():
    from scipy.sparse.linalg._dsolve import _superlu

    assert sparse_factors._routine() is _superlu.gstrf


def test_a_routine_of_another_version_is_left_alone(monkeypatch):
    def other(*_, **__):
        raise TypeError

    monkeypatch.setattr(sparse_factors, "_routine", lambda: other)
    assert np.allclose(factors_of(grid(3), "NATURAL", 0.0).solve(np.ones(9)), splu(grid(3)).solve(np.ones(9)))


def test_a_singular_matrix_is_refused():
    with pytest.raises(RuntimeError, match="singular"):
        factors_of(csc_matrix(np.zeros((2, 2))), "NATURAL", 0.0)
