"""Tuple algebra: one source for 2D and 3D. The length of a tuple is part of its type.

A vector has d components (2 or 3), a rotation r components (1 or 3). `like` is any tuple of the
wanted length; only its length matters. Each function is plain Python too, for uncompiled tests.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, built_in, overload


def load(array, row, start, like):
    """Load array[row, start : start + len(like)] as a tuple."""
    return tuple(array[row, start + k] for k in range(len(like)))


@overload(load)
def _load(array, row, start, like):
    if len(like) == 1:
        return lambda array, row, start, like: (array[row, start],)
    if len(like) == 2:
        return lambda array, row, start, like: (array[row, start], array[row, start + 1])
    return lambda array, row, start, like: (array[row, start], array[row, start + 1], array[row, start + 2])


def add_at(array, row, start, vector, sign):
    """Add a vector in place: array[row, start:] += sign * vector."""
    for k in range(len(vector)):
        array[row, start + k] += sign * vector[k]


@overload(add_at)
def _add_at(array, row, start, vector, sign):
    if len(vector) == 1:

        def one(array, row, start, vector, sign):
            array[row, start] += sign * vector[0]

        return one
    if len(vector) == 2:

        def two(array, row, start, vector, sign):
            array[row, start] += sign * vector[0]
            array[row, start + 1] += sign * vector[1]

        return two

    def three(array, row, start, vector, sign):
        array[row, start] += sign * vector[0]
        array[row, start + 1] += sign * vector[1]
        array[row, start + 2] += sign * vector[2]

    return three


def store(array, row, start, vector):
    """Store a vector in array[row, start:]."""
    for k in range(len(vector)):
        array[row, start + k] = vector[k]


@overload(store)
def _store(array, row, start, vector):
    if len(vector) == 1:

        def one(array, row, start, vector):
            array[row, start] = vector[0]

        return one
    if len(vector) == 2:

        def two(array, row, start, vector):
            array[row, start] = vector[0]
            array[row, start + 1] = vector[1]

        return two

    def three(array, row, start, vector):
        array[row, start] = vector[0]
        array[row, start + 1] = vector[1]
        array[row, start + 2] = vector[2]

    return three


def axpy(a, x, y):
    """Compute a * x + y for vectors."""
    return tuple(a * p + q for p, q in zip(x, y, strict=True))


@overload(axpy)
def _axpy(a, x, y):
    if len(x) == 1:
        return lambda a, x, y: (a * x[0] + y[0],)
    if len(x) == 2:
        return lambda a, x, y: (a * x[0] + y[0], a * x[1] + y[1])
    return lambda a, x, y: (a * x[0] + y[0], a * x[1] + y[1], a * x[2] + y[2])


def dot(x, y):
    """Compute the scalar product of two vectors."""
    return sum(p * q for p, q in zip(x, y, strict=True))


@overload(dot)
def _dot(x, y):
    if len(x) == 1:
        return lambda x, y: x[0] * y[0]
    if len(x) == 2:
        return lambda x, y: x[0] * y[0] + x[1] * y[1]
    return lambda x, y: x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def components(frame, vector):
    """Resolve a vector along the normal and the tangents of a frame: a number and d − 1 numbers."""
    return dot(frame[0], vector), tuple(dot(tangent, vector) for tangent in frame[1:])


@overload(components)
def _components(frame, vector):
    if len(frame) == 2:
        return lambda frame, vector: (dot(frame[0], vector), (dot(frame[1], vector),))
    return lambda frame, vector: (dot(frame[0], vector), (dot(frame[1], vector), dot(frame[2], vector)))


def compose(frame, normal_part, tangent_parts, start):
    """Compute start + normal_part × normal + tangent_parts × tangents."""
    total = axpy(normal_part, frame[0], start)
    for part, tangent in zip(tangent_parts, frame[1:], strict=True):
        total = axpy(part, tangent, total)
    return total


@overload(compose)
def _compose(frame, normal_part, tangent_parts, start):
    if len(frame) == 2:
        return lambda frame, normal_part, tangent_parts, start: axpy(
            tangent_parts[0], frame[1], axpy(normal_part, frame[0], start)
        )
    return lambda frame, normal_part, tangent_parts, start: axpy(
        tangent_parts[1], frame[2], axpy(tangent_parts[0], frame[1], axpy(normal_part, frame[0], start))
    )


def load_levers(levers, point, side, like):
    """Load the d levers of a point about the centroid of block a (side 0) or b (side 1), each with r components.

    A lever is the moment of a unit force along one direction of the frame: arm × direction.
    """
    d = len(like)
    r = 1 if d == 2 else 3
    return tuple(tuple(levers[point, (side * d + k) * r : (side * d + k + 1) * r]) for k in range(d))


@overload(load_levers)
def _load_levers(levers, point, side, like):
    if len(like) == 2:
        return lambda levers, point, side, like: ((levers[point, 2 * side],), (levers[point, 2 * side + 1],))
    return lambda levers, point, side, like: (
        (levers[point, 9 * side], levers[point, 9 * side + 1], levers[point, 9 * side + 2]),
        (levers[point, 9 * side + 3], levers[point, 9 * side + 4], levers[point, 9 * side + 5]),
        (levers[point, 9 * side + 6], levers[point, 9 * side + 7], levers[point, 9 * side + 8]),
    )


def turn(levers, rotation):
    """Compute the motion of a point along the normal and the tangents when its block turns: lever · ω."""
    return components(levers, rotation)


@overload(turn)
def _turn(levers, rotation):
    if len(levers) == 2:
        return lambda levers, rotation: (dot(levers[0], rotation), (dot(levers[1], rotation),))
    return lambda levers, rotation: (dot(levers[0], rotation), (dot(levers[1], rotation), dot(levers[2], rotation)))


@always_inline
def sliding(frame, levers_a, levers_b, relative, spin_a, spin_b, dt):
    """Compute the slide of b against a along the tangents in a step at a point with these levers [m]."""
    slid_a, slid_b = turn(levers_a, spin_a)[1], turn(levers_b, spin_b)[1]
    return scale(dt, axpy(1.0, components(frame, relative)[1], axpy(-1.0, slid_a, slid_b)))


def add_torques(levers, normal_part, tangent_parts, start):
    """Add to start the moment of a force given by its components along the frame."""
    return compose(levers, normal_part, tangent_parts, start)


@overload(add_torques)
def _add_torques(levers, normal_part, tangent_parts, start):
    return lambda levers, normal_part, tangent_parts, start: compose(levers, normal_part, tangent_parts, start)


def load_frame(frames, point, like):
    """Load the frame of a point: d unit vectors, normal first. In 2D the tangent is the normal turned by +90°."""
    d = len(like)
    if d == 2:
        return ((frames[point, 0], frames[point, 1]), (-frames[point, 1], frames[point, 0]))
    return tuple(tuple(frames[point, k * d : k * d + d]) for k in range(d))


@overload(load_frame)
def _load_frame(frames, point, like):
    if len(like) == 2:

        def planar(frames, point, like):
            nx, ny = frames[point, 0], frames[point, 1]
            return ((nx, ny), (-ny, nx))

        return planar
    return lambda frames, point, like: (
        (frames[point, 0], frames[point, 1], frames[point, 2]),
        (frames[point, 3], frames[point, 4], frames[point, 5]),
        (frames[point, 6], frames[point, 7], frames[point, 8]),
    )


def scale(a, x):
    """Compute a * x for a vector."""
    return tuple(a * p for p in x)


@overload(scale)
def _scale(a, x):
    if len(x) == 1:
        return lambda a, x: (a * x[0],)
    if len(x) == 2:
        return lambda a, x: (a * x[0], a * x[1])
    return lambda a, x: (a * x[0], a * x[1], a * x[2])


def norm(x):
    """Compute the length of a vector."""
    return abs(x[0]) if len(x) == 1 else math.sqrt(dot(x, x))


@overload(norm)
def _norm(x):
    if len(x) == 1:
        return lambda x: abs(x[0])
    return lambda x: math.sqrt(dot(x, x))


@built_in
def in_a_row(array):
    """View all numbers of an array in C order, (n,), where they are."""
    return array.reshape(-1)


@built_in
def shaped_as(array, like):
    """View the numbers of an array, where they are, in the shape of another one with as many."""
    return array.reshape(like.shape)
