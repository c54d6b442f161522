"""VTK cells of convex parts: polygons in the plane; in space tetrahedra, pyramids, wedges, hexahedra, prisms, hulls.

What is none of these goes as a convex point set, which VTK 9.3 to 9.7 read alike and show with its faces in triangles;
a VTKHDF file with polyhedra ends VTK before 9.6. Order of corners: VTK File Formats, "Linear cell types".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import JointPlaces

_VERTEX, _LINE, _POLY_LINE, _POLYGON, CONVEX_POINT_SET = 1, 3, 4, 7, 41
_PYRAMIDS = {3: 10, 4: 14}  # cell types by the sides of the base: tetrahedron, pyramid
_PRISMS = {3: 13, 4: 12, 5: 15, 6: 16}  # wedge, hexahedron, pentagonal and hexagonal prism


class Cells(NamedTuple):
    """Convex parts as VTK cells; cell c has the corners[starts[c]:starts[c + 1]]."""

    types: np.ndarray  # as VTK numbers them, (n_cells,) uint8
    starts: np.ndarray  # (n_cells + 1,) int64
    corners: np.ndarray  # numbers of the corners as a cell of its type has them, int64


def polygons(starts: np.ndarray) -> Cells:
    """Create polygon cells with the corners starts[c]:starts[c + 1] of all points."""
    return Cells(np.full(len(starts) - 1, _POLYGON, np.uint8), starts.astype(np.int64), np.arange(starts[-1]))


def lines(starts: np.ndarray) -> Cells:
    """Create line cells through the points starts[c]:starts[c + 1] of all points."""
    return Cells(np.full(len(starts) - 1, _POLY_LINE, np.uint8), starts.astype(np.int64), np.arange(starts[-1]))


def outlines_of_joints(places: JointPlaces) -> Cells:
    """Create the cells of joints as drawn: in the plane lines, in space polygons, lines and single points."""
    starts = places.starts if len(places.starts) else 2 * np.arange(len(places.area) + 1)
    types = np.array([_POLYGON, _VERTEX, _LINE], np.uint8)
    counts = np.diff(starts)
    return Cells(types[np.where(counts > 2, 0, counts)], starts.astype(np.int64), np.arange(starts[-1]))


def cells_of(model: Model) -> Cells:
    """Create one VTK cell for each convex part."""
    if not len(model.face_starts):
        return polygons(model.part_starts)
    topology, firsts = model.topology, model.part_starts
    known: dict[tuple[bytes, bytes], tuple[int, np.ndarray]] = {}  # many parts have the same faces
    types, orders = np.zeros(model.n_parts, np.uint8), []
    for p in range(model.n_parts):
        first, after = topology.part_faces[p], topology.part_faces[p + 1]
        ends = topology.face_starts[first : after + 1]
        corners = topology.face_corners[ends[0] : ends[-1]] - firsts[p]
        key = (ends - ends[0]).tobytes(), corners.tobytes()
        if key not in known:
            known[key] = cell(np.split(corners, ends[1:-1] - ends[0]), int(firsts[p + 1] - firsts[p]))
        types[p], order = known[key]
        orders.append(firsts[p] + order)
    return Cells(types, firsts.astype(np.int64), np.concatenate(orders))


def outlines(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Return the polygons that bound the convex parts, in space their faces: starts, and corners."""
    if not len(model.face_starts):
        return model.part_starts, np.arange(len(model.vertices))
    return model.face_starts, model.face_corners


def cell(faces: list[np.ndarray], n_corners: int) -> tuple[int, np.ndarray]:
    """Return the VTK type of a polyhedron and its corners in the order of that type."""
    for base in faces:
        sides = len(base)
        if n_corners == len(faces) == sides + 1 and sides in _PYRAMIDS:
            apex = np.setdiff1d(np.arange(n_corners), base)
            return _PYRAMIDS[sides], np.concatenate([base[::-1], apex])
        if n_corners == 2 * sides and len(faces) == sides + 2 and sides in _PRISMS:
            over = _over(base, faces)
            if over is not None:
                ring = base[::-1]  # seen from inside, that of wedges too, whatever VTK's page on them says
                return _PRISMS[sides], np.concatenate([ring, [over[corner] for corner in ring]])
    return CONVEX_POINT_SET, np.arange(n_corners)


def _over(base: np.ndarray, faces: list[np.ndarray]) -> dict[int, int] | None:
    """Find the opposite corners of a prism over its base; None where a side has not four corners."""
    found = {}
    edges = set(zip(np.roll(base, -1).tolist(), base.tolist()))  # as the sides run along them
    for face in faces:
        ring = face.tolist()
        for k, edge in enumerate(zip(ring, ring[1:] + ring[:1])):
            if edge in edges:
                if len(ring) != 4:
                    return None
                found[edge[1]] = ring[(k + 2) % 4]
    return found
