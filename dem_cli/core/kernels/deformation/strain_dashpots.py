"""Dashpots and Maxwell elements between blocks that deform: how contact points move by strains, and what impulses do.

A row for each point, block and axis of the world has the velocity of the material point by the rate of each mode, the
turning of the block by it included (strain_rates.py); to the first order of strains. Rates and impulses share these
rows, so that dashpots only take. Where all blocks are rigid `motions` has one axis, and nothing of this is compiled.
"""

from __future__ import annotations

from dem_cli.core.kernels.deformation.quadratic import COEFFICIENTS, N_QUADRATIC
from dem_cli.core.kernels.jit import inline, overload


def arm_of(frame, reach):
    """Return the arm from the centroid of a block to a point: from its levers in the plane, the reach in space."""
    return _arm_in_plane(frame, reach) if len(frame) == 2 else reach


@overload(arm_of)
def _arm_of(frame, reach):
    return _arm_in_plane if len(frame) == 2 else lambda frame, reach: reach


def _arm_in_plane(frame, reach):
    normal, tangent = frame
    sense = normal[0] * tangent[1] - normal[1] * tangent[0]
    along, across = -sense * reach[0][0], sense * reach[1][0]
    return (across * normal[0] + along * tangent[0], across * normal[1] + along * tangent[1])


def put_motions(motions, lifts, strained, bodies, point, side, block, arm):
    """Store the rows of a point of a block: motion by rates of modes, and rates of modes by impulses."""
    if motions.ndim > 1:
        if len(arm) == 2:
            _put_in_plane(motions, lifts, strained, bodies, point, side, block, arm)
        else:
            _put_in_space(motions, lifts, strained, bodies, point, side, block, arm)


@overload(put_motions)
def _put_motions(motions, lifts, strained, bodies, point, side, block, arm):
    if motions.ndim == 1:
        return lambda motions, lifts, strained, bodies, point, side, block, arm: None
    return _put_in_plane if len(arm) == 2 else _put_in_space


@inline
def _put_in_plane(motions, lifts, strained, bodies, point, side, block, arm):
    turns, n = bodies.turns, motions.shape[3]
    c, s, scale = turns[block, 0], turns[block, 1], 1.0 / strained.radii[block]
    x, y = c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]
    for k in range(n):
        spin = -strained.turns[block, 0, k]
        u, v = -spin * y, spin * x
        if k == 0:
            u, v = u + scale * x, v + scale * y
        elif k == 1:
            u, v = u + scale * x, v - scale * y
        elif k == 2:
            u, v = u + scale * y, v + scale * x
        else:
            at = (k - n + N_QUADRATIC) * COEFFICIENTS
            p = strained.bends
            u += p[block, at] + p[block, at + 1] * x + p[block, at + 2] * y
            u += p[block, at + 3] * x * x + p[block, at + 4] * x * y + p[block, at + 5] * y * y
            v += p[block, at + 6] + p[block, at + 7] * x + p[block, at + 8] * y
            v += p[block, at + 9] * x * x + p[block, at + 10] * x * y + p[block, at + 11] * y * y
        motions[point, side, 0, k], motions[point, side, 1, k] = c * u - s * v, s * u + c * v
    _put_lifts(motions, lifts, strained, point, side, block)


@inline
def _put_in_space(motions, lifts, strained, bodies, point, side, block, arm):
    r, per = bodies.turns, 1.0 / strained.radii[block]
    x = r[block, 0] * arm[0] + r[block, 3] * arm[1] + r[block, 6] * arm[2]
    y = r[block, 1] * arm[0] + r[block, 4] * arm[1] + r[block, 7] * arm[2]
    z = r[block, 2] * arm[0] + r[block, 5] * arm[1] + r[block, 8] * arm[2]
    strains = (
        (x, y, z), (x, -y, 0.0), (x, y, -2.0 * z), (0.0, z, y), (z, 0.0, x), (y, x, 0.0)
    )  # fmt: skip
    for k in range(6):
        one = strains[k]
        a, b, c = -strained.turns[block, 0, k], -strained.turns[block, 1, k], -strained.turns[block, 2, k]
        u, v, w = per * one[0] + b * z - c * y, per * one[1] + c * x - a * z, per * one[2] + a * y - b * x
        for i in range(3):
            motions[point, side, i, k] = r[block, 3 * i] * u + r[block, 3 * i + 1] * v + r[block, 3 * i + 2] * w
    _put_lifts(motions, lifts, strained, point, side, block)


@inline
def _put_lifts(motions, lifts, strained, point, side, block):
    for i in range(motions.shape[2]):
        for k in range(motions.shape[3]):
            total = 0.0
            for j in range(motions.shape[3]):
                total += strained.mobilities[block, k, j] * motions[point, side, i, j]
            lifts[point, side, i, k] = total


