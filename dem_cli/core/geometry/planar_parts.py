"""Shapes of convex parts in the plane: polygons. One of the modules of geometry/parts.py."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.compounds import inner_edges
from dem_cli.core.geometry.rotation import across
from dem_cli.core.geometry.topology import Topology


def volumes(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute the areas of polygons, negative where corners run clockwise."""
    return polygon.properties_of_all(vertices, part_starts).area


def widths(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
    """Estimate the width of each polygon as its area over the diagonal of its bounding box."""
    return volumes(vertices, part_starts, topology) / polygon.sizes(vertices, part_starts)


def are_convex(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology, sizes: np.ndarray) -> np.ndarray:
    """Test whether the corners of each polygon run counter-clockwise, once around."""
    return polygon.are_convex(vertices, part_starts)


def edges(topology: Topology) -> tuple[np.ndarray, np.ndarray]:
    """List both ends of each edge, and its part."""
    return topology.ends, topology.face_parts


def normals(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute outward unit normals of the edges of polygons."""
    first, after = topology.ends.T
    along = vertices[after] - vertices[first]
    return -across(along) / np.hypot(*along.T)[:, None]


def inner_faces(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Find the edges inside a block of several parts."""
    return inner_edges(vertices, topology, part_blocks, sizes)


def face_sizes(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute the lengths of the edges [m], (n_faces,)."""
    start, end = vertices[topology.ends].swapaxes(0, 1)
    return np.hypot(*(end - start).T)
