"""Initial state: blocks at rest in their first place, joints of the undeformed structure, and corners that meet.

Four stones whose corners meet in one place touch aslant. Such a pair carries nothing, to first order: either of them
can go past the other without another gap that closes. Geometry of the start has no joint there, and where geometry
moves there is none either until one corner has passed the other (engine/tracking.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.assemble import build_joints
from dem_cli.core.contact.detect import block_shape, world_corners
from dem_cli.core.contact.geometry import AnyNarrowPhase, geometry_of
from dem_cli.core.contact.joint_planes import in_planes
from dem_cli.core.contact.joints import Faces, JointArrays, JointProperties
from dem_cli.core.geometry.inertia import mobilities
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.geometry.rotation import turning, turns_of, unturned
from dem_cli.core.kernels.records import NO_MODES, Bodies, Contacts
from dem_cli.core.model.model import Model
from dem_cli.core.model.quadratic_modes import TERMS

TOUCHING_GAP = 1e-6  # faces closer than this share of the smallest edge touch


def bodies_at_rest(model: Model, origin: np.ndarray | float = 0.0, moves: bool = False) -> Bodies:
    """Place all blocks as the model has them, without motion; coordinates from `origin` [m], (d,).

    moves: whether geometry does; orientations in space are quaternions then, else rotation vectors that add up.
    """
    n, n_modes = model.n_blocks, model.n_modes
    n_dof = model.dead_loads.shape[1] + n_modes
    shape, positions = block_shape(model), model.centroids - origin
    orientations = unturned(n, model.dimension) if moves else np.zeros_like(model.inertias)
    turns = turns_of(orientations)
    return Bodies(
        positions, orientations, np.zeros((n, n_dof)), np.zeros((n, n_dof)), np.zeros((n, n_dof)),
        world_corners(shape, positions, orientations), turns, mobilities(shape.inertias, shape.axes, turns),
        np.zeros(n * n_dof), np.zeros(n * n_dof), np.zeros(n * n_dof), np.zeros(n),
        poses=orientations.copy(), turned=np.zeros(n, np.int8), **_unstrained(model),
    )  # fmt: skip


def _unstrained(model: Model) -> dict[str, np.ndarray]:
    """Make the fields of blocks that deform, before they do; empty where all blocks are rigid."""
    if not model.n_modes:
        return {}
    n, d = model.n_blocks, model.dimension
    one, zero = np.tile(np.eye(d).ravel(), (n, 1)), np.zeros((n, d * d))
    return {
        "modes": np.zeros((n, model.n_modes)), "gradients": one, "covectors": one.copy() if d == 3 else NO_MODES,
        "stretchings": zero, "dyads": zero.copy(), **_unbent(model),
    }  # fmt: skip


def _unbent(model: Model) -> dict[str, np.ndarray]:
    """Make the fields of quadratic modes; empty where no block has them."""
    if not len(model.mode_shapes):
        return {}
    n, two = model.n_blocks, 2 * TERMS
    return {"bent": np.zeros((n, two)), "bending": np.zeros((n, two)), "triads": np.zeros((n, two // 2))}


def close_touching(contacts: Contacts, smallest: float, near: float = TOUCHING_GAP) -> None:
    """Set gaps within round-off to zero; near: up to this share of the smallest edge."""
    contacts.gaps[np.abs(contacts.gaps) <= near * smallest] = 0.0


def bond_touching(model: Model, built: JointArrays, properties: JointProperties, narrow: AnyNarrowPhase) -> None:
    """Set the memory of touching points to an intact bond, where faces lie on each other. An edge on a face has no area
    that a bond could hold. narrow: of the geometry of these joints.
    """
    joints, contacts = built.joints, built.contacts
    count = min(properties.intact.shape[1], contacts.memory.shape[1])  # limit analysis remembers nothing
    touching = (contacts.gaps <= 0.0) & narrow.bonds(model, built.geometry)[joints.owners]
    named = properties.between(model, joints.blocks)[joints.owners]
    contacts.memory[touching, :count] = properties.intact[named[touching], :count]


def joints_of_start(
    model: Model,
    bodies: Bodies,
    properties: JointProperties,
    smallest: float,
    n_memory: int = 0,
    near: float = TOUCHING_GAP,
) -> JointArrays:
    """Find the joints of the undeformed structure, for fixed geometry and limit analysis: faces that touch.

    smallest: shortest edge of a block [m] (model.scales); near: gap or overlap, over that, up to which faces touch [-].
    Faces that meet corner to corner are left out: to first order they cannot carry force. All points of a joint lie in
    one plane.
    """
    narrow, reach = geometry_of(model.dimension), near * smallest
    faces = properties.acting(model, narrow.find(model, bodies.corners, reach))
    faces = faces.where(narrow.touching(model, faces, bodies.corners, reach))
    built = build_joints(model, faces, bodies, properties, n_memory, moves=False)
    close_touching(built.contacts, smallest, near)
    bond_touching(model, built, properties, narrow)
    planes = in_planes(built.joints, built.contacts.gaps, bodies.positions)
    return built._replace(joints=planes, geometry=built.geometry.settled())


class CornerMeetings(NamedTuple):
    """Pairs of parts that touch at corners or edges alone; a pair has the places starts[j]:starts[j + 1]."""

    parts: np.ndarray  # the two parts, (n, 2) int64
    blocks: np.ndarray  # whose they are, (n, 2) int64
    sizes: np.ndarray  # of the smaller part [m], (n,)
    starts: np.ndarray  # (n + 1,) int64
    first_arms: np.ndarray  # places from the centroid of the first block, unturned [m], (n_places, d)
    second_arms: np.ndarray  # the same places from that of the second one [m], (n_places, d)

    def shifts(self, bodies: Bodies) -> np.ndarray:
        """Compute the relative displacement of two parts where they met [m], the largest of each pair, (n,)."""
        if not len(self.parts):
            return np.zeros(0)
        owners = np.repeat(np.arange(len(self.parts)), np.diff(self.starts))
        first, second = self.blocks[owners].T
        now = [
            bodies.positions[of] + turning(bodies.orientations[of])(arms)
            for of, arms in ((first, self.first_arms), (second, self.second_arms))
        ]
        return np.maximum.reduceat(np.linalg.norm(now[1] - now[0], axis=1), self.starts[:-1])


def corner_meetings(model: Model, narrow: AnyNarrowPhase, faces: Faces, bodies: Bodies, reach: float) -> CornerMeetings:
    """Find parts that touch at the start within `reach` [m] and have no joint; faces: pairs that are near.

    narrow: of the geometry of the start.
    """
    n = model.n_parts
    near = faces.where(np.abs(faces.separation) <= reach)
    joined = near.parts[narrow.touching(model, near, bodies.corners, reach)]
    pairs = np.setdiff1d(near.parts[:, 0] * n + near.parts[:, 1], joined[:, 0] * n + joined[:, 1])
    parts = np.column_stack([pairs // n, pairs % n])
    places, owners = _shared_corners(model, parts, bodies.corners, reach)
    counts = np.bincount(owners, minlength=len(parts))
    kept = counts > 0
    blocks = model.part_blocks[parts]
    first, second = blocks[owners].T
    return CornerMeetings(
        parts[kept], blocks[kept], model.parts.sizes[parts[kept]].min(axis=1, initial=np.inf),
        np.concatenate([[0], np.cumsum(counts[kept])]).astype(np.int64),
        places - bodies.positions[first], places - bodies.positions[second],
    )  # fmt: skip


def _shared_corners(
    model: Model, parts: np.ndarray, corners: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Find corners of either part that lie on the other one, (n_places, d), and the pair of each, in order,
    (n_places,).
    """
    topology = model.topology
    normals = shapes_of(corners).normals(corners, topology)
    heights = (normals * corners[topology.ends[:, 0]]).sum(axis=1)
    places, owners = [], []
    for pair, (a, b) in enumerate(parts):
        for own, other in ((a, b), (b, a)):
            of_part = corners[model.part_starts[own] : model.part_starts[own + 1]]
            sides = slice(topology.part_faces[other], topology.part_faces[other + 1])
            outside = (of_part[:, np.newaxis] * normals[sides]).sum(axis=2) - heights[sides]
            found = of_part[outside.max(axis=1) <= reach]
            places.append(found)
            owners.append(np.full(len(found), pair))
    if not places:
        return np.zeros((0, model.dimension)), np.zeros(0, np.int64)
    return np.concatenate(places), np.concatenate(owners)
