"""Uniform strain of blocks: strain rates before the contact loop, generalised and elastic forces of the modes after it.

A material point X of a block is at x = c + R (I + ε) X, ε the same in all of the block and linear elastic, as seen by
the block itself (corotational). With F = R (I + ε), its velocity by deformation alone is D (x − c), D = R ε̇ F⁻¹;
the power of forces f at arms r is then Σ f · D r = Rᵀ (Σ f ⊗ r) F⁻ᵀ : ε̇. So contact loops need only D and the dyads
Σ f ⊗ r of each block. On geometry of the start R and F are one. The modes that ε is made of: model/uniform_strain.py;
an amplitude is what a point as far from the centroid as the farthest corner moves by.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.deformation.matrices import inverse, load_matrix, product, store_matrix, transposed
from dem_cli.core.kernels.jit import inline, overload


def strain_of(amplitudes, row, first, per_radius, like):
    """Compute the strain from amplitudes, or its rate from their rates, in columns `first` on; per_radius: [1/m]."""
    if len(like) == 2:
        return _planar_strain(amplitudes, row, first, per_radius, like)
    return _spatial_strain(amplitudes, row, first, per_radius, like)


@overload(strain_of)
def _strain_of(amplitudes, row, first, per_radius, like):
    return _planar_strain if len(like) == 2 else _spatial_strain


def _planar_strain(amplitudes, row, first, per_radius, like):
    """Compute the strain in the plane from its modes: all directions alike, x against y, shear."""
    even, uneven = per_radius * amplitudes[row, first], per_radius * amplitudes[row, first + 1]
    sheared = per_radius * amplitudes[row, first + 2]
    return (even + uneven, sheared), (sheared, even - uneven)


def _spatial_strain(amplitudes, row, first, per_radius, like):
    """Strain in space from its modes: all directions alike, x against y, both against z, shear yz, zx, xy."""
    even, flat = per_radius * amplitudes[row, first], per_radius * amplitudes[row, first + 1]
    long = per_radius * amplitudes[row, first + 2]
    yz, zx = per_radius * amplitudes[row, first + 3], per_radius * amplitudes[row, first + 4]
    xy = per_radius * amplitudes[row, first + 5]
    return (even + flat + long, xy, zx), (xy, even - flat + long, yz), (zx, yz, even - 2.0 * long)


def mode_parts(tensor):
    """Compute Σ tensor : ∂ε/∂(amplitude × 1/radius) of every mode."""
    return _planar_parts(tensor) if len(tensor) == 2 else _spatial_parts(tensor)


@overload(mode_parts)
def _mode_parts(tensor):
    return _planar_parts if len(tensor) == 2 else _spatial_parts


def _planar_parts(tensor):
    (xx, xy), (yx, yy) = tensor
    return xx + yy, xx - yy, xy + yx


def _spatial_parts(tensor):
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = tensor
    return xx + yy + zz, xx - yy, xx + yy - 2.0 * zz, yz + zy, zx + xz, xy + yx


def rotation_of(turns, row, like):
    """Return the rotation matrix of a block."""
    if len(like) == 2:
        return (turns[row, 0], -turns[row, 1]), (turns[row, 1], turns[row, 0])
    return load_matrix(turns, row, like)


@overload(rotation_of)
def _rotation_of(turns, row, like):
    if len(like) == 2:
        return lambda turns, row, like: ((turns[row, 0], -turns[row, 1]), (turns[row, 1], turns[row, 0]))
    return lambda turns, row, like: load_matrix(turns, row, like)


@inline
def stretch(bodies, shape, like, moves):
    """Compute velocity gradients of deformable blocks from the rates of their modes; sets dyads to zero."""
    stiffness, velocities, dyads = shape.mode_stiffness, bodies.velocities, bodies.dyads
    dyads[:] = 0.0
    first = velocities.shape[1] - stiffness.shape[1]
    for number in range(stiffness.shape[0]):
        i = np.uint64(number)
        if stiffness[i, 0] == 0.0:
            continue
        gradient = strain_of(velocities, i, first, 1.0 / shape.radii[i], like)
        if moves:
            turned = product(rotation_of(bodies.turns, i, like), gradient)
            gradient = product(turned, inverse(load_matrix(bodies.gradients, i, like)))
        store_matrix(bodies.stretchings, i, gradient)


@inline
def resist(bodies, shape, like, moves):
    """Forces on the modes, into `forces`: of the contacts by their dyads, less those of the block's own elasticity."""
    stiffness, forces, modes = shape.mode_stiffness, bodies.forces, bodies.modes
    first = forces.shape[1] - stiffness.shape[1]
    for number in range(stiffness.shape[0]):
        i = np.uint64(number)
        if stiffness[i, 0] == 0.0:
            continue
        dyad = load_matrix(bodies.dyads, i, like)
        if moves:
            turned = product(transposed(rotation_of(bodies.turns, i, like)), dyad)
            dyad = product(turned, transposed(inverse(load_matrix(bodies.gradients, i, like))))
        parts, per_radius = mode_parts(dyad), 1.0 / shape.radii[i]
        for k in range(len(parts)):
            forces[i, first + k] = per_radius * parts[k] - stiffness[i, k] * modes[i, k]


@inline
def stretch_apart(dyads, a, b, force, arm_a, arm_b):
    """Add the dyad of a contact force to block b, and subtract it from block a."""
    d = len(force)
    for row in range(d):
        for column in range(d):
            dyads[a, d * row + column] -= force[row] * arm_a[column]
            dyads[b, d * row + column] += force[row] * arm_b[column]


@inline
def deform(bodies, dt):
    """Update the amplitudes of modes from their rates."""
    modes, velocities = bodies.modes, bodies.velocities
    first = velocities.shape[1] - modes.shape[1]
    for i in range(modes.shape[0]):
        for k in range(modes.shape[1]):
            modes[i, k] += dt * velocities[i, first + k]


@inline
def store_gradient(bodies, shape, i, like):
    """Compute the deformation gradient R (I + ε) of a block from its rotation and its modes."""
    turn = rotation_of(bodies.turns, i, like)
    strained = product(turn, strain_of(bodies.modes, i, np.uint64(0), 1.0 / shape.radii[i], like))
    d = len(like)
    for row in range(d):
        for column in range(d):
            bodies.gradients[i, d * row + column] = turn[row][column] + strained[row][column]


@inline
def stretching_speed(bodies, i, like):
    """Bound the speed of the corners of a block by deformation [m per unit of time]."""
    velocities = bodies.velocities
    speed = 0.0
    for k in range(velocities.shape[1] - bodies.modes.shape[1], velocities.shape[1]):
        speed += abs(velocities[i, k])
    return speed if len(like) == 2 else 2.0 * speed
