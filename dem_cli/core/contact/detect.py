"""Contact detection: which faces of which blocks touch or may soon touch, from the corners of the blocks."""

from __future__ import annotations

import numpy as np

from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.joints import Faces
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.kernels.records import BlockShapes, Bodies
from dem_cli.core.model.model import Model


def block_shape(model: Model) -> BlockShapes:
    """Collect the constant geometry of the blocks that the kernels read."""
    inertias = np.where(model.held[:, model.rotations], 0.0, model.inertias)
    axes = matrices(model.principal_axes).reshape(-1, 9)
    stiffness = model.mode_stiffness if model.n_modes else np.zeros((model.n_blocks, 0))
    return BlockShapes(
        model.vertex_blocks, np.ascontiguousarray(model.vertices), model.shapes.radii, inertias, axes, stiffness,
        model.mode_shapes.reshape(len(model.mode_shapes), 72),
    )  # fmt: skip


def world_corners(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Compute corners of all parts in world coordinates [m], (n_vertices, d)."""
    return geometry_of(positions.shape[1]).corners_of(shape, positions, orientations)


def strained_corners(shape: BlockShapes, bodies: Bodies) -> np.ndarray:
    """Compute corners of blocks that deform, by their gradients [m], (n_vertices, d)."""
    d = bodies.positions.shape[1]
    gradients = bodies.gradients.reshape(-1, d, d)[shape.corner_blocks]
    return bodies.positions[shape.corner_blocks] + np.einsum("vij,vj->vi", gradients, shape.corner_arms)


def find_joints(model: Model, corners: np.ndarray, reach: float) -> Faces:
    """Find all pairs of faces of different blocks that are closer than `reach` [m]; corners: as `world_corners`."""
    return geometry_of(model.dimension).find(model, corners, reach)
