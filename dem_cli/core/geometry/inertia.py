"""Rotational inertia of blocks: inverse inertia tensors, spins along principal axes, gyroscopic acceleration.

In the plane there is one moment of inertia and nothing of it turns. In space moments are those along the principal
axes; `axes` lead from these to the axes of the block, `turns` from these to the world: matrices row by row, (n, 9).
Moments of 0 are those of supports, which nothing turns.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product


def _inverse(moments: np.ndarray) -> np.ndarray:
    """Invert moments of inertia; 0 for supports."""
    return np.divide(1.0, moments, out=np.zeros_like(moments), where=moments > 0.0)


def _along(axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Compute the principal axes in world coordinates, as columns, (n, 3, 3)."""
    return product(turns.reshape(-1, 3, 3), axes.reshape(-1, 3, 3))


def mobilities(moments: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Compute inverse inertia tensors along the world axes [1/(kg m²)], row by row, (n, r·r)."""
    if moments.shape[1] == 1:
        return _inverse(moments)
    along = _along(axes, turns)
    return product(along * _inverse(moments)[:, None, :], along.swapaxes(1, 2)).reshape(-1, 9)


def along_principal(spins: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Resolve spins along the world axes into components along the principal axes [rad/s], (n, r)."""
    if spins.shape[1] == 1:
        return spins
    return (_along(axes, turns) * spins[:, :, None]).sum(axis=1)


def gyration(spins: np.ndarray, moments: np.ndarray, axes: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Gyroscopic angular accelerations without any torque, along the world axes [rad/s²], (n, r): −J⁻¹ (ω × J ω)."""
    if spins.shape[1] == 1:
        return np.zeros_like(spins)
    own = along_principal(spins, axes, turns)
    change = _inverse(moments) * np.cross(moments * own, own)
    return (_along(axes, turns) * change[:, None, :]).sum(axis=2)