def plus_modes(motions, velocities, point, a, b, relative):
    """Add to the velocity of b against a at a point what rates of modes contribute."""
    if motions.ndim == 1:
        return relative
    return tuple(part + _axis(motions, velocities, point, a, b, i) for i, part in enumerate(relative))


@overload(plus_modes)
def _plus_modes(motions, velocities, point, a, b, relative):
    if motions.ndim == 1:
        return lambda motions, velocities, point, a, b, relative: relative
    if len(relative) == 2:
        return lambda motions, velocities, point, a, b, relative: (
            relative[0] + _axis(motions, velocities, point, a, b, 0),
            relative[1] + _axis(motions, velocities, point, a, b, 1),
        )
    return lambda motions, velocities, point, a, b, relative: (
        relative[0] + _axis(motions, velocities, point, a, b, 0),
        relative[1] + _axis(motions, velocities, point, a, b, 1),
        relative[2] + _axis(motions, velocities, point, a, b, 2),
    )


@inline
def _axis(motions, velocities, point, a, b, i):
    n, total = motions.shape[3], 0.0
    first = velocities.shape[1] - n
    for k in range(n):
        total += motions[point, 1, i, k] * velocities[b, first + k] - motions[point, 0, i, k] * velocities[a, first + k]
    return total


def push_modes(rows, target, point, a, b, force):
    """Apply a force onto b, and against a, to their modes by `motions`, or to the rates of these by `lifts`."""
    if rows.ndim > 1:
        _push(rows, target, point, a, b, force)


@overload(push_modes)
def _push_modes(rows, target, point, a, b, force):
    return (lambda rows, target, point, a, b, force: None) if rows.ndim == 1 else _push


@inline
def _push(rows, target, point, a, b, force):
    n = rows.shape[3]
    first = target.shape[1] - n
    for k in range(n):
        on_a = on_b = 0.0
        for i in range(len(force)):
            on_a += rows[point, 0, i, k] * force[i]
            on_b += rows[point, 1, i, k] * force[i]
        target[a, first + k] -= on_a
        target[b, first + k] += on_b


def give_pushes(motions, strained, velocities, pushes, block):
    """Change the rates of the modes of a block by its impulses."""
    if motions.ndim > 1:
        _give(motions, strained, velocities, pushes, block)


@overload(give_pushes)
def _give_pushes(motions, strained, velocities, pushes, block):
    return (lambda motions, strained, velocities, pushes, block: None) if motions.ndim == 1 else _give


@inline
def _give(motions, strained, velocities, pushes, block):
    n = motions.shape[3]
    first = velocities.shape[1] - n
    for k in range(n):
        for j in range(n):
            velocities[block, first + k] += strained.mobilities[block, k, j] * pushes[block, first + j]


def mobility_along(motions, lifts, point, direction, inverse):
    """Compute the rate of a point along a direction by a unit impulse along it, strains included."""
    return inverse if motions.ndim == 1 else inverse + _along(motions, lifts, point, direction, direction)


@overload(mobility_along)
def _mobility_along(motions, lifts, point, direction, inverse):
    if motions.ndim == 1:
        return lambda motions, lifts, point, direction, inverse: inverse
    return lambda motions, lifts, point, direction, inverse: (
        inverse + _along(motions, lifts, point, direction, direction)
    )


@inline
def _along(motions, lifts, point, one, other):
    total = 0.0
    for side in range(2):
        for k in range(motions.shape[3]):
            rate = lift = 0.0
            for i in range(len(one)):
                rate += one[i] * motions[point, side, i, k]
                lift += other[i] * lifts[point, side, i, k]
            total += rate * lift
    return total


def mobility_of(motions, lifts, point):
    """Compute the mobility of a point in space by strains, xx xy xz yy yz zz; an empty tuple where blocks are rigid."""
    return () if motions.ndim == 1 else _mobility_in_space(motions, lifts, point)


@overload(mobility_of)
def _mobility_of(motions, lifts, point):
    return (lambda motions, lifts, point: ()) if motions.ndim == 1 else _mobility_in_space


@inline
def _mobility_in_space(motions, lifts, point):
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    return (
        _along(motions, lifts, point, x, x), _along(motions, lifts, point, x, y), _along(motions, lifts, point, x, z),
        _along(motions, lifts, point, y, y), _along(motions, lifts, point, y, z), _along(motions, lifts, point, z, z),
    )  # fmt: skip


def with_mobility(values, more):
    """Add two mobilities; more: empty where blocks are rigid."""
    return values if len(more) == 0 else tuple(a + b for a, b in zip(values, more, strict=True))


@overload(with_mobility)
def _with_mobility(values, more):
    if len(more) == 0:
        return lambda values, more: values
    return lambda values, more: (
        values[0] + more[0], values[1] + more[1], values[2] + more[2],
        values[3] + more[3], values[4] + more[4], values[5] + more[5],
    )  # fmt: skip
