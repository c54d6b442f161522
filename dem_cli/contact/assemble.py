"""From pairs of faces to the arrays of the contact loop, and the memory that follows a contact point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.contact.detect import Faces
from dem_cli.kernels.planar_geometry import measure
from dem_cli.kernels.records import Bodies, Contacts, Joints
from dem_cli.model.model import Model

LIKE = {2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}
LIKE_ROTATION = {2: (0.0,), 3: (0.0, 0.0, 0.0)}


class JointProperties(NamedTuple):
    """Properties of each named joint, by its number."""

    names: tuple[str, ...]
    by_material: np.ndarray  # joint of each pair of materials, (n_materials, n_materials) int64
    kn: np.ndarray  # [Pa/m], (n_named,)
    ks: np.ndarray  # [Pa/m], (n_named,)
    law: np.ndarray  # parameters of the law, (n_named, n_parameters)


class Ends(NamedTuple):
    """Contact points of all joints as they are now."""

    points: np.ndarray  # [m], (n_points, d)
    normals: np.ndarray  # unit, from a to b, (n_points, d)
    gaps: np.ndarray  # [m], (n_points,)
    overlaps: np.ndarray  # length of the overlap of the two faces [m], (n_joints,)


def empty_contacts(n_joints: int, n_points: int, dimension: int, n_memory: int) -> Contacts:
    """Contacts that carry nothing."""
    return Contacts(
        gaps=np.zeros(n_points),
        shear=np.zeros((n_points, dimension - 1)),
        normal=np.zeros(n_points),
        slip=np.zeros(n_points),
        memory=np.zeros((n_points, n_memory)),
        stale=np.zeros(n_joints + 1, np.int8),
    )


def measure_ends(joints: Joints, bodies: Bodies, contacts: Contacts, dimension: int) -> Ends:
    """Where the points of all joints are, from the corners of the blocks. Changes nothing."""
    n_joints, n_points = len(joints.blocks), len(joints.kn)
    ends = Ends(
        np.empty((n_points, dimension)), np.empty((n_points, dimension)), np.empty(n_points), np.empty(n_joints)
    )
    scratch = empty_contacts(n_joints, n_points, dimension, 0)
    measure(joints, bodies, scratch, LIKE[dimension], ends.points, ends.normals, ends.gaps, ends.overlaps)
    return ends


def build_joints(model: Model, faces: Faces, bodies: Bodies, properties: JointProperties) -> tuple[Joints, Ends]:
    """The joints of the given faces with stiffness from the present overlap, frames and arms of the present place."""
    d, n = model.dimension, len(faces.parts)
    blocks = model.part_blocks[faces.parts]
    corners = bodies.corners
    edge_vectors = corners[faces.edges[:, [1, 3]]] - corners[faces.edges[:, [0, 2]]]
    lengths = np.sqrt((edge_vectors**2).sum(axis=2))
    starts = np.arange(0, 2 * n + 1, 2)
    joints = Joints(
        blocks=blocks,
        starts=starts,
        frames=np.zeros((n, d, d)),
        arms=np.zeros((2 * n, 2, d)),
        edges=faces.edges,
        lengths=lengths,
        kn=np.zeros(2 * n),
        ks=np.zeros(2 * n),
        law=np.zeros((n, properties.law.shape[1])),
    )
    ends = measure_ends(joints, bodies, empty_contacts(n, 2 * n, d, 0), d)
    shortest = lengths.min(axis=1) if n else np.zeros(0)
    overlap = np.clip(ends.overlaps, 0.1 * shortest, shortest)
    area = overlap * model.thickness[blocks].min(axis=1) if n else overlap
    named = properties.by_material[model.block_material[blocks[:, 0]], model.block_material[blocks[:, 1]]]
    closest = starts[:-1] + (ends.gaps[1::2] < ends.gaps[0::2])
    normals = ends.normals[closest]
    frames = np.stack([normals, np.column_stack([-normals[:, 1], normals[:, 0]])], axis=1)
    arms = ends.points[:, None, :] - bodies.positions[blocks].repeat(2, axis=0)
    joints = joints._replace(
        frames=np.ascontiguousarray(frames),
        arms=np.ascontiguousarray(arms),
        kn=np.repeat(properties.kn[named] * area / 2, 2),
        ks=np.repeat(properties.ks[named] * area / 2, 2),
        law=np.ascontiguousarray(properties.law[named]),
    )
    return joints, ends


def carry_memory(old: Joints, memory: Contacts, points: np.ndarray, new: Joints, ends: Ends) -> tuple[Joints, Contacts]:
    """Contacts of `new` with what the same points of `old` remember, and their stiffness.

    A point is the same when its joint has the same two edges and it is the same end. Where a corner
    turned over to its other edge, the point of the same two blocks that is nearest takes over.
    points: where the old points are [m], (n_old, d).
    """
    d = ends.points.shape[1]
    contacts = empty_contacts(len(new.blocks), len(new.kn), d, memory.memory.shape[1])
    key_old = _row_keys(old.edges[:, [0, 2]])
    key_new = _row_keys(new.edges[:, [0, 2]])
    order = np.argsort(key_old, kind="stable")
    if len(order):
        place = np.minimum(np.searchsorted(key_old[order], key_new), len(order) - 1)
        match = np.where(key_old[order][place] == key_new, order[place], -1)
    else:
        match = np.full(len(key_new), -1)
    known = np.flatnonzero(match >= 0)
    target = np.concatenate([2 * known, 2 * known + 1])
    source = np.concatenate([2 * match[known], 2 * match[known] + 1])
    _copy(contacts, memory, target, source)
    new.kn[target], new.ks[target] = old.kn[source], old.ks[source]
    orphans = np.setdiff1d(np.flatnonzero(_loaded(memory)), match[known])
    if len(orphans):
        _adopt(old, memory, points, new, ends, contacts, orphans, np.flatnonzero(match < 0))
    return new, contacts


def _row_keys(pairs: np.ndarray) -> np.ndarray:
    return pairs[:, 0] * (1 << 31) + pairs[:, 1]


def _loaded(contacts: Contacts) -> np.ndarray:
    return contacts.normal.reshape(-1, 2).max(axis=1, initial=0.0) > 0.0


def _copy(contacts: Contacts, memory: Contacts, target: np.ndarray, source: np.ndarray) -> None:
    for field in ("shear", "normal", "slip", "memory"):
        getattr(contacts, field)[target] = getattr(memory, field)[source]


def _adopt(
    old: Joints,
    memory: Contacts,
    points: np.ndarray,
    new: Joints,
    ends: Ends,
    contacts: Contacts,
    orphans: Sequence[int],
    newborn: Sequence[int],
) -> None:
    """Memory of loaded joints whose edges changed goes to the nearest point of a new joint of the same blocks."""
    for i in orphans:
        heirs = [j for j in newborn if (new.blocks[j] == old.blocks[i]).all()]
        if not heirs:
            continue
        candidates = np.array([2 * j + k for j in heirs for k in (0, 1)])
        for source in (2 * i, 2 * i + 1):
            if memory.normal[source] > 0.0:
                distance = ((ends.points[candidates] - points[source]) ** 2).sum(axis=1)
                _copy(contacts, memory, candidates[[distance.argmin()]], np.array([source]))
