"""Positions from velocities, with or without the corners of the blocks."""

from __future__ import annotations

import math

import numpy as np

from dem_cli.kernels.jit import always_inline, inline


@always_inline
def _turn(angle):
    """cos and sin; for small angles the polynomials of fdlibm, the same on every machine, below 1 ulp."""
    if abs(angle) > 0.7854:
        return math.cos(angle), math.sin(angle)
    z = angle * angle
    r = 8.33333333332248946124e-03 + z * (
        -1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))
    )
    s = angle + z * angle * (-1.66666666666666324348e-01 + z * r)
    r = z * (
        4.16666666666666019037e-02
        + z
        * (
            -1.38888888888741095749e-03
            + z
            * (
                2.48015872894767294178e-05
                + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))
            )
        )
    )
    half = 0.5 * z
    w = 1.0 - half
    return w + (((1.0 - w) - half) + z * r), s


@inline
def drift_centroids(bodies, shape, dt, like):
    """Positions and rotation vectors from velocities; to first order rotations add up."""
    positions, orientations, velocities = bodies.positions, bodies.orientations, bodies.velocities
    d, r = len(like), orientations.shape[1]
    for number in range(positions.shape[0]):
        i = np.uint64(number)
        for k in range(d):
            positions[i, k] += dt * velocities[i, k]
        for k in range(r):
            orientations[i, k] += dt * velocities[i, d + k]
    return 0.0


@inline
def drift_corners(bodies, shape, dt, like):
    """Positions and corners from velocities; returns the largest travel of a corner since detection [m]."""
    positions, orientations, velocities = bodies.positions, bodies.orientations, bodies.velocities
    corners, travel, radii, turns = bodies.corners, bodies.travel, shape.radii, bodies.turns
    corner_blocks, arms = shape.corner_blocks, shape.corner_arms
    largest = 0.0
    for number in range(positions.shape[0]):
        i = np.uint64(number)
        vx, vy, w = velocities[i, 0], velocities[i, 1], velocities[i, 2]
        positions[i, 0] += dt * vx
        positions[i, 1] += dt * vy
        angle = orientations[i, 0] + dt * w
        orientations[i, 0] = angle
        turns[i, 0], turns[i, 1] = _turn(angle)
        moved = travel[i] + dt * (math.sqrt(vx * vx + vy * vy) + radii[i] * abs(w))
        travel[i] = moved
        if moved > largest:
            largest = moved
    for number in range(corners.shape[0]):
        i = np.uint64(number)
        block = np.uint64(corner_blocks[i])
        c, s = turns[block, 0], turns[block, 1]
        x, y = arms[i, 0], arms[i, 1]
        corners[i, 0] = positions[block, 0] + c * x - s * y
        corners[i, 1] = positions[block, 1] + s * x + c * y
    return largest
