"""Mean stress of blocks from the forces on them, and its principal values.

In equilibrium V σ = Σ f ⊗ x over all forces on a block: at contact points, loads at points, ties and bars (Love 1927).
Weight acts evenly and adds nothing about the centroid. Of a block with bars it is the mean of its stone.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.model.copies import repeated
from dem_cli.core.model.model import Model
from dem_cli.core.model.uniform_strain import tensors
from dem_cli.core.records.frames import Frame, FrameStack


def mean_stresses(model: Model, frame: Frame | FrameStack) -> np.ndarray:
    """Compute the mean stress of each block in global axes, tension positive [Pa], (n_blocks, d, d); 0 of fixed blocks.

    Of a stack of frames those of all of them, (n_frames · n_blocks, d, d).
    """
    contacts, d, n = frame.contacts, model.dimension, len(frame.positions)
    copies = n // model.n_blocks
    forces, total = contacts.forces(), np.zeros((n, d, d))
    for side, sign in ((0, -1.0), (1, 1.0)):
        blocks = contacts.blocks[:, side]
        dyads = sign * forces[:, :, None] * (contacts.points - frame.positions[blocks])[:, None, :]
        for i, j in np.ndindex(d, d):
            total[:, i, j] += np.bincount(blocks, dyads[:, i, j], n)
    if frame.first_moments is not None:
        total += tensors(frame.first_moments)
    total *= repeated(0.5 / (model.shapes.volumes * model.thickness), copies)[:, None, None]
    total[repeated(model.fixed, copies)] = 0.0
    return total + total.swapaxes(1, 2)


def principal_values(stresses: np.ndarray) -> np.ndarray:
    """Compute principal values of symmetric tensors (n, d, d), the largest tension first, (n, d)."""
    return diagonalised(stresses)[0][:, ::-1]
