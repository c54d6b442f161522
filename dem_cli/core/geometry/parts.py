"""Shapes of convex parts by dimension: volumes, widths, edges, normals, faces inside compounds.

Part p has the corners vertices[part_starts[p]:part_starts[p + 1]], (n_vertices, d), and the faces of its topology.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from dem_cli.core.geometry import planar_parts, spatial_parts
from dem_cli.core.geometry.topology import Topology


class PartShapes(Protocol):
    """Interface of the modules that measure convex parts, such as geometry/planar_parts.py."""

    def volumes(self, vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
        """Compute signed volumes of parts, in the plane areas [m^d], (n_parts,)."""

    def widths(self, vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> np.ndarray:
        """Estimate the smallest width of each part [m], (n_parts,)."""

    def are_convex(
        self, vertices: np.ndarray, part_starts: np.ndarray, topology: Topology, sizes: np.ndarray
    ) -> np.ndarray:
        """Test whether each part is convex, (n_parts,) bool; sizes: of the parts [m], (n_parts,)."""

    def edges(self, topology: Topology) -> tuple[np.ndarray, np.ndarray]:
        """List both ends of each edge, (n_edges, 2), and the part that it belongs to, (n_edges,)."""

    def normals(self, vertices: np.ndarray, topology: Topology) -> np.ndarray:
        """Compute outward unit normals of the faces, (n_faces, d)."""

    def face_sizes(self, vertices: np.ndarray, topology: Topology) -> np.ndarray:
        """Compute areas, in the plane lengths, of the faces [m^(d-1)], (n_faces,)."""

    def inner_faces(
        self, vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray
    ) -> np.ndarray:
        """Faces inside a block of several parts, (n_faces,) bool; sizes: of the parts [m], (n_parts,)."""


SHAPES: dict[int, PartShapes] = {2: planar_parts, 3: spatial_parts}


def shapes_of(vertices: np.ndarray) -> PartShapes:
    """The shapes of parts whose corners are these, (n_vertices, d)."""
    return SHAPES[vertices.shape[1]]


def sizes(vertices: np.ndarray, part_starts: np.ndarray) -> np.ndarray:
    """Diagonals of the boxes around m parts [m], (m,)."""
    low = np.minimum.reduceat(vertices, part_starts[:-1], axis=0)
    high = np.maximum.reduceat(vertices, part_starts[:-1], axis=0)
    return np.hypot.reduce(high - low, axis=1)
