"""Spin of rigid blocks in space: Euler's equations without torque, turns of quaternions, rotation matrices.

A block that nothing touches turns by (implicit midpoint, in the principal axes)

    m = w₀ + k J⁻¹ (J m × m),    w₁ = 2 m − w₀,    q₁ = q₀ (1, k m)/|1, k m|,    k = tan(|m| dt/2)/|m|.

It keeps energy and the spatial angular momentum, whatever k: the quaternion is the Cayley turn of the same vector.
With k = dt/2 that is the midpoint rule itself; as it is, a spin about a principal axis turns by exactly |w| dt.

What time histories do otherwise in space than in the plane is here, by the length of `like_rotation`: a torque changes
all components of a spin, and energies need the tensor of inertia, whose terms in the plane stand with the masses.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, inline, overload
from dem_cli.core.kernels.vec import axpy, dot, load, load_frame, norm, scale

ITERATIONS = 8  # of the midpoint, at most; each gains as many digits as a step turns by less than a radian
HELD = 2e-6  # rad: what touches a block that turned by less since then is where it was
CHANGE = 1e-30  # of |w|²: smaller changes of the midpoint, squared, are round-off


@always_inline
def half_turn(spin, dt):
    """Compute the quaternion of a turn by spin × dt, over its scalar, without it: tan(|spin| dt/2)/|spin| × spin."""
    half = 0.5 * dt
    square = half * half * dot(spin, spin)
    if square > 1e-3:
        angle = math.sqrt(square)
        return scale(half * math.tan(angle) / angle, spin)
    # tan(x)/x; what is left out is below 1e-17
    series = 1.0 + square * (1 / 3 + square * (2 / 15 + square * (17 / 315 + square * (62 / 2835))))
    return scale(half * series, spin)


@inline
def midpoint(spin, moments, dt):
    """Mean spin over a step without torque, along the principal axes, and the vector of its turn (`half_turn`)."""
    a = (moments[1] - moments[2]) / moments[0]
    b = (moments[2] - moments[0]) / moments[1]
    c = (moments[0] - moments[1]) / moments[2]
    least, mean = CHANGE * dot(spin, spin), spin
    turn = half_turn(mean, dt)
    for _ in range(ITERATIONS):
        x, y, z = mean
        mean = (spin[0] + a * turn[1] * z, spin[1] + b * turn[2] * x, spin[2] + c * turn[0] * y)
        turn = half_turn(mean, dt)
        x, y, z = mean[0] - x, mean[1] - y, mean[2] - z
        if x * x + y * y + z * z <= least:
            break
    return mean, turn


@always_inline
def turn_further(orientations, row, turn):
    """Turn the quaternion of a row by (1, turn) along the world axes; of length one."""
    w, x, y, z = orientations[row, 0], orientations[row, 1], orientations[row, 2], orientations[row, 3]
    a, b, c = turn
    w, x, y, z = (
        w - a * x - b * y - c * z,
        x + a * w + b * z - c * y,
        y + b * w + c * x - a * z,
        z + c * w + a * y - b * x,
    )
    inverse = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    orientations[row, 0], orientations[row, 1] = inverse * w, inverse * x
    orientations[row, 2], orientations[row, 3] = inverse * y, inverse * z


@always_inline
def note_turn(bodies, row):
    """Record whether a block has turned by more than HELD since this was last so."""
    now, then, change = bodies.orientations, bodies.poses, 0.0
    for k in range(4):
        change = max(change, abs(now[row, k] - then[row, k]))
    bodies.turned[row] = 0
    if not change <= 0.5 * HELD:
        bodies.turned[row] = 1
        for k in range(4):
            then[row, k] = now[row, k]


@always_inline
def turned(vector, turn):
    """Turn a vector by the quaternion (1, turn), along the world axes."""
    x, y, z = vector
    a, b, c = turn
    p, q, r = b * z - c * y, c * x - a * z, a * y - b * x
    twice = 2.0 / (1.0 + (a * a + b * b + c * c))
    return (
        x + twice * (p + (b * r - c * q)),
        y + twice * (q + (c * p - a * r)),
        z + twice * (r + (a * q - b * p)),
    )


@always_inline
def store_turn(turns, row, orientations):
    """Store the rotation matrix of the quaternion of a row, row by row."""
    w, x, y, z = orientations[row, 0], orientations[row, 1], orientations[row, 2], orientations[row, 3]
    turns[row, 0] = 1.0 - 2.0 * (y * y + z * z)
    turns[row, 1] = 2.0 * (x * y - w * z)
    turns[row, 2] = 2.0 * (x * z + w * y)
    turns[row, 3] = 2.0 * (x * y + w * z)
    turns[row, 4] = 1.0 - 2.0 * (x * x + z * z)
    turns[row, 5] = 2.0 * (y * z - w * x)
    turns[row, 6] = 2.0 * (x * z - w * y)
    turns[row, 7] = 2.0 * (y * z + w * x)
    turns[row, 8] = 1.0 - 2.0 * (x * x + y * y)


@always_inline
def along(axes, vector):
    """Resolve a vector into components along three axes."""
    return (dot(axes[0], vector), dot(axes[1], vector), dot(axes[2], vector))


@always_inline
def principal_axes(turns, axes, row):
    """Compute the principal axes of a block in the world: three unit vectors."""
    turn = load_frame(turns, row, (0.0, 0.0, 0.0))
    return (
        along(turn, (axes[row, 0], axes[row, 3], axes[row, 6])),
        along(turn, (axes[row, 1], axes[row, 4], axes[row, 7])),
        along(turn, (axes[row, 2], axes[row, 5], axes[row, 8])),
    )


@always_inline
def combined(axes, parts):
    """Compose a vector from components along three axes."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz), (p, q, r) = axes[0], axes[1], axes[2], parts
    return (p * ax + q * bx + r * cx, p * ay + q * by + r * cy, p * az + q * bz + r * cz)


