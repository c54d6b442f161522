"""Contact points of pairs of convex polyhedra in space, before there are joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.joints import Faces
from dem_cli.core.geometry.polygon import following
from dem_cli.core.geometry.solids import face_areas, unit_vectors
from dem_cli.core.kernels.records import FACES, Polyhedra
from dem_cli.core.kernels.spatial_geometry import AREA, MARGIN, describe
from dem_cli.core.model.model import Model


class Meetings(NamedTuple):
    """Contact points of pairs of parts, before there are joints; a pair owns points starts[j]:starts[j + 1]."""

    kinds: np.ndarray  # as SpatialGeometry.kinds, (n,)
    starts: np.ndarray  # (n + 1,)
    frames: np.ndarray  # unit normal from a to b, then tangents, (n, 9)
    places: np.ndarray  # [m], (n_points, 3)
    weights: np.ndarray  # area of each point of face joints [m²], else 1, (n_points,)
    gaps: np.ndarray  # [m], (n_points,)
    features: np.ndarray  # what each point is, (n_points,)
    measures: np.ndarray  # columns as in kernels/spatial_geometry.py, (n, 8)

    @property
    def owners(self) -> np.ndarray:
        """Pair of each point, (n_points,)."""
        return np.repeat(np.arange(len(self.kinds)), np.diff(self.starts))

    @property
    def widths(self) -> np.ndarray:
        """Width of each contact [m], (n,): of faces twice the overlap area over its perimeter; of lone contacts their
        reach.
        """
        sides = np.linalg.norm(self.places[following(self.starts)] - self.places, axis=1)
        perimeters, lone = np.bincount(self.owners, sides, len(self.kinds)), self.kinds != FACES
        return np.where(lone, self.measures[:, MARGIN], 2.0 * self.measures[:, AREA] / np.where(lone, 1.0, perimeters))


def polyhedra(model: Model, corners: np.ndarray) -> Polyhedra:
    """Collect the parts of a model in place, as the kernels read them; corners: as `corners_of`."""
    topology = model.topology
    areas = face_areas(corners, topology)
    normals = unit_vectors(areas, np.linalg.norm(areas, axis=1))
    return Polyhedra(
        np.ascontiguousarray(corners), model.part_starts, topology.part_faces, topology.face_starts,
        topology.face_corners, normals, topology.part_edges, topology.edges, model.parts.sizes,
    )  # fmt: skip


def room_of(solids: Polyhedra) -> np.ndarray:
    """Allocate work space for the overlap of any two faces, as kernels/overlap.py reads it."""
    return np.zeros((5, 2 * int(np.diff(solids.face_starts).max(initial=0)) + 2, 3))


def meetings(model: Model, faces: Faces, corners: np.ndarray) -> Meetings:
    """Compute the contact points of pairs of parts where these are now."""
    solids = polyhedra(model, corners)
    n, sizes = len(faces.parts), np.diff(solids.face_starts)
    room = np.concatenate([[0], np.cumsum(sizes[faces.faces].sum(axis=1))]).astype(np.int64)
    work = room_of(solids)
    frames, measures = np.zeros((n, 9)), np.zeros((n, 8))
    places, weights, gaps = np.zeros((room[-1], 3)), np.zeros(room[-1]), np.zeros(room[-1])
    features, kinds, counts = np.zeros(room[-1], np.int64), np.zeros(n, np.int8), np.zeros(n, np.int64)
    out = (frames, places, weights, gaps, features, measures)
    describe(solids, faces.parts, faces.faces, room, work, out, kinds, counts)
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    kept = np.arange(starts[-1]) + np.repeat(room[:-1] - starts[:-1], counts)
    return Meetings(kinds, starts, frames, places[kept], weights[kept], gaps[kept], features[kept], measures)
