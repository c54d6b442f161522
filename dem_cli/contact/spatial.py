"""Narrow phase in space: faces, edges and corners of convex polyhedra that meet, and contact points between them.

Geometry of the start: points stay where they were found. One of the modules of contact/geometry.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.joints import Faces, JointProperties, joints_of
from dem_cli.contact.near_boxes import near_boxes
from dem_cli.errors import UsageError
from dem_cli.geometry.rotation import matrices
from dem_cli.geometry.solids import face_areas
from dem_cli.kernels.records import (
    FACES,
    BlockShapes,
    Bodies,
    Contacts,
    Joints,
    MovingJoints,
    Polyhedra,
    SpatialGeometry,
)
from dem_cli.kernels.separation import separations
from dem_cli.kernels.spatial_geometry import AREA, CENTRE, GAP, MARGIN, POLAR, describe
from dem_cli.model.model import Model

LONE = 0.25  # of the median face: the area of a point outside of face joints


class Meetings(NamedTuple):
    """Where pairs of parts meet, before there are joints; a pair owns points starts[j]:starts[j + 1]."""

    kinds: np.ndarray  # as SpatialGeometry.kinds, (n,)
    starts: np.ndarray  # (n + 1,)
    frames: np.ndarray  # unit normal from a to b, then tangents, (n, 9)
    places: np.ndarray  # [m], (n_points, 3)
    weights: np.ndarray  # area of each point of face joints [m²], else 1, (n_points,)
    gaps: np.ndarray  # [m], (n_points,)
    features: np.ndarray  # what each point is, (n_points,)
    measures: np.ndarray  # columns as in kernels/spatial_geometry.py, (n, 7)

    @property
    def owners(self) -> np.ndarray:
        """Pair of each point, (n_points,)."""
        return np.repeat(np.arange(len(self.kinds)), np.diff(self.starts))


def polyhedra(model: Model, corners: np.ndarray) -> Polyhedra:
    """The parts of a model in place, as the kernels read them; corners: as `corners_of`."""
    topology = model.topology
    areas = face_areas(corners, topology)
    normals = areas / np.linalg.norm(areas, axis=1)[:, None]
    return Polyhedra(
        np.ascontiguousarray(corners), model.part_starts, topology.part_faces, topology.face_starts,
        topology.face_corners, normals, topology.part_edges, topology.edges, model.parts.sizes,
    )  # fmt: skip


def find(model: Model, corners: np.ndarray, reach: float) -> Faces:
    """All pairs of parts of different blocks that are closer than `reach` [m], by the faces that look at each other.

    Two fixed blocks have no joint. Pairs are ordered by parts, whatever finds them.
    """
    solids = polyhedra(model, corners)
    pairs = near_boxes(corners, model.part_starts, model.part_blocks, model.fixed, reach)
    faces, separation = np.empty((len(pairs), 2), np.int64), np.empty(len(pairs))
    separations(solids, pairs, reach, separation, faces)
    near = separation <= reach
    # Where a piece touches another block with an inner face only, it is at an edge that another piece has too.
    near[near] &= ~model.inner_faces[faces[near]].any(axis=1)
    return Faces(pairs[near], faces[near], separation[near])


def meetings(model: Model, faces: Faces, corners: np.ndarray) -> Meetings:
    """Contact points of pairs of parts, where these are now."""
    solids = polyhedra(model, corners)
    n, sizes = len(faces.parts), np.diff(solids.face_starts)
    room = np.concatenate([[0], np.cumsum(sizes[faces.faces].sum(axis=1))]).astype(np.int64)
    work = np.zeros((5, 2 * int(sizes.max(initial=0)) + 2, 3))
    frames, measures = np.zeros((n, 9)), np.zeros((n, 7))
    places, weights, gaps = np.zeros((room[-1], 3)), np.zeros(room[-1]), np.zeros(room[-1])
    features, kinds, counts = np.zeros(room[-1], np.int64), np.zeros(n, np.int8), np.zeros(n, np.int64)
    out = (frames, places, weights, gaps, features, measures)
    describe(solids, faces.parts, faces.faces, room, work, out, kinds, counts)
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    kept = np.arange(starts[-1]) + np.repeat(room[:-1] - starts[:-1], counts)
    return Meetings(kinds, starts, frames, places[kept], weights[kept], gaps[kept], features[kept], measures)


def touching(model: Model, faces: Faces, corners: np.ndarray, reach: float) -> Faces:
    """Those that share an area, a corner or an edge within a face, or cross with two edges. reach: [m].

    Blocks that meet edge to edge or corner to corner cannot carry force, to first order.
    """
    return faces.where(meetings(model, faces, corners).measures[:, MARGIN] > reach)


def points(
    model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: None = None
) -> tuple[MovingJoints, SpatialGeometry]:
    """Joints with contact points at the corners of their overlap, and stiffness by the area of each; not yet placed.

    Where the layout of a joint asks for more than its ends, there is one at its centre as well (`_with_centres`).
    """
    found = meetings(model, faces, corners)
    lone = found.kinds != FACES
    areas = np.where(lone, LONE * _median_face(model) * np.diff(found.starts), found.measures[:, AREA])
    shares = found.weights / (
        found.weights if not len(areas) else np.add.reduceat(found.weights, found.starts[:-1])[found.owners]
    )
    outline = np.diff(found.starts)
    if properties.profiled:
        named = properties.between(model, model.part_blocks[faces.parts])
        centred = ~lone & np.array([layout is not None for layout in properties.layouts])[named]
        found, shares = _with_centres(found, shares, centred)
    joints = joints_of(model, faces, properties, found.starts, areas, shares)
    geometry = SpatialGeometry(
        faces=faces.faces,
        features=found.features,
        kinds=found.kinds,
        corners=outline,
        axes=found.frames,
        places=found.places,
        gaps=found.gaps,
        areas=areas,
    )
    return joints, geometry


def _with_centres(found: Meetings, shares: np.ndarray, centred: np.ndarray) -> tuple[Meetings, np.ndarray]:
    """A point at the centroid of some joints, (n,) bool: area, first and polar moment of each are exact.

    Corners keep the share β of their areas and the centre gets the rest, β = polar moment / Σ w r².
    """
    owners = found.owners
    middles = found.measures[:, CENTRE : CENTRE + 3]
    arms = found.places - middles[owners]
    lumped = np.bincount(owners, found.weights * (arms**2).sum(axis=1), len(centred))
    keep = np.ones(len(centred))
    keep[centred] = found.measures[centred, POLAR] / lumped[centred]
    at = found.starts[1:][centred]
    return found._replace(
        starts=found.starts + np.concatenate([[0], np.cumsum(centred)]),
        places=np.insert(found.places, at, middles[centred], axis=0),
        weights=np.insert(found.weights * keep[owners], at, (1.0 - keep[centred]) * found.measures[centred, AREA]),
        gaps=np.insert(found.gaps, at, found.measures[centred, GAP]),
        features=np.insert(found.features, at, np.iinfo(np.int32).max),
    ), np.insert(shares * keep[owners], at, 1.0 - keep[centred])


def _median_face(model: Model) -> float:
    """Median area of all faces that can be touched [m²]."""
    areas = np.linalg.norm(face_areas(model.vertices, model.topology), axis=1)
    return float(np.median(areas[~model.inner_faces])) if len(areas) else 0.0


def place(joints: Joints, geometry: SpatialGeometry, contacts: Contacts, bodies: Bodies) -> None:
    """Gaps, frames, levers and points as they were found; blocks are where they were then."""
    owners = joints.owners
    frames = geometry.axes[owners]
    joints.frames[:], joints.points[:], contacts.gaps[:] = frames, geometry.places, geometry.gaps
    along = frames.reshape(-1, 3, 3)
    for side in (0, 1):
        arms = geometry.places - bodies.positions[joints.blocks[owners, side]]
        joints.levers[:, 9 * side : 9 * side + 9] = np.cross(arms[:, None], along).reshape(-1, 9)


def corners_of(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Corners of all parts in place [m], (n_vertices, 3)."""
    turns = matrices(orientations)[shape.corner_blocks]
    return positions[shape.corner_blocks] + (turns * shape.corner_arms[:, None, :]).sum(axis=2)


def chains_of(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> None:
    """Nothing comes back: joints in space have no profile."""


def take_over(old: SpatialGeometry, new: SpatialGeometry, match: np.ndarray) -> None:
    """Nothing: what a joint is follows from where its parts are."""


def sink(geometry: SpatialGeometry, joint: int, depth: float) -> None:
    """Nothing: only profiles have a recess."""


def microrotations(joints: Joints, geometry: SpatialGeometry) -> np.ndarray:
    """None: joints in space have no profile, (n_joints,)."""
    return np.zeros(len(joints.blocks))


def corner_shares(joints: Joints, geometry: SpatialGeometry, corners: np.ndarray) -> np.ndarray:
    """Not known. Raises UsageError: it says how normals turn with the blocks, and here they do not."""
    raise UsageError("blocks in space keep the geometry of the start: how their contact normals turn is not known")
