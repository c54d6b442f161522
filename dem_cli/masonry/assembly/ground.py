"""Create the ground: one fixed block under all structures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.geometry import polyhedron
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block, corners_of
from dem_cli.errors import CaseProblem

if TYPE_CHECKING:
    from dem_cli.case.load_tables import GroundTable

NAME = "ground"
MARGIN = 0.1  # of the largest extent of what stands on it
ON_IT = 1e-6  # of the same: what begins so near to its top stands on it


def ground_blocks(table: GroundTable, blocks: Sequence[Block], problems: list[CaseProblem]) -> list[Block]:
    """Create the ground block under the structures; adds a problem for blocks that reach below its level."""
    fixed = [block for block in blocks if block.fixed and any(not other.fixed for other in blocks)]
    blocks = [block for block in blocks if not block.fixed] or blocks
    corners = [np.concatenate([corners_of(part) for part in block.parts]) for block in blocks]
    low, high = (limit(np.concatenate(corners), axis=0) for limit in (np.min, np.max))
    extent = float((high - low).max())
    margin = MARGIN * extent if table.margin is None else table.margin
    top = float(low[-1]) if table.level is None else table.level
    bottom = top - (MARGIN * extent if table.height is None else table.height)
    lowest = min(range(len(blocks)), key=lambda i: float(corners[i][:, -1].min()))
    if float(low[-1]) < top - ON_IT * extent:
        message = f"{top:g} is not allowed: block '{blocks[lowest].id}' reaches down to {float(low[-1]):.6g}"
        problems.append(CaseProblem((NAME, "level"), message))
        return []
    low, high = low - margin, high + margin
    low[-1], high[-1] = bottom, top
    if within := next((block for block in fixed if _reaches_into(block, low, high, ON_IT * extent)), None):
        message = f"'{within.id}' is fixed and lies in it: what stands there would have two joints; leave out its "
        problems.append(CaseProblem((NAME,), message + "base or the ground, or give that another level"))
        return []
    if len(low) == 2:
        shape = rectangle(low[0], bottom, high[0] - low[0], top - bottom)
        thickness = max(block.thickness for block in blocks)
        return [Block(NAME, (shape,), table.material, thickness, fixed=True, path=(NAME,))]
    return [Block(NAME, (polyhedron.box(low, high),), table.material, fixed=True, path=(NAME,))]


def _reaches_into(block: Block, low: np.ndarray, high: np.ndarray, least: float) -> bool:
    """Test whether a part of a block overlaps a box by more than a face, by the box around the part."""
    for part in map(corners_of, block.parts):
        shared = np.minimum(part.max(axis=0), high) - np.maximum(part.min(axis=0), low)
        if (shared > least).all():
            return True
    return False
