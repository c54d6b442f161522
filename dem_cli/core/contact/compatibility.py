"""Compatibility matrix B: from the motion of the blocks to the relative motion at every contact point.

    w = B u        motion of b against a at every point: along its normal (opening, positive), then along its tangents

One copy for limit analysis, natural frequencies, fictitious masses and the elastic path; 2D and 3D alike. A point has
d rows, its normal first. Columns are degrees of freedom: block by block, translations first, then rotations; as a
sparse matrix, those of free blocks alone, of which those that restraints hold are empty. Modes of blocks that deform,
where they are asked for, come behind the rotations of their block. The transpose gives the forces on the blocks from
those at the points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.geometry.rotation import frames
from dem_cli.core.kernels.records import Bodies, Joints
from dem_cli.core.model.model import Model
from dem_cli.core.model.quadratic_modes import displacements
from dem_cli.core.model.uniform_strain import rotated_basis

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def directions(joints: Joints, dimension: int) -> np.ndarray:
    """Compute unit normal and tangents of every contact point, (n_points, d, d)."""
    return frames(joints.frames, dimension)


def relative_motion(joints: Joints, dimension: int) -> np.ndarray:
    """Compute ∂(motion of b against a)/∂(motion of a, of b), (n_points, d directions, 2 blocks, n_dof)."""
    d = dimension
    along = directions(joints, d)
    n_points = len(along)
    levers = joints.levers.reshape(n_points, 2, d, joints.levers.shape[1] // (2 * d)).swapaxes(1, 2)
    one = np.concatenate([np.repeat(along[:, :, None], 2, axis=2), levers], axis=3)
    return one * np.array([-1.0, 1.0])[:, None]


def held_motions(model: Model, strains: bool) -> np.ndarray:
    """Find degrees of freedom that loads do not change, (n_blocks, n_dof) bool; strains: with modes of blocks."""
    return np.column_stack([model.held, model.mode_stiffness == 0.0]) if strains else model.held


def free_columns(model: Model, joints: Joints, strains: bool = False) -> np.ndarray:
    """Number the column of each degree of freedom of both blocks of every point, −1: held, (n_points, 2 blocks, n_dof).

    strains: as `held_motions`.
    """
    held = held_motions(model, strains)
    n_dof = held.shape[1]
    column = np.full(model.n_blocks, -1)
    column[~model.fixed] = np.arange(int((~model.fixed).sum())) * n_dof
    blocks = joints.blocks[joints.owners]
    return np.where(held[blocks], -1, column[blocks][:, :, None] + np.arange(n_dof))


def compatibility(model: Model, joints: Joints, strained: Bodies | None = None) -> csr_matrix:
    """Build the compatibility matrix B from free degrees of freedom to motion of b against a, (n_points·d, n_free).

    strained: blocks that deform, as they are now, whose modes are further columns; None: all blocks are rigid.
    """
    from scipy.sparse import csr_matrix

    rows = relative_motion(joints, model.dimension)
    if strained is not None:
        rows = np.concatenate([rows, strain_motion(model, joints, strained)], axis=3)
    n_points, d, _, n_dof = rows.shape
    columns = np.broadcast_to(free_columns(model, joints, strained is not None)[:, None], rows.shape)
    used = (columns >= 0) & (rows != 0.0)
    counts = used.reshape(n_points * d, 2 * n_dof).sum(axis=1)
    starts = np.concatenate([[0], np.cumsum(counts)])
    shape = (n_points * d, int((~model.fixed).sum()) * n_dof)
    matrix = csr_matrix((rows[used], columns[used], starts), shape=shape)
    matrix.sort_indices()
    return matrix


def strain_motion(model: Model, joints: Joints, bodies: Bodies) -> np.ndarray:
    """Derivatives ∂(motion of b against a)/∂(amplitudes of a, of b) where blocks deform, (n_points, d, 2 blocks, m)."""
    d, blocks = model.dimension, joints.blocks[joints.owners]
    arms = joints.points[:, None] - bodies.positions[blocks]
    turned = rotated_basis(bodies.gradients.reshape(-1, d, d))[blocks]
    moved = np.einsum("psmij,psj->psmi", turned, arms) / model.shapes.radii[blocks][:, :, None, None]
    if len(model.mode_shapes):
        moved = np.concatenate([moved, displacements(model.mode_shapes[blocks], arms, bodies.turns[blocks])], axis=2)
    along = np.einsum("pki,psmi->pksm", directions(joints, d), moved)
    return along * np.array([-1.0, 1.0])[:, None]
