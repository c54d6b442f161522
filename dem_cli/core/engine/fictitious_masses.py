"""Fictitious masses: the largest stable pseudo-step becomes one for every degree of freedom."""

from __future__ import annotations

import numpy as np

from dem_cli.core.contact.compatibility import relative_motion, strain_motion
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.kernels.records import BlockShapes, Bodies, Joints
from dem_cli.core.links.link import Springs
from dem_cli.core.links.matrices import gershgorin
from dem_cli.core.model.model import Model


def fictitious_masses(
    model: Model,
    joints: Joints,
    bodies: Bodies,
    shape: BlockShapes,
    safety: float,
    inverse_out: np.ndarray,
    free_fall: float = DEFAULT.relaxation.free_fall,
    links: Springs | None = None,
) -> None:
    """Compute inverse masses for a pseudo-step of one, into inverse_out (n_blocks, n_dof); 0 for fixed blocks and
    restrained motions.

    M_i = 1/(4 s²) Σ_c k_c (|b_ci|/w_i) Σ_j |b_cj| w_j with w = 1 for translations and 1/r for rotations
    (Gershgorin's bound of the highest eigenfrequency in the metric w; s: safety). Where blocks turn in space, all three
    rotations of one have the largest of their masses. Modes of blocks that deform are further columns, with their own
    stiffness; 0 where a block has none. links: springs beside those of the joints.
    """
    rows = relative_motion(joints, model.dimension)
    if model.n_modes:
        rows = np.concatenate([rows, strain_motion(model, joints, bodies)], axis=3)
    rows = np.abs(rows)
    blocks = joints.blocks[joints.owners]
    weights = np.ones(inverse_out.shape)
    weights[:, model.rotations] = 1.0 / shape.radii[:, None]
    free = np.broadcast_to(~model.fixed[:, None], inverse_out.shape).copy()
    free[:, : model.rotations.stop] &= ~model.held
    free[:, model.rotations.stop :] &= shape.mode_stiffness > 0.0
    reach = np.zeros(rows.shape[:2])
    for side in (0, 1):
        reach += (rows[:, :, side] * (weights * free)[blocks[:, side]][:, None, :]).sum(axis=2)
    stiffness = np.stack([joints.kn, *[joints.ks] * (model.dimension - 1)], axis=1)
    masses = np.zeros_like(inverse_out)
    for side in (0, 1):
        share = (rows[:, :, side] * (stiffness * reach)[:, :, None]).sum(axis=1)
        np.add.at(masses, blocks[:, side], share / weights[blocks[:, side]])
    if links is not None:
        masses += gershgorin(links, weights, model.fixed)
    if bodies.orientations.shape[1] > model.inertias.shape[1]:  # quaternions: the block turns under its axes
        masses[:, model.rotations] = masses[:, model.rotations].max(axis=1, keepdims=True)
    masses[:, model.rotations.stop :] += shape.mode_stiffness
    masses /= 4.0 * safety**2
    # Blocks that touch nothing now: as heavy as a typical block that does, or falling slowly.
    for k in range(masses.shape[1]):
        lonely = masses[:, k] <= 0.0
        if not lonely.any():
            continue
        if lonely.all():
            weights = np.maximum(np.abs(model.dead_loads).max(axis=1), 1e-300)
            masses[:, k] = weights / (free_fall * shape.radii) * (1.0 if k < model.dimension else shape.radii**2)
        else:
            masses[lonely, k] = np.median(masses[~lonely, k])
    inverse_out[:] = 1.0 / masses
    inverse_out[~free] = 0.0
