"""Detection: which faces of which blocks touch or may soon touch, and the corners of the blocks that it looks at."""

from __future__ import annotations

import numpy as np

from dem_cli.contact.geometry import geometry_of
from dem_cli.contact.joints import Faces
from dem_cli.geometry.rotation import matrices
from dem_cli.kernels.records import BlockShapes
from dem_cli.model.model import Model


def block_shape(model: Model) -> BlockShapes:
    """The constant geometry that the kernels read."""
    inertias = np.where(model.fixed[:, None], 0.0, model.inertias)
    axes = matrices(model.principal_axes).reshape(-1, 9)
    return BlockShapes(model.vertex_blocks, np.ascontiguousarray(model.vertices), model.shapes.radii, inertias, axes)


def world_corners(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Corners of all parts in place [m], (n_vertices, d)."""
    return geometry_of(positions.shape[1]).corners_of(shape, positions, orientations)


def find_joints(model: Model, corners: np.ndarray, reach: float) -> Faces:
    """All pairs of faces of different blocks that are closer than `reach` [m]; corners: as `world_corners`."""
    return geometry_of(model.dimension).find(model, corners, reach)
