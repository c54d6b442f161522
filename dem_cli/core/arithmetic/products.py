"""Products of full arrays, term by term in an order that no processor changes: without BLAS."""

from __future__ import annotations

from typing import Any

import numpy as np


def product(a: Any, b: Any) -> Any:
    """Multiply full arrays as a @ b, a number where both are vectors; sparse matrices have their own `@`."""
    a, b = np.asarray(a), np.asarray(b)
    if b.ndim == 1:
        return np.einsum("...j,j->...", a, b) if a.ndim > 1 else np.einsum("j,j->", a, b)
    return np.einsum("j,...jk->...k" if a.ndim == 1 else "...ij,...jk->...ik", a, b)


def norm(vector: Any) -> np.float64:
    """Compute the length of one vector; for an array with more axes the root of the sum of all squares."""
    flat = np.ravel(vector)
    return np.sqrt(product(flat, flat))
