"""LU factors of sparse matrices by SuperLU: `splu` of scipy without the dense linear algebra that is loaded with it.

That package loads solvers, eigenvalues and matrix functions for one compiled routine: a twelfth of a short run. The
routine lies in a file of its own, which is loaded alone where it is as it was; elsewhere scipy does it, with the
same factors.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import scipy.sparse
from scipy.sparse import csc_matrix

_FOLDER = "scipy.sparse.linalg._dsolve"


class Factors(Protocol):
    """LU factors of one matrix."""

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve for one right side; returns the solution, (n_columns,)."""


class SparseFactors(Factors, Protocol):
    """Interface of the LU factors that SuperLU returns."""

    @property
    def perm_c(self) -> np.ndarray:
        """Column permutation: the new place of each column, (n_columns,)."""


def factors_of(matrix: csc_matrix, order: str, pivot: float) -> SparseFactors:
    """LU factors of a square matrix whose pattern is symmetric.

    order: of the columns, `permc_spec` of splu; pivot: share of the largest entry from which on the diagonal is taken.
    Raises RuntimeError where it is singular.
    """
    matrix.sum_duplicates()
    options = {"DiagPivotThresh": pivot, "ColPerm": order, "PanelSize": None, "Relax": None, "SymmetricMode": True}
    routine = _routine()
    if routine is not None:
        indices, starts = (part.astype(np.intc, copy=False) for part in (matrix.indices, matrix.indptr))
        try:
            return routine(
                matrix.shape[0], matrix.nnz, matrix.data, indices, starts,
                csc_construct_func=csc_matrix, ilu=False, options=options,
            )  # fmt: skip
        except TypeError:  # of another version
            pass
    from scipy.sparse.linalg import splu

    return splu(matrix, permc_spec=order, diag_pivot_thresh=pivot, options={"SymmetricMode": True})


@cache
def _routine() -> Callable[..., Any] | None:
    """Load SuperLU's factorisation; None where SciPy no longer has it there."""
    name = f"{_FOLDER}._superlu"
    if name not in sys.modules:
        folder = Path(scipy.sparse.__file__).parent / "linalg" / "_dsolve"
        spec = PathFinder.find_spec(name, [str(folder)])
        if spec is None or spec.loader is None:
            return None
        try:
            module = module_from_spec(spec)
            spec.loader.exec_module(module)
        except ImportError:
            return None
        sys.modules[name] = module
    return getattr(sys.modules[name], "gstrf", None)
