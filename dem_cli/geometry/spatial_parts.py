"""Shapes of convex parts in space: polyhedra. One of the modules of geometry/parts.py."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry import solids
from dem_cli.geometry.compounds import covered_faces
from dem_cli.geometry.topology import Topology


def volumes(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Volumes, negative where faces look inwards."""
    return solids.properties_of_all(vertices, part_starts, topology).volume


def widths(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Narrowest extent across a face: of a box its shortest side, of a slab its thickness."""
    along = normals(vertices, topology)
    counts = np.diff(part_starts)[topology.face_parts]
    faces = np.repeat(np.arange(topology.n_faces), counts)
    upto = np.concatenate([[0], np.cumsum(counts)])
    corners = part_starts[topology.face_parts[faces]] + np.arange(upto[-1]) - upto[faces]
    on_face = vertices[topology.face_corners[topology.face_starts[:-1]]][faces]
    depths = ((on_face - vertices[corners]) * along[faces]).sum(axis=1)
    extents = np.maximum.reduceat(depths, upto[:-1])
    return np.minimum.reduceat(extents, topology.part_faces[:-1])


def edges(topology: Topology) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of each edge, and its part."""
    starts, counts = topology.face_starts, np.diff(topology.face_starts)
    after = np.arange(1, len(topology.face_corners) + 1)
    after[starts[1:] - 1] = starts[:-1]
    ends = np.column_stack([topology.face_corners, topology.face_corners[after]])
    once = ends[:, 0] < ends[:, 1]
    return ends[once], np.repeat(topology.face_parts, counts)[once]


def normals(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Outward unit normals of the faces, Newell's."""
    areas = solids.face_areas(vertices, topology)
    return areas / np.linalg.norm(areas, axis=1)[:, None]


def inner_faces(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Faces inside a block of several parts."""
    areas = solids.face_areas(vertices, topology)
    return covered_faces(vertices, topology, areas, part_blocks, sizes)
