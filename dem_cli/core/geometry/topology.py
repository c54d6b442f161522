"""Topology of convex parts: their faces, and the corners of each face, as compressed sparse rows (CSR).

In the plane a part has as many faces as corners, and face k has the two corners k and the next one around: edges and
faces are one thing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.polyhedron import Polyhedron


@dataclass(frozen=True, eq=False)
class Topology:
    """Faces of convex parts and the corners of each face."""

    part_faces: np.ndarray  # part p has the faces part_faces[p]:part_faces[p + 1], (n_parts + 1,) int64
    face_starts: np.ndarray  # face f has face_corners[face_starts[f]:face_starts[f + 1]], (n_faces + 1,) int64
    face_corners: np.ndarray  # in the plane both ends of an edge, in space around the face seen from outside, int64

    @property
    def n_faces(self) -> int:
        """Number of faces of all parts."""
        return len(self.face_starts) - 1

    @cached_property
    def face_parts(self) -> np.ndarray:
        """Part of each face, (n_faces,)."""
        return np.repeat(np.arange(len(self.part_faces) - 1), np.diff(self.part_faces))

    @cached_property
    def ends(self) -> np.ndarray:
        """First and last corner of each face, (n_faces, 2): in the plane the ends of the edge."""
        return np.column_stack([self.face_corners[self.face_starts[:-1]], self.face_corners[self.face_starts[1:] - 1]])

    @cached_property
    def sides(self) -> np.ndarray:
        """Sides of all faces, one after the other around each: its corner, the next one, and its face, (n, 3)."""
        after = np.arange(1, len(self.face_corners) + 1)
        after[self.face_starts[1:] - 1] = self.face_starts[:-1]
        faces = np.repeat(np.arange(self.n_faces), np.diff(self.face_starts))
        return np.column_stack([self.face_corners, self.face_corners[after], faces])

    @cached_property
    def edges(self) -> np.ndarray:
        """Edges of polyhedra: two corners, the face that goes along and the one that goes back, (n_edges, 4)."""
        there = self.sides[self.sides[:, 0] < self.sides[:, 1]]
        back = self.sides[self.sides[:, 0] > self.sides[:, 1]]
        there = there[np.lexsort((there[:, 1], there[:, 0]))]
        back = back[np.lexsort((back[:, 0], back[:, 1]))]
        return np.column_stack([there, back[:, 2]])

    @cached_property
    def part_edges(self) -> np.ndarray:
        """Ranges of the edges of parts, (n_parts + 1,): part p has the edges part_edges[p]:part_edges[p + 1]."""
        parts = self.face_parts[self.edges[:, 2]]
        return np.searchsorted(parts, np.arange(len(self.part_faces)))


def topology_of_polygons(part_starts: np.ndarray) -> Topology:
    """Build the topology of polygons with the corners part_starts[p]:part_starts[p + 1]: face k starts at corner k."""
    n = int(part_starts[-1])
    corners = np.column_stack([np.arange(n), polygon.following(part_starts)])
    return Topology(np.asarray(part_starts, np.int64), np.arange(0, 2 * n + 1, 2), corners.ravel())


def topology_of_polyhedra(solids: Sequence[Polyhedron]) -> Topology:
    """Build the topology of polyhedra whose corners follow each other in one array; equal `faces` are done once."""
    kinds: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for solid in solids:
        if id(solid.faces) not in kinds:
            kinds[id(solid.faces)] = np.array([len(face) for face in solid.faces]), np.concatenate(solid.faces)
    sizes, corners = ([kinds[id(solid.faces)][i] for solid in solids] for i in (0, 1))
    shift = np.cumsum([0] + [len(solid.vertices) for solid in solids])[:-1]
    part_faces = np.cumsum([0] + [len(each) for each in sizes])
    face_starts = np.concatenate([[0], np.cumsum(np.concatenate(sizes))])
    face_corners = np.concatenate(corners) + np.repeat(shift, [len(each) for each in corners])
    return Topology(*(each.astype(np.int64) for each in (part_faces, face_starts, face_corners)))
