"""Bases of structures: the fixed block below, as deep as what stands on it, in 3D with the same margin all around."""

from __future__ import annotations

import numpy as np

from dem_cli.core.model.blocks import Block


def base_block(name: str, shape: np.ndarray, thickness: float, extension: float) -> Block:
    """The fixed block of a shape (n, 2) below what has that thickness; in space it goes `extension` beyond that [m]."""
    half = thickness / 2.0 + extension
    return Block(name, (shape,), "", thickness, fixed=True, across=(-half, half))
