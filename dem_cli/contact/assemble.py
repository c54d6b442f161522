"""From pairs of faces to the arrays of the contact loop, and the memory that follows a contact point."""

from __future__ import annotations

from typing import NamedTuple
from zlib import crc32

import numpy as np

from dem_cli.contact.detect import Faces
from dem_cli.contact.layout import PointLayout, draw
from dem_cli.geometry import profile
from dem_cli.geometry.rotation import cross
from dem_cli.kernels.planar_geometry import BLEND, measure
from dem_cli.kernels.planar_profiles import measure_profiles
from dem_cli.kernels.records import Bodies, Contacts, Joints
from dem_cli.model.model import Model

LIKE = {2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}
LIKE_ROTATION = {2: (0.0,), 3: (0.0, 0.0, 0.0)}
STEEP = np.cos(np.pi / 4) - 1e-9  # a head joint has its normal within 45° of the horizontal
END_TO_END = 1e-3  # of the edge of b: a shorter overlap at the start is none


class Chains(NamedTuple):
    """The contact points of the joints of the start, which come back wherever the same two faces meet again."""

    edges: np.ndarray  # as Joints.edges, (n_joints, 4)
    starts: np.ndarray  # as Joints.starts, (n_joints + 1,)
    profile: np.ndarray  # as Joints.profile, (n_points, 2)
    shares: np.ndarray  # of the area of the joint that belong to each point, (n_points,)


class JointProperties(NamedTuple):
    """Properties of each named joint, by its number."""

    names: tuple[str, ...]
    by_material: np.ndarray  # joint of each pair of materials, (n_materials, n_materials) int64
    kn: np.ndarray  # [Pa/m], (n_named,)
    ks: np.ndarray  # [Pa/m], (n_named,)
    law: np.ndarray  # parameters of the law, (n_named, n_parameters)
    intact: np.ndarray  # what points that touch at the start remember, (n_named, n_scalars)
    layouts: tuple[PointLayout | None, ...]  # where the contact points are; None: at the two ends of the joint

    @property
    def profiled(self) -> bool:
        """Whether any joint has points elsewhere than at its two ends."""
        return any(layout is not None for layout in self.layouts)

    def between(self, model: Model, blocks: np.ndarray) -> np.ndarray:
        """The named joint of each pair of blocks (n, 2), (n,) int64."""
        materials = model.block_material[blocks]
        return self.by_material[materials[:, 0], materials[:, 1]]


def empty_contacts(n_joints: int, n_points: int, dimension: int, n_memory: int) -> Contacts:
    """Contacts that carry nothing."""
    return Contacts(
        gaps=np.zeros(n_points),
        shear=np.zeros((n_points, dimension - 1)),
        normal=np.zeros(n_points),
        slip=np.zeros(n_points),
        memory=np.zeros((n_points, n_memory)),
        sunk=np.zeros(n_joints),
        stale=np.zeros(n_joints + 1, np.int8),
    )


