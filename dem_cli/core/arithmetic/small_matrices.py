"""Linear systems, eigenvalues and singular values of many small matrices at once, without LAPACK."""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.arithmetic.products import product

SWEEPS = 40  # of Jacobi rotations at most; six are usual
NOTHING = 1e-16  # of the diagonal: what need not be rotated away,
SQUARE = 1e-15  # and of the lengths of two columns


def solved(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve A X = B by elimination with row pivots; A (..., n, n), B (..., n, k).

    Raises np.linalg.LinAlgError where a matrix is singular.
    """
    n = matrices.shape[-1]
    shape = np.broadcast_shapes(matrices.shape[:-2], right.shape[:-2])
    both = [
        np.broadcast_to(part, shape + part.shape[-2:]).reshape(math.prod(shape), *part.shape[-2:])
        for part in (matrices, right)
    ]
    rows = np.concatenate(both, axis=2).astype(float)
    each = np.arange(len(rows))
    for k in range(n):
        pivot = k + np.abs(rows[:, k:, k]).argmax(axis=1)
        first = rows[each, pivot]
        if (first[:, k] == 0.0).any():
            raise np.linalg.LinAlgError("singular matrix")
        rows[each, pivot] = rows[:, k]
        rows[:, k] = first / first[:, k, None]
        factors = rows[:, :, k].copy()
        factors[:, k] = 0.0
        rows[:, :, k:] -= factors[:, :, None] * rows[:, None, k, k:]
    return rows[:, :, n:].reshape(*shape, n, right.shape[-1])


def inverse(matrices: np.ndarray) -> np.ndarray:
    """Invert each matrix, (..., n, n). Raises np.linalg.LinAlgError where one is singular."""
    return solved(matrices, np.eye(matrices.shape[-1]))


def solved_tridiagonal(diagonal: np.ndarray, beside: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve A x = b for one positive definite tridiagonal A; diagonal (n,), beside (n − 1,), b (n, ...)."""
    pivots, found = diagonal.astype(float), right.astype(float)
    for i in range(1, len(pivots)):
        share = beside[i - 1] / pivots[i - 1]
        pivots[i] -= share * beside[i - 1]
        found[i] -= share * found[i - 1]
    for i in range(len(pivots) - 1, -1, -1):
        if i + 1 < len(pivots):
            found[i] -= beside[i] * found[i + 1]
        found[i] /= pivots[i]
    return found


def determinants(matrices: np.ndarray) -> np.ndarray:
    """Compute determinants of matrices (..., 2, 2) or (..., 3, 3), written out."""
    if matrices.shape[-1] == 2:
        return matrices[..., 0, 0] * matrices[..., 1, 1] - matrices[..., 0, 1] * matrices[..., 1, 0]
    crossed = np.cross(matrices[..., 1, :], matrices[..., 2, :])
    return (matrices[..., 0, :] * crossed).sum(axis=-1)


def root(matrix: np.ndarray) -> np.ndarray:
    """Compute the Cholesky factor L of a positive definite A = L Lᵀ, lower triangular, (n, n)."""
    found, left = np.zeros_like(matrix), matrix.copy()
    for k in range(len(matrix)):
        found[k:, k] = left[k:, k] / np.sqrt(left[k, k])
        left[k:, k:] -= found[k:, k, None] * found[None, k:, k]
    return found


def diagonalised(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute eigenvalues of symmetric matrices, ascending, (..., n), and eigenvectors as columns, (..., n, n).

    Jacobi's rotations, row by row (Golub and Van Loan, Matrix Computations, 8.5).
    """
    n, count = matrices.shape[-1], math.prod(matrices.shape[:-2])
    a = matrices.reshape(count, n, n).astype(float)
    vectors = np.tile(np.eye(n), (len(a), 1, 1))
    pairs = [(p, q) for p in range(n) for q in range(p + 1, n)]
    for _ in range(SWEEPS):
        turned = False
        for p, q in pairs:
            scale = np.sqrt(np.abs(a[:, p, p])) * np.sqrt(np.abs(a[:, q, q]))
            off = np.where(np.abs(a[:, p, q]) > NOTHING * scale, a[:, p, q], 0.0)
            if off.any():
                turned = True
                turns = _turns(off, a[:, p, p], a[:, q, q])
                _rotate(a, p, q, *turns)
                _rotate(a.swapaxes(1, 2), p, q, *turns)
                _rotate(vectors, p, q, *turns)
                a[off != 0.0, p, q] = a[off != 0.0, q, p] = 0.0
        if not turned:
            break
    values = np.diagonal(a, axis1=1, axis2=2)
    order = np.argsort(values, axis=1, kind="stable")
    values, vectors = np.take_along_axis(values, order, 1), np.take_along_axis(vectors, order[:, None], 2)
    return values.reshape(matrices.shape[:-1]), vectors.reshape(matrices.shape)


def singular(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the singular value decomposition A = U diag(s) Vᵀ, descending; U (m, k), s (k,), V (k, k); columns of U
    are 0 where s is.

    Jacobi's rotations of one side (Hestenes; Golub and Van Loan, 8.6), exact for small singular values as well.
    """
    columns, k = matrix[None].astype(float), matrix.shape[1]
    right = np.eye(k)[None].copy()
    for _ in range(SWEEPS):
        turned = False
        for p in range(k):
            for q in range(p + 1, k):
                one, two = columns[0, :, p], columns[0, :, q]
                alpha, beta, off = product(one, one), product(two, two), product(one, two)
                if abs(off) > SQUARE * math.sqrt(alpha) * math.sqrt(beta):
                    turned = True
                    turns = _turns(*np.array([[off], [alpha], [beta]]))
                    _rotate(columns, p, q, *turns)
                    _rotate(right, p, q, *turns)
        if not turned:
            break
    sizes = np.sqrt((columns[0] ** 2).sum(axis=0))
    order = np.argsort(-sizes, kind="stable")
    left = np.divide(columns[0], sizes, out=np.zeros_like(columns[0]), where=sizes > 0.0)
    return left[:, order], sizes[order], right[0][:, order]


def least_squares(matrix: np.ndarray, right: np.ndarray, least: float = 1e-15) -> np.ndarray:
    """Solve the least-squares problem min |A x − b| for the shortest x; A (m, k), b (m,).

    least: share of the largest singular value, up to which another counts as zero.
    """
    left, sizes, axes = singular(matrix)
    kept = sizes > least * sizes.max(initial=0.0)
    shares = np.divide(product(left.T, right), sizes, out=np.zeros_like(sizes), where=kept)
    return product(axes, shares)


def _turns(off: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of the smaller Jacobi rotation that cancels `off` between two diagonal entries, (n,) each."""
    doubled = np.where(off == 0.0, 1.0, 2.0 * off)
    cotangent = (second - first) / doubled
    tangent = np.where(cotangent < 0.0, -1.0, 1.0) / (np.abs(cotangent) + np.sqrt(1.0 + cotangent**2))
    tangent = np.where(off == 0.0, 0.0, tangent)
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    return cosine, tangent * cosine


def _rotate(matrices: np.ndarray, p: int, q: int, cosine: np.ndarray, sine: np.ndarray) -> None:
    """Rotate columns p and q of each matrix (n, m, k) into each other, in place."""
    one, two = matrices[:, :, p].copy(), matrices[:, :, q].copy()
    matrices[:, :, p] = cosine[:, None] * one - sine[:, None] * two
    matrices[:, :, q] = sine[:, None] * one + cosine[:, None] * two
