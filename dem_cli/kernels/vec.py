"""Tuple algebra: one source for 2D and 3D. The length of a tuple is part of its type.

A vector has d components (2 or 3), a rotation r components (1 or 3). `like` is any tuple of the
wanted length; only its length matters. Each function is plain Python too, for uncompiled tests.
"""

from __future__ import annotations

import math

from dem_cli.kernels.jit import inline, overload


def load(array, row, start, like):
    """array[row, start : start + len(like)] as a tuple."""
    return tuple(array[row, start + k] for k in range(len(like)))


@overload(load)
def _load(array, row, start, like):
    if len(like) == 1:
        return lambda array, row, start, like: (array[row, start],)
    if len(like) == 2:
        return lambda array, row, start, like: (array[row, start], array[row, start + 1])
    return lambda array, row, start, like: (array[row, start], array[row, start + 1], array[row, start + 2])


def add_at(array, row, start, vector, sign):
    """array[row, start:] += sign * vector."""
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
    """array[row, start:] = vector."""
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
    """a * x + y."""
    return tuple(a * p + q for p, q in zip(x, y, strict=True))


@overload(axpy)
def _axpy(a, x, y):
    if len(x) == 1:
        return lambda a, x, y: (a * x[0] + y[0],)
    if len(x) == 2:
        return lambda a, x, y: (a * x[0] + y[0], a * x[1] + y[1])
    return lambda a, x, y: (a * x[0] + y[0], a * x[1] + y[1], a * x[2] + y[2])


def dot(x, y):
    """Scalar product."""
    return sum(p * q for p, q in zip(x, y, strict=True))


@overload(dot)
def _dot(x, y):
    if len(x) == 1:
        return lambda x, y: x[0] * y[0]
    if len(x) == 2:
        return lambda x, y: x[0] * y[0] + x[1] * y[1]
    return lambda x, y: x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def spin(rotation, arm):
    """Velocity of a point at `arm` of a body that turns with `rotation`: ω × r."""
    if len(arm) == 2:
        return (-rotation[0] * arm[1], rotation[0] * arm[0])
    return _cross(rotation, arm)


@overload(spin)
def _spin(rotation, arm):
    if len(arm) == 2:
        return lambda rotation, arm: (-rotation[0] * arm[1], rotation[0] * arm[0])
    return lambda rotation, arm: _cross(rotation, arm)


def moment(arm, force):
    """Moment of a force at `arm`: r × F, as a tuple of r components."""
    if len(arm) == 2:
        return (arm[0] * force[1] - arm[1] * force[0],)
    return _cross(arm, force)


@overload(moment)
def _moment(arm, force):
    if len(arm) == 2:
        return lambda arm, force: (arm[0] * force[1] - arm[1] * force[0],)
    return lambda arm, force: _cross(arm, force)


@inline
def _cross(x, y):
    return (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])


def along_tangents(frame, vector):
    """Components of a vector along the tangents of a frame (normal, tangent, ...): d − 1 numbers."""
    return tuple(dot(tangent, vector) for tangent in frame[1:])


@overload(along_tangents)
def _along_tangents(frame, vector):
    if len(frame) == 2:
        return lambda frame, vector: (dot(frame[1], vector),)
    return lambda frame, vector: (dot(frame[1], vector), dot(frame[2], vector))


def compose(frame, normal_part, tangent_parts):
    """The vector with these components along the normal and the tangents of a frame."""
    total = tuple(normal_part * c for c in frame[0])
    for part, tangent in zip(tangent_parts, frame[1:], strict=True):
        total = axpy(part, tangent, total)
    return total


@overload(compose)
def _compose(frame, normal_part, tangent_parts):
    if len(frame) == 2:

        def planar(frame, normal_part, tangent_parts):
            n, t = frame
            return (
                normal_part * n[0] + tangent_parts[0] * t[0],
                normal_part * n[1] + tangent_parts[0] * t[1],
            )

        return planar

    def spatial(frame, normal_part, tangent_parts):
        n, t, u = frame
        a, b = tangent_parts
        return (
            normal_part * n[0] + a * t[0] + b * u[0],
            normal_part * n[1] + a * t[1] + b * u[1],
            normal_part * n[2] + a * t[2] + b * u[2],
        )

    return spatial


def load_frame(frames, joint, like):
    """The frame of a joint: a tuple of d unit vectors, normal first."""
    return tuple(tuple(row) for row in frames[joint])


@overload(load_frame)
def _load_frame(frames, joint, like):
    if len(like) == 2:
        return lambda frames, joint, like: (
            (frames[joint, 0, 0], frames[joint, 0, 1]),
            (frames[joint, 1, 0], frames[joint, 1, 1]),
        )
    return lambda frames, joint, like: (
        (frames[joint, 0, 0], frames[joint, 0, 1], frames[joint, 0, 2]),
        (frames[joint, 1, 0], frames[joint, 1, 1], frames[joint, 1, 2]),
        (frames[joint, 2, 0], frames[joint, 2, 1], frames[joint, 2, 2]),
    )


@inline
def norm(x):
    """Length of a vector."""
    return math.sqrt(dot(x, x))
