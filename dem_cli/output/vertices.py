"""Vertices of the blocks in space and their velocities, for files and pictures."""

from __future__ import annotations

import numpy as np

from dem_cli.model.model import Model


def vertex_blocks(model: Model) -> np.ndarray:
    """Block of each corner, (n_vertices,)."""
    return np.repeat(model.part_blocks, np.diff(model.part_starts))


def rotations(orientations: np.ndarray) -> np.ndarray:
    """Rotation matrices: (n, 1) angles -> (n, 2, 2); (n, 4) unit quaternions (scalar first) -> (n, 3, 3)."""
    if orientations.shape[1] == 1:
        c, s = np.cos(orientations[:, 0]), np.sin(orientations[:, 0])
        return np.stack((np.stack((c, -s), axis=1), np.stack((s, c), axis=1)), axis=1)
    w, x, y, z = orientations.T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def rest_orientations(model: Model) -> np.ndarray:
    """Orientations of the undeformed structure."""
    if model.dimension == 2:
        return np.zeros((model.n_blocks, 1))
    return np.tile((1.0, 0.0, 0.0, 0.0), (model.n_blocks, 1))


def placed_vertices(model: Model, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Corners in space [m], (n_vertices, d)."""
    blocks = vertex_blocks(model)
    turned = np.einsum("nij,nj->ni", rotations(orientations)[blocks], model.vertices)
    return positions[blocks] + turned


def rest_vertices(model: Model) -> np.ndarray:
    """Corners of the undeformed structure [m], (n_vertices, d)."""
    return model.centroids[vertex_blocks(model)] + model.vertices


def vertex_velocities(model: Model, vertices: np.ndarray, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Velocity of each corner, (n_vertices, d), from the generalised velocities of the blocks."""
    blocks, d = vertex_blocks(model), model.dimension
    arms = vertices - positions[blocks]
    linear, spins = velocities[blocks, :d], velocities[blocks, d:]
    if d == 2:
        return linear + spins * np.stack((-arms[:, 1], arms[:, 0]), axis=1)
    return linear + np.cross(spins, arms)


def in_space(vectors: np.ndarray) -> np.ndarray:
    """Vectors as VTK wants them: three float32 components, the third one zero in 2D."""
    out = np.zeros((len(vectors), 3), dtype=np.float32)
    out[:, : vectors.shape[1]] = vectors
    return out