@always_inline
def store_mobility(mobilities, row, axes, moments):
    """Store the inverse inertia tensor along the world axes, from principal axes and moments."""
    a, b, c = axes
    p, q, r = 1.0 / moments[0], 1.0 / moments[1], 1.0 / moments[2]
    mobilities[row, 0] = p * a[0] * a[0] + q * b[0] * b[0] + r * c[0] * c[0]
    mobilities[row, 4] = p * a[1] * a[1] + q * b[1] * b[1] + r * c[1] * c[1]
    mobilities[row, 8] = p * a[2] * a[2] + q * b[2] * b[2] + r * c[2] * c[2]
    xy = p * a[0] * a[1] + q * b[0] * b[1] + r * c[0] * c[1]
    xz = p * a[0] * a[2] + q * b[0] * b[2] + r * c[0] * c[2]
    yz = p * a[1] * a[2] + q * b[1] * b[2] + r * c[1] * c[2]
    mobilities[row, 1] = mobilities[row, 3] = xy
    mobilities[row, 2] = mobilities[row, 6] = xz
    mobilities[row, 5] = mobilities[row, 7] = yz


@always_inline
def _kick_in_space(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row):
    first = velocities.shape[1] * row + 3
    x = unbalanced[row, 3] - drags[first]
    y = unbalanced[row, 4] - drags[first + 1]
    z = unbalanced[row, 5] - drags[first + 2]
    for k in range(3):
        m = 3 * k
        change = mobilities[row, m] * x + mobilities[row, m + 1] * y + mobilities[row, m + 2] * z
        velocities[row, 3 + k] = pulled[first + k] = keep * old[first + k] + gain * change


def kick_spins(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row, like_rotation):
    """Update the spins of a block by a step of torque, damped; in the plane they stand where all velocities do.

    keep: of the velocity before; gain: time over which torques act [s].
    """
    if len(like_rotation) == 3:
        _kick_in_space(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row)


@overload(kick_spins)
def _kick_spins(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row, like_rotation):
    if len(like_rotation) == 1:
        return lambda velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row, like_rotation: None
    return lambda velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row, like_rotation: (
        _kick_in_space(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, row)
    )


