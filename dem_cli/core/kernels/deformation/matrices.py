"""Tuple algebra of square matrices: deformation gradients, strain rates and dyads of a block; one source for 2D and 3D.

A matrix is a tuple of its rows. Each function is plain Python too, as in vec.py.
"""

from __future__ import annotations

from dem_cli.core.kernels.jit import inline, overload
from dem_cli.core.kernels.vec import dot, load, scale, store


def load_matrix(array, row, like):
    """Load array[row] as a matrix of as many rows as `like` is long."""
    d = len(like)
    return tuple(tuple(array[row, k * d : k * d + d]) for k in range(d))


@overload(load_matrix)
def _load_matrix(array, row, like):
    if len(like) == 2:
        return lambda array, row, like: (load(array, row, 0, like), load(array, row, 2, like))
    return lambda array, row, like: (load(array, row, 0, like), load(array, row, 3, like), load(array, row, 6, like))


@inline
def store_matrix(array, row, matrix):
    """Store a matrix as array[row], row by row."""
    for k in range(len(matrix)):
        store(array, row, k * len(matrix), matrix[k])


def times(matrix, vector):
    """Multiply a matrix by a vector."""
    return tuple(dot(row, vector) for row in matrix)


@overload(times)
def _times(matrix, vector):
    if len(matrix) == 2:
        return lambda matrix, vector: (dot(matrix[0], vector), dot(matrix[1], vector))
    return lambda matrix, vector: (dot(matrix[0], vector), dot(matrix[1], vector), dot(matrix[2], vector))


def transposed(matrix):
    """Transpose a matrix."""
    return tuple(zip(*matrix, strict=True))


@overload(transposed)
def _transposed(matrix):
    if len(matrix) == 2:
        return lambda matrix: ((matrix[0][0], matrix[1][0]), (matrix[0][1], matrix[1][1]))
    return lambda matrix: (
        (matrix[0][0], matrix[1][0], matrix[2][0]),
        (matrix[0][1], matrix[1][1], matrix[2][1]),
        (matrix[0][2], matrix[1][2], matrix[2][2]),
    )


def product(first, second):
    """Multiply two matrices."""
    columns = transposed(second)
    return tuple(times(columns, row) for row in first)


@overload(product)
def _product(first, second):
    if len(first) == 2:

        def planar(first, second):
            columns = transposed(second)
            return times(columns, first[0]), times(columns, first[1])

        return planar

    def spatial(first, second):
        columns = transposed(second)
        return times(columns, first[0]), times(columns, first[1]), times(columns, first[2])

    return spatial


def inverse(matrix):
    """Invert a matrix that is not singular, by its cofactors."""
    return _planar_inverse(matrix) if len(matrix) == 2 else _spatial_inverse(matrix)


@overload(inverse)
def _inverse(matrix):
    return _planar_inverse if len(matrix) == 2 else _spatial_inverse


def _planar_inverse(matrix):
    (a, b), (c, d) = matrix
    per = 1.0 / (a * d - b * c)
    return (per * d, -per * b), (-per * c, per * a)


def _spatial_inverse(matrix):
    (a, b, c), (d, e, f), (g, h, i) = matrix
    one, two, three = e * i - f * h, f * g - d * i, d * h - e * g
    per = 1.0 / (a * one + b * two + c * three)
    return (
        scale(per, (one, c * h - b * i, b * f - c * e)),
        scale(per, (two, a * i - c * g, c * d - a * f)),
        scale(per, (three, b * g - a * h, a * e - b * d)),
    )
