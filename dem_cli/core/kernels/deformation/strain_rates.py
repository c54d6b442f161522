"""Strains of blocks in time histories: their real masses, their damping, and the mean spin of a block that shears.

A block of rotation R and modes a has a kinetic energy ½ ω·I ω + ω·C ȧ + ½ ȧ·M ȧ (model/mode_masses.py; ω along its own
axes). With the mean spin ν = ω + W ȧ, W = I⁻¹ C, it is ½ ν·I ν + ½ ȧ·(M − Cᵀ W) ȧ: nothing is coupled. So while time
runs, velocities have ν where those of rigid blocks have ω; all that acts on spins, dashpots, ground motion and torques,
stays as it is. ν does the work of torques; what is left, −W ȧ, is motion by modes, with forces −Wᵀ τ on these.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.deformation.uniform_strain import resist, stretch
from dem_cli.core.kernels.jit import always_inline, inline, overload
from dem_cli.core.kernels.records import DASHPOT, MASS
from dem_cli.core.kernels.spin import half_turn, store_turn, turn_further


@always_inline
def _own_turning(velocities, turns, row, first, r):
    """Compute component k of the spin −W ȧ along the axes of the block."""
    total = 0.0
    for j in range(turns.shape[2]):
        total -= turns[row, r, j] * velocities[row, first + j]
    return total


@inline
def _spin_in_plane(bodies, strained, i, like, like_rotation):
    first = bodies.velocities.shape[1] - strained.turns.shape[2]
    return (_own_turning(bodies.velocities, strained.turns, i, first, 0),)


@inline
def _spin_in_space(bodies, strained, i, like, like_rotation):
    velocities, turns, rotation = bodies.velocities, strained.turns, bodies.turns
    first = velocities.shape[1] - turns.shape[2]
    x = _own_turning(velocities, turns, i, first, 0)
    y = _own_turning(velocities, turns, i, first, 1)
    z = _own_turning(velocities, turns, i, first, 2)
    return (
        rotation[i, 0] * x + rotation[i, 1] * y + rotation[i, 2] * z,
        rotation[i, 3] * x + rotation[i, 4] * y + rotation[i, 5] * z,
        rotation[i, 6] * x + rotation[i, 7] * y + rotation[i, 8] * z,
    )


def spin_by_modes(bodies, strained, i, like, like_rotation):
    """Compute the spin −W ȧ of a block by its modes, along the world axes [rad/s]."""
    found = _spin_in_plane if len(like_rotation) == 1 else _spin_in_space
    return found(bodies, strained, i, like, like_rotation)


@overload(spin_by_modes)
def _spin_by_modes(bodies, strained, i, like, like_rotation):
    found = _spin_in_plane if len(like_rotation) == 1 else _spin_in_space
    return lambda bodies, strained, i, like, like_rotation: found(bodies, strained, i, like, like_rotation)


@inline
def _add_swirl(gradients, i, spin):
    """Add the velocity gradient of a spin to that of a block."""
    if len(spin) == 1:
        gradients[i, 1] -= spin[0]
        gradients[i, 2] += spin[0]
    else:
        gradients[i, 1] -= spin[2]
        gradients[i, 2] += spin[1]
        gradients[i, 3] += spin[2]
        gradients[i, 5] -= spin[0]
        gradients[i, 6] -= spin[1]
        gradients[i, 7] += spin[0]


@inline
def stretch_in_time(bodies, shape, strained, like, like_rotation):
    """Compute velocity gradients of deformable blocks in time histories, where velocities have mean spins."""
    stretch(bodies, shape, like, True)
    for number in range(strained.turns.shape[0]):
        i = np.uint64(number)
        if shape.mode_stiffness[i, 0] != 0.0:
            _add_swirl(bodies.stretchings, i, spin_by_modes(bodies, strained, i, like, like_rotation))


@inline
def _torque_along(bodies, i, k, like, like_rotation):
    """Compute component k of the torque on a block, along its own axes."""
    forces, turns, d = bodies.forces, bodies.turns, len(like)
    if len(like_rotation) == 1:
        return forces[i, d]
    return turns[i, k] * forces[i, d] + turns[i, 3 + k] * forces[i, d + 1] + turns[i, 6 + k] * forces[i, d + 2]


@inline
def resist_in_time(bodies, shape, strained, like, like_rotation):
    """Compute forces on the modes in time histories, where velocities have mean spins."""
    resist(bodies, shape, like, True)
    turn_modes(bodies, shape, strained, like, like_rotation)


@inline
def turn_modes(bodies, shape, strained, like, like_rotation):
    """Add forces −Wᵀ τ on the modes of blocks."""
    forces, turns = bodies.forces, strained.turns
    first = forces.shape[1] - turns.shape[2]
    for number in range(turns.shape[0]):
        i = np.uint64(number)
        if shape.mode_stiffness[i, 0] == 0.0:
            continue
        for k in range(turns.shape[1]):
            torque = _torque_along(bodies, i, k, like, like_rotation)
            for j in range(turns.shape[2]):
                forces[i, first + j] -= turns[i, k, j] * torque


@inline
def kick_modes(bodies, shape, strained):
    """Update the rates of modes in a step, damped within it; from those before (`means`) and from `unbalanced` less
    `drags`.
    """
    velocities, unbalanced = bodies.velocities, bodies.unbalanced
    old, drags, pulled = bodies.means, bodies.drags, bodies.pulled
    keep, gain, n_dof = strained.keep, strained.gain, velocities.shape[1]
    m = keep.shape[1]
    first = n_dof - m
    for number in range(keep.shape[0]):
        i = np.uint64(number)
        if shape.mode_stiffness[i, 0] == 0.0:
            continue
        for k in range(m):
            total = 0.0
            for j in range(m):
                at = number * n_dof + first + j
                total += keep[i, k, j] * old[at] + gain[i, k, j] * (unbalanced[i, first + j] - drags[at])
            velocities[i, first + k] = total
            pulled[number * n_dof + first + k] = total


@inline
def book_modes(bodies, shape, strained, rate, dt, ledger):
    """Add to the energy balance what damping of the modes and dashpots took in this step, by the mean rates over it.

    Impulses J change rates with the damping of the modes: J = (M + ½ dt (rate M + C)) Δv. means: rates before; pulled:
    after the kick.
    """
    velocities, old, pulled = bodies.velocities, bodies.means, bodies.pulled
    masses, viscosity = strained.masses, strained.viscosity
    n_dof, m, heavier = velocities.shape[1], masses.shape[1], 1.0 + 0.5 * rate * dt
    drained = viscous = given = 0.0
    for number in range(masses.shape[0]):
        i, first = np.uint64(number), number * n_dof + n_dof - m
        if shape.mode_stiffness[i, 0] == 0.0:
            continue
        for k in range(m):
            after = velocities[i, n_dof - m + k]
            mean = 0.5 * (old[first + k] + after)
            viscous += viscosity[i, k] * mean * mean
            given += 0.5 * dt * viscosity[i, k] * mean * (after - pulled[first + k])
            for j in range(m):
                other = velocities[i, n_dof - m + j]
                drained += masses[i, k, j] * mean * 0.5 * (old[first + j] + other)
                given += heavier * masses[i, k, j] * mean * (other - pulled[first + j])
    ledger[MASS] += rate * dt * drained
    ledger[DASHPOT] += dt * viscous - given


@inline
def turn_by_modes(bodies, shape, strained, dt, like, like_rotation):
    """Turn blocks by the spin −W ȧ, before they drift by their mean spins."""
    for number in range(strained.turns.shape[0]):
        i = np.uint64(number)
        if shape.mode_stiffness[i, 0] == 0.0:
            continue
        _turn(bodies, i, spin_by_modes(bodies, strained, i, like, like_rotation), dt)


def _turn(bodies, i, spin, dt):
    if len(spin) == 1:
        bodies.orientations[i, 0] += dt * spin[0]
    else:
        _turn_in_space(bodies, i, spin, dt)


@inline
def _turn_in_space(bodies, i, spin, dt):
    turn_further(bodies.orientations, i, half_turn(spin, dt))
    store_turn(bodies.turns, i, bodies.orientations)


@inline
def _turn_in_plane(bodies, i, spin, dt):
    bodies.orientations[i, 0] += dt * spin[0]


@overload(_turn)
def _turned(bodies, i, spin, dt):
    found = _turn_in_plane if len(spin) == 1 else _turn_in_space
    return lambda bodies, i, spin, dt: found(bodies, i, spin, dt)
