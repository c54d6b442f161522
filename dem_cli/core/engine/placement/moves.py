"""Placement of blocks: displaced, turned, thrown, or put where a state of rest was found elsewhere.

What goes with the blocks follows at once (corners, turns, mobilities), and the energy ledger has what it cost; nothing
here is a step of the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.detect import strained_corners, world_corners
from dem_cli.core.geometry.inertia import mobilities
from dem_cli.core.geometry.rotation import oriented_as, turned_as_one, turned_further, turns_of
from dem_cli.core.kernels import records as slot
from dem_cli.core.links.matrices import elastic_energy_of_links
from dem_cli.core.model.quadratic_modes import bent_by
from dem_cli.core.model.uniform_strain import covectors_of, gradients_of

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation


def displace(sim: Simulation, blocks: np.ndarray, displacement: np.ndarray) -> None:
    """Move blocks by a displacement [m], (d,); `find_faces` when all are in place."""
    sim.bodies.positions[blocks] += displacement


def turn(sim: Simulation, blocks: np.ndarray, rotation: np.ndarray | float, about: np.ndarray) -> None:
    """Rotate blocks as one about a point (d,): counter-clockwise, in space by axis times angle (3,) [rad]."""
    bodies = sim.bodies
    bodies.positions[blocks] = about + turned_as_one(bodies.positions[blocks] - about, rotation)
    bodies.orientations[blocks] = turned_further(bodies.orientations[blocks], rotation)


def throw(sim: Simulation, blocks: np.ndarray, velocity: np.ndarray) -> None:
    """Set the velocity of blocks as rigid ones [m/s, rad/s]; what they may deform at as well is 0."""
    sim.bodies.velocities[blocks] = 0.0
    sim.bodies.velocities[blocks, : len(velocity)] = velocity


def find_faces(sim: Simulation) -> None:
    """Update corners and joints of blocks that were displaced or turned."""
    _follow(sim)
    sim.bodies.travel[:] = np.inf  # wherever they are now, faces are found anew
    sim.detect()


def shift(sim: Simulation, motion: np.ndarray) -> None:
    """Moves all blocks back by small displacements (n_blocks, n_dof) [m, rad]. Forces of joints stay.

    Links become shorter or longer by it: that changes their forces, and what they store comes from outside.
    """
    before = elastic_energy_of_links(sim.links)
    for link in sim.links:
        link.follow(motion, sim.bodies)
    sim.ledger[slot.EXTERNAL] += elastic_energy_of_links(sim.links) - before
    _move(sim, motion)
    sim.taken_back += motion[:, : sim.model.rotations.stop]  # modes of blocks that deform stay as they are


def push(sim: Simulation, motion: np.ndarray) -> None:
    """Moves all blocks by small displacements (n_blocks, n_dof) [m, rad]; forces of joints answer in the next step."""
    _move(sim, motion)
    sim.follow_faces()


def move_to(sim: Simulation, motion: np.ndarray, shear: np.ndarray, load: float, friction: float) -> None:
    """Moves all blocks, at rest, by finite displacements (n_blocks, n_dof) [m, rad] to a state found elsewhere.

    shear     forces along the tangents there [N], (n_points, d − 1)
    load      internal multiplier there
    friction  work that friction took on the way [J]

    Loads are booked as growing in proportion; what of their work neither friction nor springs have counts as numerical
    damping.
    """
    before, mean = sim.elastic_energy(), 0.5 * (sim.load + load)
    applied = sim.loads.dead + mean * sim.loads.live
    _move(sim, motion)
    sim.bodies.velocities[:] = 0.0
    sim.contacts.shear[:] = shear
    gaps = sim.measured().gaps
    sim.contacts.gaps[:] = gaps
    sim.contacts.normal[:] = np.maximum(sim.joints.kn * (sim.contacts.closure - gaps), 0.0)
    sim.set_load(load)
    given = float((applied[:, : motion.shape[1]] * motion).sum())
    sim.ledger[slot.EXTERNAL] += given
    sim.ledger[slot.LIVE] += mean * float((sim.loads.live[:, : motion.shape[1]] * motion).sum())
    sim.ledger[slot.FRICTION] += friction
    sim.ledger[slot.DAMPING] += given - friction - (sim.elastic_energy() - before)
    sim.ledger[slot.CONTACT] -= given
    sim.follow_faces()


def place_at_rest(
    sim: Simulation, normal: np.ndarray, shear: np.ndarray, gaps: np.ndarray, displacements: np.ndarray
) -> None:
    """Set a state of rest found elsewhere: forces [N] and gaps [m] of all contact points, displacements of all
    blocks.

    displacements: (n_blocks, n_dof) [m, rad]. The energy balance starts anew with `Simulation.open_books`.
    """
    d, bodies = sim.model.dimension, sim.bodies
    sim.contacts.normal[:], sim.contacts.shear[:], sim.contacts.gaps[:] = normal, shear, gaps
    bodies.positions[:] = sim.reference_positions + displacements[:, :d]
    bodies.orientations[:] = oriented_as(bodies.orientations, displacements[:, sim.model.rotations])
    bodies.velocities[:] = 0.0
    bodies.modes[:] = 0.0
    if sim.kinematics == "large":
        _follow(sim)


def _move(sim: Simulation, motion: np.ndarray) -> None:
    """Moves all blocks by displacements (n_blocks, n_dof) [m, rad], with what goes with them."""
    bodies, d, spins = sim.bodies, sim.model.dimension, motion[:, sim.model.rotations]
    bodies.positions[:] += motion[:, :d]
    bodies.orientations[:] = turned_further(bodies.orientations, spins)
    _follow(sim)
    angles = np.sqrt((spins**2).sum(axis=1))
    bodies.travel[:] += np.sqrt((motion[:, :d] ** 2).sum(axis=1)) + sim.shape.radii * angles


def _follow(sim: Simulation) -> None:
    """Update what moves with the blocks to their new places: corners, turns, mobilities."""
    bodies, shape = sim.bodies, sim.shape
    bodies.turns[:] = turns_of(bodies.orientations)
    if sim.model.n_modes:
        bodies.gradients[:] = gradients_of(bodies.modes, shape.radii, bodies.turns)
        if len(bodies.covectors):
            bodies.covectors[:] = covectors_of(bodies.gradients)
        bodies.bent[:] = bent_by(bodies.modes, sim.model.mode_shapes)
        bodies.corners[:] = strained_corners(shape, bodies)
    else:
        bodies.corners[:] = world_corners(shape, bodies.positions, bodies.orientations)
    bodies.mobilities[:] = mobilities(shape.inertias, shape.axes, bodies.turns)
