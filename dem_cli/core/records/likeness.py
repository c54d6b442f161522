"""Likeness of a stored value to the one that it replaces: the same kind, and arrays of the same shape."""

from __future__ import annotations

from typing import Any

import numpy as np

_NUMBERS = (bool, int, float, np.number, np.bool_)
_OF_JOINTS = frozenset((  # records whose arrays have rows of joints, points or threads, which may be others by now
    "Contacts", "Dampers", "JointTiles", "MovingJoints", "PlanarGeometry", "SpatialGeometry", "SpatialMotion",
))  # fmt: skip


def alike(here: Any, kept: Any, rows: bool = False) -> bool:
    """Test whether a stored value may replace the present one; None may have become anything.

    rows: arrays may have more or fewer of them.
    """
    if here is None or kept is here:
        return True
    if isinstance(here, _NUMBERS):
        return isinstance(kept, _NUMBERS)
    if type(kept) is not type(here):
        return False
    if isinstance(here, np.ndarray):
        return here.dtype == kept.dtype and here.ndim == kept.ndim and _of_shape(here.shape, kept.shape, rows)
    if isinstance(here, tuple):
        rows = rows or type(here).__name__ in _OF_JOINTS
        return len(here) == len(kept) and all(alike(a, b, rows) for a, b in zip(here, kept, strict=True))
    return not hasattr(here, "__dict__") or all(alike(a, vars(kept).get(name)) for name, a in vars(here).items())


def _of_shape(here: tuple[int, ...], kept: tuple[int, ...], rows: bool) -> bool:
    return here[1:] == kept[1:] if rows else here == kept
