"""Shapes of convex parts in space: polyhedra. One of the modules of geometry/parts.py."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry import solids
from dem_cli.core.geometry.compounds import covered_faces
from dem_cli.core.geometry.polyhedron import COPLANAR
from dem_cli.core.geometry.topology import Topology


def volumes(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute the volumes of polyhedra, negative where faces look inwards."""
    return solids.properties_of_all(vertices, part_starts, topology).volume


def widths(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Narrowest extent of each polyhedron across a face: of a box its shortest side, of a slab its thickness."""
    depths, first = _depths(vertices, part_starts, topology)
    return np.minimum.reduceat(np.maximum.reduceat(depths, first), topology.part_faces[:-1])


def are_convex(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology, sizes: np.ndarray) -> np.ndarray:
    """Test whether no corner of a part lies outside of one of its faces."""
    depths, first = _depths(vertices, part_starts, topology)
    return np.minimum.reduceat(np.minimum.reduceat(depths, first), topology.part_faces[:-1]) >= -COPLANAR * sizes


def _depths(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> tuple[np.ndarray, np.ndarray]:
    """Depth of each corner of a part behind each of its faces [m], face by face; and where each face begins."""
    along = normals(vertices, topology)
    counts = np.diff(part_starts)[topology.face_parts]
    faces = np.repeat(np.arange(topology.n_faces), counts)
    upto = np.concatenate([[0], np.cumsum(counts)])
    corners = part_starts[topology.face_parts[faces]] + np.arange(upto[-1]) - upto[faces]
    on_face = vertices[topology.face_corners[topology.face_starts[:-1]]][faces]
    return ((on_face - vertices[corners]) * along[faces]).sum(axis=1), upto[:-1]


def edges(topology: Topology) -> tuple[np.ndarray, np.ndarray]:
    """List both ends of each edge of polyhedra, and its part."""
    return topology.edges[:, :2], topology.face_parts[topology.edges[:, 2]]


def normals(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute outward unit normals of the faces by Newell's sums; zero for faces without an area."""
    areas = solids.face_areas(vertices, topology)
    return solids.unit_vectors(areas, np.linalg.norm(areas, axis=1))


def inner_faces(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Find the faces inside a block of several parts."""
    areas = solids.face_areas(vertices, topology)
    return covered_faces(vertices, topology, areas, part_blocks, sizes)


def face_sizes(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute the areas of the faces [m²], (n_faces,)."""
    return np.linalg.norm(solids.face_areas(vertices, topology), axis=1)
