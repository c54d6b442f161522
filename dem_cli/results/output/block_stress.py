"""Mean stress of blocks from the forces at their contact points, and its principal values.

In equilibrium V σ = Σ f ⊗ x over all forces on the surface of a block (Love 1927); weight acts evenly and adds nothing
about the centroid. Loads at points of a block are not among contact forces: a block that has any lacks their share.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.model.copies import repeated
from dem_cli.core.model.model import Model
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
    total *= repeated(0.5 / (model.shapes.volumes * model.thickness), copies)[:, None, None]
    total[repeated(model.fixed, copies)] = 0.0
    return total + total.swapaxes(1, 2)


def principal_values(stresses: np.ndarray) -> np.ndarray:
    """Compute principal values of symmetric tensors (n, d, d), the largest tension first, (n, d)."""
    return diagonalised(stresses)[0][:, ::-1]
