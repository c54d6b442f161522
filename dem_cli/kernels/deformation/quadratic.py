"""Quadratic modes of blocks in the plane: displacements at contact points as polynomials, generalised forces of the modes.

Over the uniform strain of a block its points are displaced by R u(X), u = Σ a_k φ_k of second degree in the arm X as the block
sees it (model/quadratic_modes.py). Summed over modes once a step, u has 6 coefficients for each direction; forces at
points give back Σ f ⊗ (x², x y, y²), beside the dyads of the uniform strain and the force itself.
"""

from __future__ import annotations

import numpy as np

from dem_cli.kernels.jit import always_inline, inline
from dem_cli.kernels.vec import axpy, dot, scale

N_QUADRATIC, COEFFICIENTS, SECOND = 6, 12, 6  # modes; of u; sums of forces times terms of second degree


@inline
def take_bends(amplitudes, row, first, shapes, out):
    """Coefficients of u, or of its rate, from amplitudes in columns `first` on."""
    for m in range(COEFFICIENTS):
        out[row, m] = 0.0
    for k in range(N_QUADRATIC):
        amplitude = amplitudes[row, first + k]
        for m in range(COEFFICIENTS):
            out[row, m] += amplitude * shapes[row, k * COEFFICIENTS + m]


@inline
def bend(bodies, shape):
    """Coefficients of the rate of u of all blocks; sums of forces begin anew."""
    velocities = bodies.velocities
    bodies.triads[:] = 0.0
    for number in range(velocities.shape[0]):
        take_bends(velocities, np.uint64(number), velocities.shape[1] - N_QUADRATIC, shape.bends, bodies.bending)


@inline
def store_bends(bodies, shape):
    """Coefficients of u of all blocks."""
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
def displaced(coefficients, turns, i, arm):
    """R u at an arm of a block, along the axes of the world."""
    c, s = turns[i, 0], turns[i, 1]
    x, y = c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]
    p = coefficients
    u = p[i, 0] + p[i, 1] * x + p[i, 2] * y + p[i, 3] * (x * x) + p[i, 4] * (x * y) + p[i, 5] * (y * y)
    v = p[i, 6] + p[i, 7] * x + p[i, 8] * y + p[i, 9] * (x * x) + p[i, 10] * (x * y) + p[i, 11] * (y * y)
    return c * u - s * v, s * u + c * v


@always_inline
def displaced_apart(coefficients, turns, a, b, frame, arm_a, arm_b):
    """Opening and sliding of block b against a at a point, by quadratic modes."""
    apart = axpy(-1.0, displaced(coefficients, turns, a, arm_a), displaced(coefficients, turns, b, arm_b))
    return dot(frame[0], apart), dot(frame[1], apart)


@always_inline
def _push(triads, turns, i, arm, force):
    c, s = turns[i, 0], turns[i, 1]
    x, y = c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]
    u, v = c * force[0] + s * force[1], c * force[1] - s * force[0]
    for k, term in ((0, x * x), (1, x * y), (2, y * y)):
        triads[i, k] += u * term
        triads[i, 3 + k] += v * term


@always_inline
def bend_apart(triads, turns, a, b, force, arm_a, arm_b):
    """Sums of a contact force onto block b, and against block a."""
    _push(triads, turns, a, arm_a, scale(-1.0, force))
    _push(triads, turns, b, arm_b, force)
