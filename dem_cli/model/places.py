"""Places of blocks in the undeformed structure: corners, and which block contains a point."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry.parts import shapes_of
from dem_cli.model.model import Model


def undeformed(model: Model) -> np.ndarray:
    """All corners in place before anything moved [m], (n_vertices, d)."""
    return model.vertices + model.centroids[model.vertex_blocks]


def block_at(model: Model, point: np.ndarray) -> int | None:
    """Number of the block that contains a point of the undeformed structure (edges count), or None."""
    found = blocks_at(model, point)
    return int(found[0]) if len(found) else None


def blocks_at(model: Model, point: np.ndarray) -> np.ndarray:
    """Numbers of all blocks that contain a point of the undeformed structure (edges count), each once, ascending."""
    vertices, topology = undeformed(model), model.topology
    normals = shapes_of(vertices).normals(vertices, topology)
    depths = ((vertices[topology.face_corners[topology.face_starts[:-1]]] - point) * normals).sum(axis=1)
    inside = np.minimum.reduceat(depths, topology.part_faces[:-1]) >= -1e-9 * model.parts.sizes.max()
    return np.unique(model.part_blocks[np.flatnonzero(inside)])
