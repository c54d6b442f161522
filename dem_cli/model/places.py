"""Which block is where."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry import polygon
from dem_cli.model.model import Model


def undeformed(model: Model) -> np.ndarray:
    """All corners in place before anything moved [m], (n_vertices, d)."""
    return model.vertices + model.centroids[np.repeat(model.part_blocks, np.diff(model.part_starts))]


def block_at(model: Model, point: np.ndarray) -> int | None:
    """Number of the block that contains a point of the undeformed structure (edges count), or None."""
    starts, vertices = model.part_starts, undeformed(model)
    edges, to_point = vertices[polygon.following(starts)] - vertices, point - vertices
    left = edges[:, 0] * to_point[:, 1] - edges[:, 1] * to_point[:, 0]
    size = np.hypot(*edges.T)
    inside = np.minimum.reduceat(left / size, starts[:-1]) >= -1e-9 * size.max()
    found = np.flatnonzero(inside)
    return int(model.part_blocks[found[0]]) if len(found) else None
