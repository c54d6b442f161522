"""Sparse symmetric linear systems, without SuperLU and its BLAS."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.arithmetic.symmetric_factors import count_entries, factorise_symmetric, solve_symmetric

if TYPE_CHECKING:
    from scipy.sparse import sparray, spmatrix


def solved_symmetric(matrix: sparray | spmatrix, right: np.ndarray) -> np.ndarray:
    """x of A x = b for a sparse symmetric A that is positive definite, (n,).

    Raises np.linalg.LinAlgError where a pivot is nothing.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    whole = csc_array(matrix)
    order, n = reverse_cuthill_mckee(whole.tocsr(), symmetric_mode=True).astype(np.int64), whole.shape[0]
    ordered = csc_array(whole[order][:, order])
    whole_matrix = ordered.indptr.astype(np.int64), ordered.indices.astype(np.int64), ordered.data
    parents, counts, seen = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    count_entries(*whole_matrix[:2], parents, counts, seen)
    begins = np.concatenate([[0], np.cumsum(counts)])
    factors = (
        parents, begins, counts, np.empty(begins[-1], np.int64), np.empty(begins[-1]), np.empty(n),
    )  # fmt: skip
    if factorise_symmetric(whole_matrix, factors, (seen, np.empty(n, np.int64), np.zeros(n))) >= 0:
        raise np.linalg.LinAlgError("singular matrix")
    found = np.empty(n)
    x = right[order].astype(float)
    solve_symmetric(factors, x)
    found[order] = x
    return found
