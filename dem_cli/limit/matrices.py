"""Equilibrium and compatibility of rigid blocks with the geometry of the start, as sparse matrices; 2D and 3D alike.

Numbering: contact point p has the d rows p·d … p·d + d − 1, its normal first, then its tangents.
Columns are the free degrees of freedom: block by block, translations first, then rotations; fixed blocks have none.

    w = B u                          motion of b against a at every point: opening (positive), then slides
    Bᵀ r + dead + λ live = 0         equilibrium, r: normal force N (compression positive), then shear force T

The force on block b is N n + T t (n: unit normal from a to b, t: tangents; 2D: n turned by +90°), that on a
the opposite, as in kernels/contact_forces.py. Both are one statement: for any u that leaves the supports
alone, r · (B u) = −(dead + λ live) · u.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from dem_cli.contact.detect import block_shape
from dem_cli.kernels.records import Joints
from dem_cli.model.model import Model
from dem_cli.model.scales import own_weights


class Structure(NamedTuple):
    """A structure as limit analysis sees it: matrices, loads, and what makes their numbers comparable."""

    model: Model
    joints: Joints
    free: np.ndarray  # free degrees of freedom in the flattened (n_blocks, n_dof), (n_free,) int64
    compatibility: csr_matrix  # B, (n_points·d, n_free)
    dead: np.ndarray  # dead loads of the free degrees of freedom [N, N m], (n_free,)
    live: np.ndarray  # per unit of the user's multiplier [N, N m], (n_free,)
    scales: np.ndarray  # own weight of the block, times its radius for moments [N, N m], (n_free,)

    @property
    def n_dof(self) -> int:
        """Degrees of freedom of a block."""
        return self.model.dead_loads.shape[1]

    def on_blocks(self, values: np.ndarray) -> np.ndarray:
        """Values at free degrees of freedom as an array of all blocks, zero elsewhere, (n_blocks, n_dof)."""
        whole = np.zeros(self.model.n_blocks * self.n_dof)
        whole[self.free] = values
        return whole.reshape(-1, self.n_dof)

    def imbalance(self, reactions: np.ndarray, multiplier: float) -> np.ndarray:
        """What is missing to equilibrium, over the own weight of the block (times its radius), (n_free,).

        reactions: N and T at every point [N], (n_points·d,).
        """
        return (self.compatibility.T @ reactions + self.dead + multiplier * self.live) / self.scales


def structure_of(model: Model, joints: Joints) -> Structure:
    """Matrices and loads of a model whose joints are those of the start (contact.start.joints_of_start)."""
    d, n_dof = model.dimension, model.dead_loads.shape[1]
    blocks = np.flatnonzero(~model.fixed)
    free = (blocks[:, None] * n_dof + np.arange(n_dof)).ravel()
    dead, live = model.dead_loads[blocks], model.live_loads[blocks]
    scales = np.repeat(own_weights(dead, live, d)[:, None], n_dof, axis=1) if len(blocks) else np.zeros((0, n_dof))
    scales[:, d:] *= block_shape(model).radii[blocks, None]
    return Structure(
        model, joints, free, compatibility(model, joints), dead.ravel().copy(), live.ravel().copy(), scales.ravel()
    )


def compatibility(model: Model, joints: Joints) -> csr_matrix:
    """B: from the free degrees of freedom to the motion of b against a at every point, (n_points·d, n_free)."""
    d, n_dof = model.dimension, model.dead_loads.shape[1]
    rows = relative_motion(joints, d)
    n_points = len(rows)
    owner = np.repeat(np.arange(len(joints.blocks)), np.diff(joints.starts))
    column = np.full(model.n_blocks, -1)
    column[~model.fixed] = np.arange(int((~model.fixed).sum())) * n_dof
    first = column[joints.blocks[owner]]
    columns = np.where(first[:, :, None] < 0, -1, first[:, :, None] + np.arange(n_dof))
    columns = np.broadcast_to(columns[:, None], rows.shape)
    used = (columns >= 0) & (rows != 0.0)
    counts = used.reshape(n_points * d, 2 * n_dof).sum(axis=1)
    starts = np.concatenate([[0], np.cumsum(counts)])
    shape = (n_points * d, int((~model.fixed).sum()) * n_dof)
    matrix = csr_matrix((rows[used], columns[used], starts), shape=shape)
    matrix.sort_indices()
    return matrix


def relative_motion(joints: Joints, dimension: int) -> np.ndarray:
    """∂(motion of b against a)/∂(motion of a, of b), (n_points, d directions, 2 blocks, n_dof)."""
    d = dimension
    frames = directions(joints, d)
    n_points = len(frames)
    levers = joints.levers.reshape(n_points, 2, d, joints.levers.shape[1] // (2 * d)).swapaxes(1, 2)
    one = np.concatenate([np.repeat(frames[:, :, None], 2, axis=2), levers], axis=3)
    return one * np.array([-1.0, 1.0])[:, None]


def directions(joints: Joints, dimension: int) -> np.ndarray:
    """Unit normal and tangents of every point, (n_points, d, d); in 2D only normals are stored."""
    if dimension == 2:
        normals = joints.frames[:, :2]
        return np.stack([normals, normals[:, ::-1] * [-1.0, 1.0]], axis=1)
    return joints.frames.reshape(-1, dimension, dimension)
