"""Position update of blocks from velocities, with or without the corners of the blocks."""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.kernels.deformation.matrices import inverse, load_matrix, store_matrix, transposed
from dem_cli.core.kernels.deformation.quadratic import store_bends
from dem_cli.core.kernels.deformation.uniform_strain import deform, store_gradient, stretching_speed
from dem_cli.core.kernels.jit import always_inline, inline
from dem_cli.core.kernels.spin import (
    along,
    combined,
    half_turn,
    midpoint,
    note_turn,
    principal_axes,
    store_mobility,
    store_turn,
    turn_further,
    turned,
)
from dem_cli.core.kernels.vec import axpy, load, norm, scale, store


@always_inline
def _turn(angle):
    """Compute cos and sin; for small angles the polynomials of fdlibm, the same on every machine, below 1 ulp."""
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
    """Update positions and rotation vectors from velocities; to first order rotations add up."""
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
    """Update positions and corners from velocities, 2D; returns the largest travel of a corner since detection [m]."""
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


@inline
def drift_strained_centroids(bodies, shape, dt, like):
    """Update positions, rotation vectors and modes of blocks that deform, without their corners."""
    deform(bodies, dt)
    return drift_centroids(bodies, shape, dt, like)


@inline
def drift_strained_corners(bodies, shape, dt, like):
    """Update positions and corners of blocks that deform, 2D: x = c + R (I + ε) X, so that edges stay straight."""
    positions, orientations, velocities = bodies.positions, bodies.orientations, bodies.velocities
    corners, travel, turns, gradients = bodies.corners, bodies.travel, bodies.turns, bodies.gradients
    corner_blocks, arms, radii = shape.corner_blocks, shape.corner_arms, shape.radii
    deform(bodies, dt)
    largest = 0.0
    for number in range(positions.shape[0]):
        i = np.uint64(number)
        vx, vy, w = velocities[i, 0], velocities[i, 1], velocities[i, 2]
        positions[i, 0] += dt * vx
        positions[i, 1] += dt * vy
        angle = orientations[i, 0] + dt * w
        orientations[i, 0] = angle
        turns[i, 0], turns[i, 1] = _turn(angle)
        store_gradient(bodies, shape, i, like)
        moved = travel[i] + dt * (math.sqrt(vx * vx + vy * vy) + radii[i] * abs(w) + stretching_speed(bodies, i, like))
        travel[i] = moved
        if moved > largest:
            largest = moved
    for number in range(corners.shape[0]):
        i = np.uint64(number)
        block = np.uint64(corner_blocks[i])
        x, y = arms[i, 0], arms[i, 1]
        corners[i, 0] = positions[block, 0] + gradients[block, 0] * x + gradients[block, 1] * y
        corners[i, 1] = positions[block, 1] + gradients[block, 2] * x + gradients[block, 3] * y
    return largest


@inline
def drift_bent_corners(bodies, shape, dt, like):
    """Update blocks that have quadratic modes as well, 2D; these modes move no corner."""
    largest = drift_strained_corners(bodies, shape, dt, like)
    store_bends(bodies, shape)
    return largest


@inline
def _go(bodies, shape, i, dt, like, spin):
    """Move a centroid in space and add to its travel; returns the travel of the farthest corner [m]."""
    speed = load(bodies.velocities, i, 0, like)
    store(bodies.positions, i, 0, axpy(dt, speed, load(bodies.positions, i, 0, like)))
    moved = bodies.travel[i] + dt * (norm(speed) + shape.radii[i] * norm(spin))
    bodies.travel[i] = moved
    return moved


@inline
def _take_corners(bodies, shape, turns):
    """Compute corners of blocks in space; turns: rotations, or gradients of blocks that deform."""
    corners, positions = bodies.corners, bodies.positions
    corner_blocks, arms = shape.corner_blocks, shape.corner_arms
    for number in range(corners.shape[0]):
        i = np.uint64(number)
        block = np.uint64(corner_blocks[i])
        x, y, z = arms[i, 0], arms[i, 1], arms[i, 2]
        corners[i, 0] = positions[block, 0] + (turns[block, 0] * x + turns[block, 1] * y + turns[block, 2] * z)
        corners[i, 1] = positions[block, 1] + (turns[block, 3] * x + turns[block, 4] * y + turns[block, 5] * z)
        corners[i, 2] = positions[block, 2] + (turns[block, 6] * x + turns[block, 7] * y + turns[block, 8] * z)


