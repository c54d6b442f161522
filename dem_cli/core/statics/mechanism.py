"""Failure mechanism: the blocks and joints that take part, from the motion between the last equilibrium and
failure."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.engine.measures import displacements, rotations_since
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.state import SavedState
from dem_cli.core.kernels import records as slot


def describe(sim: Simulation, held: SavedState) -> dict[str, Any]:
    """Describe the mechanism: failure_mode, share of friction work, and the blocks and joints that take part.

    sim: on its way into failure; held: the saved state of the last equilibrium (Simulation.save).
    """
    settings = sim.settings.mechanism
    bodies, contacts, joints, ledger = held.bodies, held.contacts, held.joints, held.ledger
    d = sim.model.dimension
    shift = np.sqrt(((sim.bodies.positions - bodies.positions) ** 2).sum(axis=1))
    rotation = rotations_since(sim, bodies)
    angle = np.sqrt((rotation**2).sum(axis=1))
    motion = np.maximum(shift, angle * sim.shape.radii)
    weights = -sim.loads.dead[sim.free, d - 1]
    lifted = float((weights * (sim.bodies.positions - bodies.positions)[sim.free, d - 1]).sum())
    external = float(sim.ledger[slot.EXTERNAL] - ledger[slot.EXTERNAL]) + lifted
    released = max(external, 0.0) + max(-lifted, 0.0)
    same = np.array_equal(held.geometry.keys, sim.geometry.keys)
    same = same and np.array_equal(joints.starts, sim.joints.starts)  # parts that meet by other faces have other slots
    friction = float(sim.ledger[slot.FRICTION] - ledger[slot.FRICTION])
    slipped = sim.contacts.slip - contacts.slip if same else sim.contacts.slip
    if sim.law.bonded:  # the ledger holds what bonds lost as well
        friction = float((slipped * np.sqrt((sim.contacts.shear**2).sum(axis=1))).sum())
    share = min(max(friction / released, 0.0), 1.0) if released > 0.0 else 0.0
    # Whether anything turns over, about a horizontal axis, not the share: friction takes nearly all that hinges and one
    # slipping joint release, and little of what lifts blocks up a slope. What turns about the vertical slides.
    turned = float(np.sqrt((rotation[:, : d - 1] ** 2).sum(axis=1)).max(initial=0.0)) * _size(sim)
    translates = turned < settings.turns * motion.max(initial=0.0)
    slides = float(slipped.max(initial=0.0)) > settings.parts * motion.max(initial=0.0)
    moved = "sliding" if slides else "lifting"
    mode = moved if translates else "rocking" if share < settings.rocking else "mixed"
    moving = np.flatnonzero(motion > settings.takes_part * motion.max(initial=0.0))
    parts: dict[str, Any] = {"moving_blocks": named(sim, moving)}
    if same and len(joints.blocks):
        both = (joints.kn > 0.0) & (sim.joints.kn > 0.0)  # of joints in space: slots that hold a point
        slip, opening = (
            np.maximum.reduceat(np.where(both, now - then, 0.0), joints.starts[:-1])
            for now, then in ((sim.contacts.slip, contacts.slip), (sim.contacts.gaps, contacts.gaps))
        )
        for key, values in (("sliding_joints", slip), ("opening_joints", opening)):
            parts[key] = _pairs(sim, np.flatnonzero(values > settings.takes_part * motion.max(initial=0.0)))
    return {"failure_mode": mode, "friction_share": share, "mechanism": parts}


def follows(sim: Simulation, held: SavedState, velocities: np.ndarray) -> bool:
    """Test whether blocks moved since a saved state as a mechanism says, and no other has set in besides.

    velocities: of that mechanism, in any unit, (n_blocks, n_dof)
    """
    d, radii = sim.model.dimension, sim.shape.radii[:, None]
    moved = np.column_stack([sim.bodies.positions - held.bodies.positions, rotations_since(sim, held.bodies) * radii])
    rates = np.column_stack([velocities[:, :d], velocities[:, d:] * radii])
    rest = moved - (moved * rates).sum() / (rates * rates).sum() * rates
    most = np.linalg.norm(moved, axis=1).max(initial=0.0)
    return bool(np.linalg.norm(rest, axis=1).max(initial=0.0) <= sim.settings.mechanism.follows * most)


def moved_blocks(sim: Simulation) -> dict[str, Any]:
    """Blocks that took part in a collapse, judged by their displacement from the start."""
    shift = np.sqrt((displacements(sim) ** 2).sum(axis=1))
    return named(sim, np.flatnonzero(shift > sim.settings.mechanism.takes_part * shift.max(initial=0.0)))


def _size(sim: Simulation) -> float:
    """Largest extent of the free blocks [m]."""
    places, radii = sim.bodies.positions[sim.free], sim.shape.radii[sim.free, None]
    return float(((places + radii).max(axis=0) - (places - radii).min(axis=0)).max())


def named(sim: Simulation, blocks: np.ndarray) -> dict[str, Any]:
    """Return the number of blocks, and the names of the first ones."""
    names = [sim.model.block_ids[i] for i in blocks[: sim.settings.mechanism.listed]]
    return {"count": len(blocks), "first": names}


def _pairs(sim: Simulation, joints: np.ndarray) -> dict[str, Any]:
    ids = sim.model.block_ids
    pairs = [[ids[a], ids[b]] for a, b in sim.joints.blocks[joints[: sim.settings.mechanism.listed]]]
    return {"count": len(joints), "first": pairs}