@always_inline
def _powers_in_space(drained, dashpots, velocities, old, pulled, shape, turns, row):
    moments = load(shape.inertias, row, 0, (0.0, 0.0, 0.0))
    if moments[0] == 0.0:
        return drained, dashpots
    first, after = velocities.shape[1] * row + 3, load(velocities, row, 3, moments)
    before = (old[first], old[first + 1], old[first + 2])
    kicked = (pulled[first], pulled[first + 1], pulled[first + 2])
    axes = principal_axes(turns, shape.axes, row)
    a, b, c = along(axes, scale(0.5, axpy(1.0, before, after)))
    momentum = (moments[0] * a, moments[1] * b, moments[2] * c)
    drained += dot(momentum, along(axes, axpy(1.0, before, kicked)))
    dashpots += dot(momentum, along(axes, axpy(-1.0, kicked, after)))
    return drained, dashpots


def add_spin_powers(drained, dashpots, velocities, old, pulled, shape, turns, row, like_rotation):
    """Add the power that mass damping and dashpots took from the spin of a block; in the plane that is with the masses.

    drained: (velocity before + that after the kick) × inertia × mean velocity; dashpots: their impulse × mean velocity.
    """
    if len(like_rotation) == 1:
        return drained, dashpots
    return _powers_in_space(drained, dashpots, velocities, old, pulled, shape, turns, row)


@overload(add_spin_powers)
def _add_spin_powers(drained, dashpots, velocities, old, pulled, shape, turns, row, like_rotation):
    if len(like_rotation) == 1:
        return lambda drained, dashpots, velocities, old, pulled, shape, turns, row, like_rotation: (drained, dashpots)
    return lambda drained, dashpots, velocities, old, pulled, shape, turns, row, like_rotation: _powers_in_space(
        drained, dashpots, velocities, old, pulled, shape, turns, row
    )


@always_inline
def _rotation_vector(orientations, row):
    w, vector = orientations[row, 0], load(orientations, row, 1, (0.0, 0.0, 0.0))
    sine = norm(vector)
    if sine == 0.0:
        return vector
    return scale(2.0 * math.atan2(sine, abs(w)) / sine * (-1.0 if w < 0.0 else 1.0), vector)


def rotation(orientations, row, like_rotation):
    """Compute the angle of a block, or the rotation vector of its quaternion, the shorter way round [rad]."""
    return (orientations[row, 0],) if len(like_rotation) == 1 else _rotation_vector(orientations, row)


@overload(rotation)
def _rotation(orientations, row, like_rotation):
    if len(like_rotation) == 1:
        return lambda orientations, row, like_rotation: (orientations[row, 0],)
    return lambda orientations, row, like_rotation: _rotation_vector(orientations, row)


@always_inline
def _gyrate(samples, sample, place, shape, turns, row):
    moments = load(shape.inertias, row, 0, (0.0, 0.0, 0.0))
    if moments[0] == 0.0:
        return
    axes = principal_axes(turns, shape.axes, row)
    mean = (samples[sample, place, 1, 3], samples[sample, place, 1, 4], samples[sample, place, 1, 5])
    a, b, c = along(axes, mean)
    change = (
        (moments[1] - moments[2]) / moments[0] * b * c,
        (moments[2] - moments[0]) / moments[1] * c * a,
        (moments[0] - moments[1]) / moments[2] * a * b,
    )
    for k, part in enumerate(combined(axes, change)):
        samples[sample, place, 2, 3 + k] += part


def add_gyration(samples, sample, place, shape, turns, row, like_rotation):
    """Add to the sampled angular acceleration of a block its gyroscopic part without any torque: nothing in the
    plane.
    """
    if len(like_rotation) == 3:
        _gyrate(samples, sample, place, shape, turns, row)


@overload(add_gyration)
def _add_gyration(samples, sample, place, shape, turns, row, like_rotation):
    if len(like_rotation) == 1:
        return lambda samples, sample, place, shape, turns, row, like_rotation: None
    return lambda samples, sample, place, shape, turns, row, like_rotation: _gyrate(
        samples, sample, place, shape, turns, row
    )
