"""First moments of forces at points of blocks, Σ f ⊗ x about the centroid: their part of the mean stress, as volume.

In equilibrium the mean stress of a block is 1/V times the symmetric part of Σ f ⊗ x over all forces on it, wherever
they act (divergence theorem; Love 1927). Weight acts evenly and adds nothing about the centroid.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.model.uniform_strain import components


def first_moments(arms: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Compute symmetric parts of f ⊗ x, components as those of stresses [N m], (n, 3 or 6); arms, forces: (n, d)."""
    dyads = 0.5 * forces[:, :, None] * arms[:, None, :]
    return components(dyads + dyads.swapaxes(1, 2))


def summed(n_blocks: int, blocks: np.ndarray, arms: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Sum first moments of forces (n, d) at arms (n, d) by the block they act on [N m], (n_blocks, 3 or 6)."""
    found = first_moments(arms, forces)
    return np.column_stack([np.bincount(blocks, column, n_blocks) for column in found.T])


def of_loads(model: Model, orientations: np.ndarray, dead: float, live: float) -> np.ndarray | None:
    """Sum the first moments of loads at points [N m], (n_blocks, 3 or 6); None: there are no such loads.

    orientations: of all blocks, as Frame has them; dead, live: share of the dead loads and multiplier of the live ones.
    """
    if not len(model.dead_first_moments):
        return None
    total = dead * model.dead_first_moments + live * model.live_first_moments
    if (following := model.following) is not None:
        factors = np.where(following.dead, dead, live)[:, None]
        for arms, forces, sign in (
            (*following.now(orientations), 1.0), (following.arms, following.forces, -1.0)
        ):  # fmt: skip
            total += sign * summed(model.n_blocks, following.blocks, arms, factors * forces)
    return total
