"""Solution of sparse symmetric linear systems, without SuperLU and its BLAS."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.symmetric_factors import count_entries, factorise_symmetric, order_rows, solve_symmetric

if TYPE_CHECKING:
    from scipy.sparse import sparray, spmatrix

ITERATIONS = 12  # of an inverse iteration: a shape, not a number of many digits


class SymmetricFactors:
    """Factors L D Lᵀ of a sparse symmetric matrix, without pivoting.

    Raises np.linalg.LinAlgError where a pivot is zero.
    """

    def __init__(self, matrix: sparray | spmatrix) -> None:
        from scipy.sparse import csc_array

        whole = csc_array(matrix)
        self.order, n = narrow_order(whole), whole.shape[0]
        ordered = csc_array(whole[self.order][:, self.order])
        whole_matrix = ordered.indptr.astype(np.int64), ordered.indices.astype(np.int64), ordered.data
        parents, counts, seen = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
        count_entries(*whole_matrix[:2], parents, counts, seen)
        begins = np.concatenate([[0], np.cumsum(counts)])
        self.factors = (
            parents, begins, counts, np.empty(begins[-1], np.int64), np.empty(begins[-1]), np.empty(n),
        )  # fmt: skip
        if factorise_symmetric(whole_matrix, self.factors, (seen, np.empty(n, np.int64), np.zeros(n))) >= 0:
            raise np.linalg.LinAlgError("singular matrix")

    @property
    def negative(self) -> int:
        """Count the negative eigenvalues: as many as negative pivots, by Sylvester's law of inertia."""
        return int((self.factors[-1] < 0.0).sum())

    def solved(self, right: np.ndarray) -> np.ndarray:
        """Solve A x = b with these factors, (n,)."""
        found = np.empty(len(right))
        x = right[self.order].astype(float)
        solve_symmetric(self.factors, x)
        found[self.order] = x
        return found


def narrow_order(matrix: sparray | spmatrix) -> np.ndarray:
    """Find the order of rows and columns, (n,), in which a sparse symmetric matrix has its entries near the diagonal.

    As `scipy.sparse.csgraph.reverse_cuthill_mckee`, which loads half of SciPy, and whose sort breaks ties by processor.
    """
    by_rows = matrix.tocsr()
    n, starts, columns = by_rows.shape[0], by_rows.indptr.astype(np.int64), by_rows.indices.astype(np.int64)
    degrees = np.diff(starts)
    diagonal = columns[columns == np.repeat(np.arange(n), degrees)]
    degrees += np.bincount(diagonal, minlength=n) > 0  # its entry counts twice
    order = np.empty(n, np.int64)
    order_rows(starts, columns, degrees, np.argsort(degrees, kind="stable"), order, np.ones(n, np.int64))
    return np.ascontiguousarray(order[::-1])


def solved_symmetric(matrix: sparray | spmatrix, right: np.ndarray) -> np.ndarray:
    """Solve A x = b for a sparse symmetric positive definite A, (n,).

    Raises np.linalg.LinAlgError where a pivot is zero.
    """
    return SymmetricFactors(matrix).solved(right)


def most_negative(matrix: sparray | spmatrix, least: float) -> np.ndarray | None:
    """Find the eigenvector of the lowest eigenvalue of a sparse symmetric matrix where that is below −least, (n,); else
    None.

    The shift that makes the matrix positive definite is found by counting negative pivots; from there inverse
    iteration comes to the lowest eigenvalue, from a start that is always the same.
    """
    from scipy.sparse import eye_array

    one = eye_array(matrix.shape[0], format="csr")
    if not SymmetricFactors(matrix + least * one).negative:
        return None
    shift = 2.0 * least
    while (factors := SymmetricFactors(matrix + shift * one)).negative:
        shift *= 2.0
    found = np.random.default_rng(0).standard_normal(matrix.shape[0])
    for _ in range(ITERATIONS):
        found = factors.solved(found)
        found /= np.sqrt((found * found).sum())
    return found
