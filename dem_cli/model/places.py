"""Places of blocks in the undeformed structure: corners, and which block contains a point."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry.rotation import cross
from dem_cli.model.model import Model


def undeformed(model: Model) -> np.ndarray:
    """All corners in place before anything moved [m], (n_vertices, d)."""
    return model.vertices + model.centroids[model.vertex_blocks]


def block_at(model: Model, point: np.ndarray) -> int | None:
    """Number of the block that contains a point of the undeformed structure (edges count), or None."""
    vertices = undeformed(model)
    first, after = model.topology.ends.T
    edges, to_point = vertices[after] - vertices[first], point - vertices[first]
    left = cross(edges, to_point)
    size = np.hypot(*edges.T)
    inside = np.minimum.reduceat(left / size, model.topology.part_faces[:-1]) >= -1e-9 * size.max()
    found = np.flatnonzero(inside)
    return int(model.part_blocks[found[0]]) if len(found) else None
