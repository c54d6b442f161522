"""Vertices of the displaced blocks and their velocities, for files and pictures.

Positions, orientations and velocities have a row for each block, or for each block of several frames one behind the
other; corners come in the same order.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.rotation import matrices, swept
from dem_cli.core.model.copies import numbered_through, repeated
from dem_cli.core.model.model import Model


def placed_vertices(model: Model, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Compute the positions of all corners in space [m], (n_vertices, d)."""
    copies = len(positions) // model.n_blocks
    blocks = numbered_through(model.vertex_blocks, model.n_blocks, copies)
    turned = np.einsum("nij,nj->ni", matrices(orientations)[blocks], repeated(model.vertices, copies))
    return positions[blocks] + turned


def rest_vertices(model: Model) -> np.ndarray:
    """Return the corners of the undeformed structure [m], (n_vertices, d)."""
    return model.centroids[model.vertex_blocks] + model.vertices


def size_in_words(model: Model) -> str:
    """Format the bounding box of the movable blocks, undeformed: "3 m × 1.5 m"; of all blocks where none can move."""
    free = ~model.fixed
    corners = rest_vertices(model)[free[model.vertex_blocks] | ~free.any()]
    return " × ".join(f"{side:.4g} m" for side in np.ptp(corners, axis=0).tolist())


def vertex_velocities(model: Model, vertices: np.ndarray, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Compute the velocity of each corner, (n_vertices, d), from the generalised velocities of the blocks."""
    blocks = numbered_through(model.vertex_blocks, model.n_blocks, len(positions) // model.n_blocks)
    d = model.dimension
    return velocities[blocks, :d] + swept(velocities[blocks, d:], vertices - positions[blocks])


def in_space(vectors: np.ndarray) -> np.ndarray:
    """Convert vectors for VTK: three float32 components, the third one zero in 2D."""
    out = np.zeros((len(vectors), 3), dtype=np.float32)
    out[:, : vectors.shape[1]] = vectors
    return out
