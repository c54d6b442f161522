"""Quadratic modes of blocks in the plane: displacements at contact points as polynomials, generalised forces.

Over the uniform strain of a block its points are displaced by R u(X), u = Σ a_k φ_k of second degree in the arm X as
the block sees it (model/quadratic_modes.py). Summed over modes once a step, u has 6 coefficients for each direction,
and along a joint three: forces at points give back Σ f ⊗ (x², x y, y²), beside the dyads of the uniform strain and the
force itself.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.jit import always_inline, inline
from dem_cli.core.kernels.vec import axpy, dot

N_QUADRATIC, COEFFICIENTS, SECOND = 6, 12, 6  # modes; of u; sums of forces times terms of second degree


@inline
def take_bends(amplitudes, row, first, shapes, out):
    """Compute coefficients of u, or of its rate, from amplitudes in columns `first` on."""
    for m in range(COEFFICIENTS):
        out[row, m] = 0.0
    for k in range(N_QUADRATIC):
        amplitude = amplitudes[row, first + k]
        for m in range(COEFFICIENTS):
            out[row, m] += amplitude * shapes[row, k * COEFFICIENTS + m]


@inline
def bend(bodies, shape):
    """Compute coefficients of the rate of u of all blocks; sets sums of forces to zero."""
    velocities = bodies.velocities
    bodies.triads[:] = 0.0
    for number in range(velocities.shape[0]):
        take_bends(velocities, np.uint64(number), velocities.shape[1] - N_QUADRATIC, shape.bends, bodies.bending)


@inline
def store_bends(bodies, shape):
    """Compute coefficients of the displacement u of all blocks."""
    modes = bodies.modes
    for number in range(modes.shape[0]):
        take_bends(modes, np.uint64(number), modes.shape[1] - N_QUADRATIC, shape.bends, bodies.bent)


@inline
def resist_bending(bodies, shape):
    """Forces on the quadratic modes, into `forces`: of the contacts, less those of the block's own elasticity."""
    shapes, forces, modes, stiffness = shape.bends, bodies.forces, bodies.modes, shape.mode_stiffness
    first, before = forces.shape[1] - N_QUADRATIC, modes.shape[1] - N_QUADRATIC
    for number in range(shapes.shape[0]):
        i = np.uint64(number)
        if stiffness[i, before] == 0.0:
            continue
        c, s = bodies.turns[i, 0], bodies.turns[i, 1]
        fx, fy = c * forces[i, 0] + s * forces[i, 1], c * forces[i, 1] - s * forces[i, 0]
        xx, xy, yx, yy = bodies.dyads[i, 0], bodies.dyads[i, 1], bodies.dyads[i, 2], bodies.dyads[i, 3]
        # Rᵀ dyad R
        ax, ay, bx, by = c * xx + s * yx, c * xy + s * yy, c * yx - s * xx, c * yy - s * xy
        sums = (fx, c * ax + s * ay, c * ay - s * ax, fy, c * bx + s * by, c * by - s * bx)
        for k in range(N_QUADRATIC):
            at, total = k * COEFFICIENTS, 0.0
            for m in range(3):
                total += shapes[i, at + m] * sums[m] + shapes[i, at + 6 + m] * sums[3 + m]
                total += shapes[i, at + 3 + m] * bodies.triads[i, m] + shapes[i, at + 9 + m] * bodies.triads[i, 3 + m]
            forces[i, first + k] = total - stiffness[i, before + k] * modes[i, before + k]


@always_inline
def _line(coefficients, turns, i, arm, along):
    """Expand R u at arm + t·along as c0 + c1 t + c2 t², vectors along the world axes."""
    c, s, p = turns[i, 0], turns[i, 1], coefficients
    x, y = c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]
    dx, dy = c * along[0] + s * along[1], c * along[1] - s * along[0]
    xx, xy, yy, mixed = x * x, x * y, y * y, x * dy + y * dx
    u0 = p[i, 0] + p[i, 1] * x + p[i, 2] * y + p[i, 3] * xx + p[i, 4] * xy + p[i, 5] * yy
    v0 = p[i, 6] + p[i, 7] * x + p[i, 8] * y + p[i, 9] * xx + p[i, 10] * xy + p[i, 11] * yy
    u1 = p[i, 1] * dx + p[i, 2] * dy + 2.0 * (p[i, 3] * x * dx + p[i, 5] * y * dy) + p[i, 4] * mixed
    v1 = p[i, 7] * dx + p[i, 8] * dy + 2.0 * (p[i, 9] * x * dx + p[i, 11] * y * dy) + p[i, 10] * mixed
    u2 = p[i, 3] * dx * dx + p[i, 4] * dx * dy + p[i, 5] * dy * dy
    v2 = p[i, 9] * dx * dx + p[i, 10] * dx * dy + p[i, 11] * dy * dy
    return (c * u0 - s * v0, s * u0 + c * v0), (c * u1 - s * v1, s * u1 + c * v1), (c * u2 - s * v2, s * u2 + c * v2)


@always_inline
def line_apart(coefficients, turns, a, b, arm_a, arm_b, along):
    """Compute the relative displacement of b against a along a joint as c0, c1, c2 of `_line`."""
    of_a, of_b = _line(coefficients, turns, a, arm_a, along), _line(coefficients, turns, b, arm_b, along)
    return axpy(-1.0, of_a[0], of_b[0]), axpy(-1.0, of_a[1], of_b[1]), axpy(-1.0, of_a[2], of_b[2])


@always_inline
def apart_at(line, t, frame):
    """Compute the relative displacement at one point of a joint, across and along it."""
    moved = axpy(t, axpy(t, line[2], line[1]), line[0])
    return dot(frame[0], moved), dot(frame[1], moved)


@always_inline
def _push(triads, turns, i, arm, along, sign, force, first, second):
    c, s = turns[i, 0], turns[i, 1]
    x, y = c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]
    dx, dy = c * along[0] + s * along[1], c * along[1] - s * along[0]
    u0, v0 = sign * (c * force[0] + s * force[1]), sign * (c * force[1] - s * force[0])
    u1, v1 = sign * (c * first[0] + s * first[1]), sign * (c * first[1] - s * first[0])
    u2, v2 = sign * (c * second[0] + s * second[1]), sign * (c * second[1] - s * second[0])
    xx, xy, yy, mixed = x * x, x * y, y * y, x * dy + y * dx
    triads[i, 0] += u0 * xx + 2.0 * u1 * x * dx + u2 * dx * dx
    triads[i, 1] += u0 * xy + u1 * mixed + u2 * dx * dy
    triads[i, 2] += u0 * yy + 2.0 * u1 * y * dy + u2 * dy * dy
    triads[i, 3] += v0 * xx + 2.0 * v1 * x * dx + v2 * dx * dx
    triads[i, 4] += v0 * xy + v1 * mixed + v2 * dx * dy
    triads[i, 5] += v0 * yy + 2.0 * v1 * y * dy + v2 * dy * dy


@always_inline
def bend_apart(triads, turns, a, b, arm_a, arm_b, along, sums):
    """Add sums of the forces of a joint to block b, and subtract them from a; sums: Σ f, Σ f t, Σ f t²."""
    _push(triads, turns, a, arm_a, along, -1.0, sums[0], sums[1], sums[2])
    _push(triads, turns, b, arm_b, along, 1.0, sums[0], sums[1], sums[2])


@always_inline
def with_force(sums, t, force):
    """Add the force at one more point to the sums of a joint."""
    return axpy(1.0, force, sums[0]), axpy(t, force, sums[1]), axpy(t * t, force, sums[2])
