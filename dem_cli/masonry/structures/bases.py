"""Generate bases of structures: the fixed block below, as deep as the structure, in 3D with a margin all around."""

from __future__ import annotations

import numpy as np

from dem_cli.core.model.blocks import Block


def base_block(name: str, shape: np.ndarray, thickness: float, extension: float) -> Block:
    """Create the fixed block of a shape (n, 2) below a thickness; in space it extends `extension` beyond it [m]."""
    half = thickness / 2.0 + extension
    return Block(name, (shape,), "", thickness, fixed=True, across=(-half, half))