def overlap_lengths(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Length of the overlap of two edges along the first [m], (n,); negative: they miss each other."""
    low, high = overlap_ends(edges, corners)
    return high - low


def overlap_ends(edges: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the overlap of two edges begins and ends, along the first edge from its start [m], (n,) each."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = a1 - a0
    length = np.sqrt((along**2).sum(axis=1))
    along /= length[:, None]
    low, high = ((b1 - a0) * along).sum(axis=1), ((b0 - a0) * along).sum(axis=1)
    return np.maximum(low, 0.0), np.minimum(high, length)


def build_joints(
    model: Model, faces: Faces, bodies: Bodies, properties: JointProperties, n_memory: int, chains: Chains | None = None
) -> tuple[Joints, Contacts]:
    """The joints of the given faces with stiffness from their present overlap, and contacts that carry nothing.

    chains: of the joints of the start, which alone have a profile or more than two points; None: these are they.
    """
    d, n = model.dimension, len(faces.parts)
    blocks = model.part_blocks[faces.parts]
    ends = bodies.corners[faces.edges]
    lengths = np.sqrt(((ends[:, [1, 3]] - ends[:, [0, 2]]) ** 2).sum(axis=2))
    shortest = lengths.min(axis=1, initial=np.inf)
    overlap = np.clip(overlap_lengths(faces.edges, bodies.corners), 0.1 * shortest, shortest)
    area = overlap * model.thickness[blocks].min(axis=1, initial=np.inf)
    named = properties.between(model, blocks)
    starts, profiles, shares = np.arange(0, 2 * n + 1, 2), np.zeros((0, 2)), np.full(2 * n, 0.5)
    if properties.profiled:
        chains = chains_of_start(model, faces, bodies, properties) if chains is None else chains
        starts, profiles, shares = _come_back(chains, faces, bodies.corners)
    owner, n_points = np.repeat(np.arange(n), np.diff(starts)), int(starts[-1])
    joints = Joints(
        blocks=blocks,
        starts=starts,
        frames=np.zeros((n_points, d * d)),
        levers=np.zeros((n_points, 2 * d * model.inertias.shape[1])),
        points=np.zeros((n_points, d)),
        edges=faces.edges,
        profile=profiles,
        scales=np.ascontiguousarray(
            np.column_stack([lengths[:, 0], 1.0 / lengths, 0.5 / (BLEND * shortest), _cotangents(model)[faces.edges]])
        ),
        kn=(properties.kn[named] * area)[owner] * shares,
        ks=(properties.ks[named] * area)[owner] * shares,
        law=np.ascontiguousarray(properties.law[named]),
    )
    contacts = empty_contacts(n, n_points, d, n_memory)
    measure_points(joints, contacts, bodies)
    contacts.stale[-1] = 0  # faces that are the wrong ones already need not ask: the right ones are in the list
    return joints, contacts


def _cotangents(model: Model) -> np.ndarray:
    """Cotangent of the inner angle at each corner, (n_vertices,); 2D."""
    first, after = model.topology.ends.T
    leaving = model.vertices[after] - model.vertices[first]
    arriving = np.empty_like(leaving)
    arriving[after] = leaving
    turn = cross(arriving, leaving)
    size = np.sqrt((arriving**2).sum(axis=1) * (leaving**2).sum(axis=1))
    return -(arriving * leaving).sum(axis=1) / np.maximum(turn, 1e-9 * size)


def measure_points(joints: Joints, contacts: Contacts, bodies: Bodies) -> None:
    """Gaps of all contacts, frames, levers and points of all joints, where the blocks are now."""
    (measure_profiles if len(joints.profile) else measure)(joints, contacts, bodies)


def chains_of_start(model: Model, faces: Faces, bodies: Bodies, properties: JointProperties) -> Chains:
    """Contact points of the joints of the start, by the layout of their named joint."""
    corners, n = bodies.corners, len(faces.parts)
    named = properties.between(model, model.part_blocks[faces.parts])
    low, high = overlap_ends(faces.edges, corners)
    a0, a1, b0, b1 = (corners[faces.edges[:, i]] for i in range(4))
    along = (a1 - a0) / np.sqrt(((a1 - a0) ** 2).sum(axis=1))[:, None]
    from_b1 = ((b1 - a0) * along).sum(axis=1)  # where the edge of b starts, along that of a
    whole = np.sqrt(((b1 - b0) ** 2).sum(axis=1))
    rows, shares = [np.zeros((0, 2))], [np.zeros(0)]
    faces_named = _face_names(model)
    for i in range(n):
        layout = properties.layouts[named[i]]
        row, share = np.array([[0.0, 0.0], [whole[i], 0.0]]), np.full(2, 0.5)
        if layout is not None and _has(layout, high[i] - low[i], whole[i], along[i]):
            key = (faces_named[faces.edges[i, 2]], faces_named[faces.edges[i, 0]])
            row, share = _chain(layout, key, low[i] - from_b1[i], high[i] - from_b1[i], whole[i])
        rows.append(row)
        shares.append(share)
    starts = np.cumsum([len(row) for row in rows]).astype(np.int64)
    return Chains(faces.edges, starts, np.ascontiguousarray(np.concatenate(rows)), np.concatenate(shares))


def _come_back(chains: Chains, faces: Faces, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First point of each joint, profile and shares of all points: those of the start keep theirs, others are plane."""
    known = same_joints(chains.edges, faces.edges)
    stay = np.flatnonzero(known >= 0)
    counts = np.full(len(known), 2)
    counts[stay] = np.diff(chains.starts)[known[stay]]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    profile, shares = np.zeros((starts[-1], 2)), np.full(starts[-1], 0.5)
    profile[starts[1:] - 1, 0] = np.sqrt(((corners[faces.edges[:, 3]] - corners[faces.edges[:, 2]]) ** 2).sum(axis=1))
    here, there = points_of(starts, stay), points_of(chains.starts, known[stay])
    profile[here] = chains.profile[there]
    shares[here] = chains.shares[there]
    return starts, profile, shares


def _chain(
    layout: PointLayout, key: tuple[int, int], low: float, high: float, whole: float
) -> tuple[np.ndarray, np.ndarray]:
    """Profile (n, 2) of one joint, as Joints.profile, and the share of its area of each point, (n,).

    key: of the edges of b and of a; low, high: its ends along the edge of b, from near a0 on; whole: its length.
    """
    # Polygons are listed from left to right, or from the top down: that is from a1 to a0.
    if layout.sides is None or layout.over == "joint":
        places, rises, share = draw(layout, key, high - low)
        return np.column_stack([high - places, rises])[::-1], share[::-1]
    places, rises, share = draw(layout, key[:1], whole)
    places, rises = profile.cut((whole - places)[::-1], rises[::-1], low, high)
    return np.column_stack([places, rises]), np.full(len(places), share[0])


def _face_names(model: Model) -> list[int]:
    """A number for each edge that says whose it is and which: other blocks change nothing, (n_vertices,)."""
    names = []
    for part, block in enumerate(model.part_blocks):
        of_block = part - int(np.searchsorted(model.part_blocks, block))
        for edge in range(int(model.part_starts[part + 1] - model.part_starts[part])):
            names.append(crc32(f"{model.block_ids[block]} {of_block} {edge}".encode()))
    return names


def _has(layout: PointLayout, overlap: float, whole: float, along: np.ndarray) -> bool:
    """Whether a joint with this overlap, along a unit vector, has the layout; joints end to end have none."""
    kind = "bed" if abs(along[0]) >= STEEP else "head"
    return overlap > END_TO_END * whole and layout.only in ("all", kind)


def share_frames(joints: Joints, source: np.ndarray, positions: np.ndarray) -> None:
    """Gives all points of joint j the frame of point source[j]; 2D."""
    counts = np.diff(joints.starts)
    joints.frames[:] = joints.frames[source].repeat(counts, axis=0)
    normals = joints.frames[:, :2]
    for side in (0, 1):
        arms = joints.points - positions[joints.blocks[:, side]].repeat(counts, axis=0)
        joints.levers[:, 2 * side] = cross(arms, normals)
        joints.levers[:, 2 * side + 1] = (arms * normals).sum(axis=1)


def carry_memory(old: Joints, memory: Contacts, new: Joints, contacts: Contacts) -> None:
    """Gives the points of `new` what the same points of `old` remember, and their stiffness.

    A point is the same when its joint has the same two edges and it has the same place among its points. Where a
    corner turned over to its other edge, the point of the same two blocks that is nearest takes over.
    """
    match = same_joints(old.edges, new.edges)
    known = np.flatnonzero(match >= 0)
    target, source = points_of(new.starts, known), points_of(old.starts, match[known])
    _copy(contacts, memory, target, source)
    new.kn[target], new.ks[target] = old.kn[source], old.ks[source]
    contacts.sunk[:] = np.inf
    contacts.sunk[known] = memory.sunk[match[known]]
    orphans = np.setdiff1d(np.flatnonzero(_loaded(old, memory)), match[known])
    newborn = np.flatnonzero(match < 0)
    if len(orphans) and len(newborn):
        _adopt(old, memory, new, contacts, orphans, newborn)


def same_joints(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Which of the old joints has the same two edges, −1: none, (n_new,); edges as Joints.edges."""
    key_old, key_new = _row_keys(old[:, [0, 2]]), _row_keys(new[:, [0, 2]])
    if not len(key_old):
        return np.full(len(key_new), -1)
    order = np.argsort(key_old, kind="stable")
    place = np.minimum(np.searchsorted(key_old[order], key_new), len(order) - 1)
    return np.where(key_old[order][place] == key_new, order[place], -1)


def points_of(starts: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """All points of these joints, joint by joint."""
    counts = starts[joints + 1] - starts[joints]
    before = np.concatenate([[0], np.cumsum(counts)])[:-1]
    return np.repeat(starts[joints] - before, counts) + np.arange(counts.sum())


def _row_keys(pairs: np.ndarray) -> np.ndarray:
    return pairs[:, 0] * (1 << 31) + pairs[:, 1]


def _loaded(joints: Joints, contacts: Contacts) -> np.ndarray:
    if not len(joints.blocks):
        return np.zeros(0, bool)
    return np.maximum.reduceat(np.abs(contacts.normal), joints.starts[:-1]) > 0.0


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
        heirs = np.array([j for j in newborn if (new.blocks[j] == old.blocks[i]).all()], int)
        if not len(heirs):
            continue
        candidates = points_of(new.starts, heirs)
        for source in range(old.starts[i], old.starts[i + 1]):
            if memory.normal[source] != 0.0:
                distance = ((new.points[candidates] - old.points[source]) ** 2).sum(axis=1)
                heir = candidates[[distance.argmin()]]
                _copy(contacts, memory, heir, np.array([source]))
                new.kn[heir], new.ks[heir] = old.kn[source], old.ks[source]
                # Deeper inside than its force says: the recess of a profile, which is no reason to push.
                deeper = max(-contacts.gaps[heir[0]] - memory.normal[source] / old.kn[source], 0.0)
                joint = np.searchsorted(new.starts, heir[0], side="right") - 1
                contacts.sunk[joint] = min(contacts.sunk[joint], deeper)
