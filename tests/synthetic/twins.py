"""Planar simulations as prisms in space, for the compiled loops: each contact point becomes one or several along z."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.records import Bodies, Contacts, Loads
from dem_cli.core.kernels.tiles.joint_tiles import NO_TILES

LIKE = {2: (0.0,) * 2, 3: (0.0,) * 3}
LIKE_ROTATION = {2: (0.0,), 3: (0.0,) * 3}
PLANAR = [0, 1, 5]  # where x, y and the angle stand in space


class Twin(NamedTuple):
    """The arrays of a planar scene as a scene in space."""

    bodies: Bodies
    joints: FixedJoints
    contacts: Contacts
    loads: Loads


def in_space(rows: np.ndarray) -> np.ndarray:
    """(n, 3) planar degrees of freedom as (n, 6)."""
    wide = np.zeros((len(rows), 6))
    wide[:, PLANAR] = rows
    return wide


def twin(sim: Simulation, layers: Sequence[float] = (0.0,)) -> Twin:
    """The blocks of a simulation with fixed geometry as prisms along z, with a contact point in each layer [m].

    The points of a layer share the stiffness and the forces; rotations about x and y have masses of their own.
    """
    n, bodies = sim.model.n_blocks, sim.bodies
    flat = np.zeros((n, 1))
    spatial = Bodies(
        positions=np.column_stack([bodies.positions, flat]),
        orientations=np.column_stack([flat, flat, bodies.orientations]),
        velocities=in_space(bodies.velocities),
        forces=in_space(bodies.forces),
        unbalanced=in_space(bodies.unbalanced),
        corners=bodies.corners.copy(),
        turns=bodies.turns.copy(),
        mobilities=np.zeros((n, 9)),
        means=np.zeros(6 * n),
        drags=np.zeros(6 * n),
        pulled=np.zeros(6 * n),
        travel=bodies.travel.copy(),
    )
    loads = Loads(*(in_space(field) for field in sim.loads))
    loads.inverse_masses[:, 2] = sim.loads.inverse_masses[:, 0]
    loads.inverse_masses[:, 3:5] = sim.loads.inverse_masses[:, 2:]
    loads.force_scales[:, 2:5] = 1.0
    loads.speed_limits[:, 2:5] = np.inf
    return Twin(spatial, _joints(sim.joints, np.array(layers)), _contacts(sim.contacts, len(layers)), loads)


def _joints(joints: FixedJoints, layers: np.ndarray) -> FixedJoints:
    n, m = len(joints.blocks), len(layers)
    axes = np.zeros((n, 3, 3))
    axes[:, :2, :2], axes[:, 2, 2] = joints.directions, 1.0
    arms = np.zeros((n, 2, 3))
    arms[:, :, :2] = joints.arms.reshape(n, 2, 2)
    places = np.column_stack([joints.places.repeat(m, axis=0), np.tile(layers, len(joints.places))])
    return joints._replace(
        starts=joints.starts * m,
        axes=axes.reshape(n, 9),
        anchors=np.column_stack([joints.anchors, np.zeros(n)]),
        arms=arms.reshape(n, 6),
        places=np.ascontiguousarray(places),
        kn=joints.kn.repeat(m) / m,
        ks=joints.ks.repeat(m) / m,
        torsion=np.ones(n),
        tiles=NO_TILES,
    )


def _contacts(contacts: Contacts, m: int) -> Contacts:
    as_wholes = {name: getattr(contacts, name).copy() for name in ("stale", "exchanged", "jolts")}
    points = {name: values for name, values in contacts._asdict().items() if name not in as_wholes}
    each = Contacts(**{name: values.repeat(m, axis=0) for name, values in points.items()}, **as_wholes)
    shear = np.column_stack([each.shear / m, np.zeros(len(each.gaps))])
    return each._replace(shear=np.ascontiguousarray(shear), normal=each.normal / m)
