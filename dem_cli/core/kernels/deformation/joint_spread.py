"""Relative motion along a joint of deformable blocks, and dyads of its forces; 2D and 3D.

On geometry of the start a joint has one frame and one anchor; a place is counted along the tangents. By strain alone a
place moves by what its anchor does and by ΔD t for each of its coordinates, ΔD: of b less of a.
"""

from __future__ import annotations

from dem_cli.core.kernels.deformation.matrices import times
from dem_cli.core.kernels.jit import inline, overload
from dem_cli.core.kernels.vec import axpy, components, compose, scale


def spread_of(frame, gradient_a, gradient_b, dt):
    """Compute for each tangent the motion of b against a by strain, per metre along it; in the frame of the joint."""
    return tuple(_one_spread(frame, gradient_a, gradient_b, tangent, dt) for tangent in frame[1:])


@overload(spread_of)
def _spread_of(frame, gradient_a, gradient_b, dt):
    if len(frame) == 2:
        return lambda frame, gradient_a, gradient_b, dt: (_one_spread(frame, gradient_a, gradient_b, frame[1], dt),)
    return lambda frame, gradient_a, gradient_b, dt: (
        _one_spread(frame, gradient_a, gradient_b, frame[1], dt),
        _one_spread(frame, gradient_a, gradient_b, frame[2], dt),
    )


@inline
def _one_spread(frame, gradient_a, gradient_b, tangent, dt):
    return times(frame, scale(dt, axpy(-1.0, times(gradient_a, tangent), times(gradient_b, tangent))))


def spread_at(spread, place):
    """Compute opening and sliding of a place by the strain of the blocks of its joint."""
    total = scale(place[0], spread[0])
    for share, one in zip(place[1:], spread[1:], strict=True):
        total = axpy(share, one, total)
    return total[0], total[1:]


@overload(spread_at)
def _spread_at(spread, place):
    if len(place) == 1:

        def planar(spread, place):
            total = scale(place[0], spread[0])
            return total[0], (total[1],)

        return planar

    def spatial(spread, place):
        total = axpy(place[1], spread[1], scale(place[0], spread[0]))
        return total[0], (total[1], total[2])

    return spatial


def no_leverage(like):
    """Return zero sums of place × force of a joint: for each tangent a vector in the frame of the joint."""
    return (scale(0.0, like),) * (len(like) - 1)


@overload(no_leverage)
def _no_leverage(like):
    if len(like) == 2:
        return lambda like: (scale(0.0, like),)
    return lambda like: (scale(0.0, like), scale(0.0, like))


def add_leverage(leverage, place, normal, shear):
    """Add place × force of one more place."""
    force = (normal, *shear)
    return tuple(axpy(share, force, one) for share, one in zip(place, leverage, strict=True))


@overload(add_leverage)
def _add_leverage(leverage, place, normal, shear):
    if len(place) == 1:
        return lambda leverage, place, normal, shear: (axpy(place[0], (normal, shear[0]), leverage[0]),)

    def spatial(leverage, place, normal, shear):
        force = (normal, shear[0], shear[1])
        return axpy(place[0], force, leverage[0]), axpy(place[1], force, leverage[1])

    return spatial


@inline
def add_spread_dyads(dyads, a, b, frame, leverage):
    """Add dyads of the forces of a joint about its anchor to block b, and subtract them from block a."""
    d = len(frame)
    for k in range(d - 1):
        normal, along = leverage[k][0], leverage[k][1:]
        force = compose(frame, normal, along, scale(0.0, frame[0]))
        for row in range(d):
            for column in range(d):
                dyad = force[row] * frame[k + 1][column]
                dyads[a, d * row + column] -= dyad
                dyads[b, d * row + column] += dyad


@inline
def spread_between(frame, gradient_a, gradient_b, arm_a, arm_b):
    """Compute the speed of sliding of b against a at a point, by strain alone."""
    return components(frame, axpy(-1.0, times(gradient_a, arm_a), times(gradient_b, arm_b)))[1]
