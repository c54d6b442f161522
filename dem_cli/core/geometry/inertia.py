"""Inertia of blocks that turn: inverse tensors along the axes of the world, spins along principal axes, gyration.

In the plane there is one moment of inertia and nothing of it turns. In space moments are those along the principal
axes; `axes` lead from these to the axes of the block, `turns` from these to the world: matrices row by row, (n, 9).
Moments of 0 are those of supports, which nothing turns.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product


def _inverse(moments: np.ndarray) -> np.ndarray:
    """1 over moments of inertia, 0 for supports."""
    return np.divide(1.0, moments, out=np.zeros_like(moments), where=moments > 0.0)


def _along(axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Principal axes in the world, as columns, (n, 3, 3)."""
    return product(turns.reshape(-1, 3, 3), axes.reshape(-1, 3, 3))


def mobilities(moments: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Inverse tensors of inertia along the axes of the world [1/(kg m²)], row by row, (n, r·r)."""
    if moments.shape[1] == 1:
        return _inverse(moments)
    along = _along(axes, turns)
    return product(along * _inverse(moments)[:, None, :], along.swapaxes(1, 2)).reshape(-1, 9)


def along_principal(spins: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Spins along the axes of the world as components along the principal ones [rad/s], (n, r)."""
    if spins.shape[1] == 1:
        return spins
    return (_along(axes, turns) * spins[:, :, None]).sum(axis=1)


def gyration(spins: np.ndarray, moments: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Angular accelerations without any torque, along the axes of the world [rad/s²], (n, r): −J⁻¹ (ω × J ω)."""
    if spins.shape[1] == 1:
        return np.zeros_like(spins)
    own = along_principal(spins, axes, turns)
    change = _inverse(moments) * np.cross(moments * own, own)
    return (_along(axes, turns) * change[:, None, :]).sum(axis=2)
