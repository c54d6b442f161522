"""What a generator returns: blocks with a name, a shape and a material, in their final place."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dem_cli.errors import KeyPath


@dataclass(frozen=True)
class Block:
    """One rigid block.

    parts      convex pieces that move as one, each an (n, 2) array of corners [m], counter-clockwise
    thickness  depth out of plane [m] (2D)
    path       where in the case file it comes from, for error messages
    """

    id: str
    parts: tuple[np.ndarray, ...]
    material: str
    thickness: float = 1.0
    fixed: bool = False
    path: KeyPath = field(default=(), compare=False)
