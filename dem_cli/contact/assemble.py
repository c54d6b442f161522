"""From pairs of faces to the arrays of the contact loop, and the memory that follows a contact point."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.detect import Faces
from dem_cli.kernels.planar_geometry import BLEND, measure
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


def overlap_lengths(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Length of the overlap of two edges along the first [m], (n,); negative: they miss each other."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = a1 - a0
    length = np.sqrt((along**2).sum(axis=1))
    along /= length[:, None]
    low, high = ((b1 - a0) * along).sum(axis=1), ((b0 - a0) * along).sum(axis=1)
    return np.minimum(high, length) - np.maximum(low, 0.0)


def build_joints(
    model: Model, faces: Faces, bodies: Bodies, properties: JointProperties, n_memory: int
) -> tuple[Joints, Contacts]:
    """The joints of the given faces with stiffness from their present overlap, and contacts that carry nothing."""
    d, n = model.dimension, len(faces.parts)
    blocks = model.part_blocks[faces.parts]
    ends = bodies.corners[faces.edges]
    lengths = np.sqrt(((ends[:, [1, 3]] - ends[:, [0, 2]]) ** 2).sum(axis=2))
    shortest = lengths.min(axis=1, initial=np.inf)
    overlap = np.clip(overlap_lengths(faces.edges, bodies.corners), 0.1 * shortest, shortest)
    area = overlap * model.thickness[blocks].min(axis=1, initial=np.inf)
    named = properties.by_material[model.block_material[blocks[:, 0]], model.block_material[blocks[:, 1]]]
    joints = Joints(
        blocks=blocks,
        starts=np.arange(0, 2 * n + 1, 2),
        frames=np.zeros((2 * n, d * d)),
        levers=np.zeros((2 * n, 2 * d * model.inertias.shape[1])),
        points=np.zeros((2 * n, d)),
        edges=faces.edges,
        scales=np.ascontiguousarray(np.column_stack([lengths[:, 0], 1.0 / lengths, 0.5 / (BLEND * shortest)])),
        kn=np.repeat(properties.kn[named] * area / 2, 2),
        ks=np.repeat(properties.ks[named] * area / 2, 2),
        law=np.ascontiguousarray(properties.law[named]),
    )
    contacts = empty_contacts(n, 2 * n, d, n_memory)
    measure(joints, contacts, bodies)
    contacts.stale[-1] = 0  # faces that are the wrong ones already need not ask: the right ones are in the list
    return joints, contacts


def share_frames(joints: Joints, source: np.ndarray, positions: np.ndarray) -> None:
    """Gives both points of joint j the frame of point source[j]; 2D."""
    joints.frames[:] = joints.frames[source].repeat(2, axis=0)
    normals = joints.frames[:, :2]
    for side in (0, 1):
        arms = joints.points - positions[joints.blocks[:, side]].repeat(2, axis=0)
        joints.levers[:, 2 * side] = arms[:, 0] * normals[:, 1] - arms[:, 1] * normals[:, 0]
        joints.levers[:, 2 * side + 1] = (arms * normals).sum(axis=1)


def carry_memory(old: Joints, memory: Contacts, new: Joints, contacts: Contacts) -> None:
    """Gives the points of `new` what the same points of `old` remember, and their stiffness.

    A point is the same when its joint has the same two edges and it is the same end. Where a corner
    turned over to its other edge, the point of the same two blocks that is nearest takes over.
    """
    key_old, key_new = _row_keys(old.edges[:, [0, 2]]), _row_keys(new.edges[:, [0, 2]])
    order = np.argsort(key_old, kind="stable")
    match = np.full(len(key_new), -1)
    if len(order):
        place = np.minimum(np.searchsorted(key_old[order], key_new), len(order) - 1)
        match = np.where(key_old[order][place] == key_new, order[place], -1)
    known = np.flatnonzero(match >= 0)
    target = np.concatenate([2 * known, 2 * known + 1])
    source = np.concatenate([2 * match[known], 2 * match[known] + 1])
    _copy(contacts, memory, target, source)
    new.kn[target], new.ks[target] = old.kn[source], old.ks[source]
    orphans = np.setdiff1d(np.flatnonzero(_loaded(memory)), match[known])
    newborn = np.flatnonzero(match < 0)
    if len(orphans) and len(newborn):
        _adopt(old, memory, new, contacts, orphans, newborn)


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
    new: Joints,
    contacts: Contacts,
    orphans: np.ndarray,
    newborn: np.ndarray,
) -> None:
    """Memory of loaded joints whose edges changed goes to the nearest point of a new joint of the same blocks."""
    for i in orphans:
        heirs = [j for j in newborn if (new.blocks[j] == old.blocks[i]).all()]
        if not heirs:
            continue
        candidates = np.array([2 * j + k for j in heirs for k in (0, 1)])
        for source in (2 * i, 2 * i + 1):
            if memory.normal[source] > 0.0:
                distance = ((new.points[candidates] - old.points[source]) ** 2).sum(axis=1)
                heir = candidates[[distance.argmin()]]
                _copy(contacts, memory, heir, np.array([source]))
                new.kn[heir], new.ks[heir] = old.kn[source], old.ks[source]