@inline
def drift_solids(bodies, shape, dt, like):
    """Update positions, quaternions and corners in space, in pseudo-time, where velocities stay; returns as
    drift_corners.
    """
    velocities, orientations, largest = bodies.velocities, bodies.orientations, 0.0
    for number in range(velocities.shape[0]):
        i = np.uint64(number)
        spin = load(velocities, i, 3, like)
        largest = max(largest, _go(bodies, shape, i, dt, like, spin))
        turn_further(orientations, i, half_turn(spin, dt))
        store_turn(bodies.turns, i, orientations)
    _take_corners(bodies, shape, bodies.turns)
    return largest


@inline
def drift_strained_solids(bodies, shape, dt, like):
    """Update blocks in space that deform: x = c + R (I + ε) X, so that faces stay plane."""
    velocities, orientations, largest = bodies.velocities, bodies.orientations, 0.0
    deform(bodies, dt)
    for number in range(velocities.shape[0]):
        i = np.uint64(number)
        spin, further = load(velocities, i, 3, like), dt * stretching_speed(bodies, i, like)
        bodies.travel[i] += further
        largest = max(largest, _go(bodies, shape, i, dt, like, spin))
        turn_further(orientations, i, half_turn(spin, dt))
        store_turn(bodies.turns, i, orientations)
        store_gradient(bodies, shape, i, like)
        store_matrix(bodies.covectors, i, transposed(inverse(load_matrix(bodies.gradients, i, like))))
    _take_corners(bodies, shape, bodies.gradients)
    return largest


@inline
def drift_tumbling(bodies, shape, dt, like):
    """Update blocks in space in real time: spins change as blocks turn without torque, and mobilities follow. Supports
    keep the velocities that they are given. Returns as drift_corners.
    """
    velocities, orientations, turns, mobilities = (
        bodies.velocities, bodies.orientations, bodies.turns, bodies.mobilities
    )  # fmt: skip
    inertias, axes, largest = shape.inertias, shape.axes, 0.0
    for number in range(velocities.shape[0]):
        i = np.uint64(number)
        spin, moments = load(velocities, i, 3, like), load(inertias, i, 0, like)
        largest = max(largest, _go(bodies, shape, i, dt, like, spin))
        if moments[0] == 0.0:
            turn_further(orientations, i, half_turn(spin, dt))
            store_turn(turns, i, orientations)
            note_turn(bodies, i)
            continue
        principal = principal_axes(turns, axes, i)
        before = along(principal, spin)
        mean, turn = midpoint(before, moments, dt)
        turn = combined(principal, turn)
        turn_further(orientations, i, turn)
        store_turn(turns, i, orientations)
        note_turn(bodies, i)
        principal = principal_axes(turns, axes, i)
        # By what has changed alone: axes that are not quite square, to round-off, would gain or lose in each step.
        change = combined(principal, scale(2.0, axpy(-1.0, before, mean)))
        store(velocities, i, 3, axpy(1.0, change, turned(spin, turn)))
        store_mobility(mobilities, i, principal, moments)
    _take_corners(bodies, shape, bodies.turns)
    return largest


@inline
def drift_strained_tumbling(bodies, shape, dt, like):
    """Update blocks in space that deform, in real time, as drift_tumbling does rigid ones."""
    deform(bodies, dt)
    drift_tumbling(bodies, shape, dt, like)
    largest = 0.0
    for number in range(bodies.positions.shape[0]):
        i = np.uint64(number)
        bodies.travel[i] += dt * stretching_speed(bodies, i, like)
        largest = max(largest, bodies.travel[i])
        store_gradient(bodies, shape, i, like)
        store_matrix(bodies.covectors, i, transposed(inverse(load_matrix(bodies.gradients, i, like))))
    _take_corners(bodies, shape, bodies.gradients)
    return largest
