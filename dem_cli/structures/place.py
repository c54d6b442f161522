"""From a generator's local blocks to blocks in their final place, with full names; aliases for these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dem_cli.case.base import StructureBase
from dem_cli.errors import KeyPath
from dem_cli.geometry import polygon
from dem_cli.model.blocks import Block

CORNERS = {  # alias: where it is in the box around the free blocks, as fractions of width and height
    "bottom-left": (0.0, 0.0),
    "bottom-right": (1.0, 0.0),
    "top-left": (0.0, 1.0),
    "top-right": (1.0, 1.0),
    "top": (0.5, 1.0),
}


def full_id(prefix: str, local: str) -> str:
    """Name of a block of a structure: "wall" and "3-2" -> "wall-3-2"."""
    return f"{prefix}-{local}"


def place(blocks: Sequence[Block], parameters: StructureBase, path: KeyPath) -> list[Block]:
    """Turns, then shifts the blocks of a generator; completes their ids and materials; notes their `path`."""
    vertices = [part for block in blocks for part in block.parts]
    ends = np.cumsum([len(part) for part in vertices])[:-1]
    placed = polygon.moved(np.concatenate(vertices), parameters.rotation, parameters.origin)
    parts = iter(np.split(placed, ends))
    return [
        replace(
            block,
            id=full_id(parameters.id, block.id),
            parts=tuple(next(parts) for _ in block.parts),
            material=block.material or parameters.material,
            path=path,
        )
        for block in blocks
    ]


def aliases(structures: Mapping[str, Sequence[Block]]) -> dict[str, str]:
    """Alias -> block id, for structures {id: blocks with local ids, not yet turned}.

    Each has "<id>-top-right" and so on; where there is one structure only, "top-right" and the local ids
    ("base", "lintel-1") do as well. An alias never hides a block of that name.
    """
    found: dict[str, str] = {}
    for prefix, blocks in structures.items():
        corners = {alias: full_id(prefix, local) for alias, local in corner_blocks(blocks).items()}
        found |= {full_id(prefix, alias): block for alias, block in corners.items()}
        if len(structures) == 1:
            found |= {block.id: full_id(prefix, block.id) for block in blocks} | corners
    return found


def corner_blocks(blocks: Sequence[Block]) -> dict[str, str]:
    """Alias -> id of the free block with a vertex nearest to that corner of the box around all free blocks.

    Of several at the same distance: the one whose mean vertex lies nearest to the corner, then the first.
    """
    free = [block for block in blocks if not block.fixed]
    if not free:
        return {}
    shapes = [part for block in free for part in block.parts]
    owner = np.repeat(np.arange(len(free)), [sum(len(part) for part in block.parts) for block in free])
    vertices = np.concatenate(shapes)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    means = np.stack([np.bincount(owner, vertices[:, k]) for k in (0, 1)], axis=1)
    means /= np.bincount(owner)[:, None]
    step = 1e-9 * np.hypot(*(high - low))  # distances are compared in units of this, against round-off
    result = {}
    for alias, fractions in CORNERS.items():
        corner = low + np.array(fractions) * (high - low)
        near = np.full(len(free), np.inf)
        np.minimum.at(near, owner, np.hypot(*(vertices - corner).T))
        ranks = np.lexsort((np.rint(np.hypot(*(means - corner).T) / step), np.rint(near / step)))
        result[alias] = free[ranks[0]].id
    return result
