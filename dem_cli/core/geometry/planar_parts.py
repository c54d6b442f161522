"""Shapes of convex parts in the plane: polygons. One of the modules of geometry/parts.py."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.compounds import inner_edges
from dem_cli.core.geometry.rotation import across
from dem_cli.core.geometry.topology import Topology


def volumes(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Areas, negative where corners run clockwise."""
    return polygon.properties_of_all(vertices, part_starts).area


def widths(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Area over the diagonal of the box."""
    return volumes(vertices, part_starts, topology) / polygon.sizes(vertices, part_starts)


def are_convex(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology, sizes: np.ndarray) -> np.ndarray:
    """Whether corners run counter-clockwise, once around."""
    return polygon.are_convex(vertices, part_starts)


def edges(topology: Topology) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of each edge, and its part."""
    return topology.ends, topology.face_parts


def normals(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Outward unit normals of the edges."""
    first, after = topology.ends.T
    along = vertices[after] - vertices[first]
    return -across(along) / np.hypot(*along.T)[:, None]


def inner_faces(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Edges inside a block of several parts."""
    return inner_edges(vertices, topology, part_blocks, sizes)


def face_sizes(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Lengths of the edges [m], (n_faces,)."""
    start, end = vertices[topology.ends].swapaxes(0, 1)
    return np.hypot(*(end - start).T)
