"""Blocks at rest in their first place, and the joints that the geometry of the start has."""

from __future__ import annotations

import numpy as np

from dem_cli.contact.assemble import JointProperties, build_joints, overlap_lengths, share_frames
from dem_cli.contact.detect import Faces, block_shape, find_joints, world_corners
from dem_cli.geometry.rotation import cross, unturned
from dem_cli.kernels.records import Bodies, Contacts, Joints
from dem_cli.model.model import Model

TOUCH = 1e-6  # faces closer than this share of the smallest edge touch
PARALLEL = 1e-2  # sine of the angle between edges that touch along their length


def bodies_at_rest(model: Model, origin: np.ndarray | float = 0.0) -> Bodies:
    """All blocks where the model places them, without motion; coordinates from `origin` [m], (d,)."""
    n, n_dof = model.n_blocks, model.dimension + model.inertias.shape[1]
    positions, orientations = model.centroids - origin, unturned(n, model.dimension)
    corners = world_corners(block_shape(model), positions, orientations)
    return Bodies(
        positions, orientations, np.zeros((n, n_dof)), np.zeros((n, n_dof)), np.zeros((n, n_dof)), corners,
        np.zeros((n, 2)), np.zeros(n * n_dof), np.zeros(n * n_dof), np.zeros(n * n_dof), np.zeros(n),
    )  # fmt: skip


def close_touching(contacts: Contacts, smallest: float) -> None:
    """Gaps that are nothing but round-off become none."""
    contacts.gaps[np.abs(contacts.gaps) <= TOUCH * smallest] = 0.0


def bond_touching(model: Model, joints: Joints, contacts: Contacts, properties: JointProperties) -> None:
    """Points without a gap start intact: they remember what their law says of a young joint."""
    count = min(properties.intact.shape[1], contacts.memory.shape[1])  # limit analysis remembers nothing
    touching = contacts.gaps <= 0.0
    named = properties.between(model, joints.blocks)[joints.owners]
    contacts.memory[touching, :count] = properties.intact[named[touching], :count]


def joints_of_start(
    model: Model, bodies: Bodies, properties: JointProperties, smallest: float, n_memory: int = 0
) -> tuple[Joints, Contacts]:
    """Faces that touch in the undeformed structure: what fixed geometry and limit analysis work on.

    smallest: shortest edge of a block [m] (model.scales). Faces that meet corner to corner are left out: to
    first order they cannot carry force. All points of a joint share one frame, that of its closer end.
    """
    faces = find_joints(model, bodies.corners, TOUCH * smallest)
    keep = overlap_lengths(faces.edges, bodies.corners) > TOUCH * smallest
    keep &= ~corner_to_corner(faces.edges, bodies.corners, TOUCH * smallest)
    joints, contacts = build_joints(model, Faces(*(field[keep] for field in faces)), bodies, properties, n_memory)
    close_touching(contacts, smallest)
    bond_touching(model, joints, contacts, properties)
    first, last = joints.starts[:-1], joints.starts[1:] - 1
    share_frames(joints, np.where(contacts.gaps[last] < contacts.gaps[first], last, first), bodies.positions)
    return joints, contacts


def corner_to_corner(edges: np.ndarray, corners: np.ndarray, reach: float) -> np.ndarray:
    """Edges under an angle that meet with an end each, closer than `reach` [m], (n,) bool; 2D."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    a, b = ((end - start) / np.hypot(*(end - start).T)[:, None] for start, end in ((a0, a1), (b0, b1)))
    angled = np.abs(cross(a, b)) > PARALLEL
    apart = np.minimum(np.hypot(*(a0 - b1).T), np.hypot(*(a1 - b0).T))
    return angled & (apart <= reach)
