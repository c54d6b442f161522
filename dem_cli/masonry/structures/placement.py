"""Place generated blocks: from local coordinates to their final place, with full names and aliases.

Generators draw in a plane, x along the structure and y upwards. In 2D that is the plane of the case. In 3D it stands
upright on the ground: blocks become prisms, half their thickness to either side of it, turned in plan about the origin.
What is no prism a generator draws in space: x along the structure, y across it, z upwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from dem_cli.case.base import StructureBase
from dem_cli.core.geometry import polygon, polyhedron
from dem_cli.core.model.blocks import Block, corners_of
from dem_cli.errors import KeyPath

CORNERS = {  # alias: where it is in the box around the free blocks, as fractions of width and height
    "bottom-left": (0.0, 0.0),
    "bottom-right": (1.0, 0.0),
    "top-left": (0.0, 1.0),
    "top-right": (1.0, 1.0),
    "top": (0.5, 1.0),
}


def full_id(prefix: str, local: str) -> str:
    """Return the full name of a block of a structure: "wall" and "3-2" -> "wall-3-2"."""
    return f"{prefix}-{local}"


def place(blocks: Sequence[Block], parameters: StructureBase, path: KeyPath, dimension: int = 2) -> list[Block]:
    """Rotate, then shift the blocks of a generator; completes their ids and materials and records their `path`."""
    parts, others = PLACES[dimension](blocks, parameters)
    return [
        block.with_fields(
            id=full_id(parameters.id, block.id),
            parts=tuple(next(parts) for _ in block.parts),
            material=block.material or parameters.material,
            path=path,
            **others,
        )
        for block in blocks
    ]


def planar_places(blocks: Sequence[Block], parameters: StructureBase) -> tuple[Iterator[Any], dict[str, Any]]:
    """Return the parts of all blocks in their final place in the plane, and the other fields that change."""
    vertices = [part for block in blocks for part in block.parts]
    starts = np.cumsum([0, *(len(part) for part in vertices)]).tolist()
    placed = polygon.moved(np.concatenate(vertices), parameters.rotation, parameters.origin)
    return (placed[start:end] for start, end in pairwise(starts)), {}


def spatial_places(blocks: Sequence[Block], parameters: StructureBase) -> tuple[Iterator[Any], dict[str, Any]]:
    """Return the parts of all blocks in their final place in space, polygons as prisms rotated in plan."""
    solids: list[Any] = [part for block in blocks for part in block.parts]
    flat = [k for k, part in enumerate(solids) if not isinstance(part, polyhedron.Polyhedron)]
    low, high = np.array([depth(block) for block in blocks for _ in block.parts])[flat].T
    for k, prism in zip(flat, polyhedron.prisms([solids[k] for k in flat], low, high), strict=True):
        solids[k] = prism
    placed = polyhedron.all_moved(solids, parameters.rotation, parameters.origin)
    return iter(placed), {"thickness": 1.0, "across": None}


def depth(block: Block) -> tuple[float, float]:
    """Return the interval of a generated block square to its drawing plane [m]."""
    return block.across or (-block.thickness / 2.0, block.thickness / 2.0)


Places = Callable[[Sequence[Block], StructureBase], tuple[Iterator[Any], dict[str, Any]]]
PLACES: dict[int, Places] = {2: planar_places, 3: spatial_places}


def aliases(structures: Mapping[str, Sequence[Block]]) -> dict[str, str]:
    """Return alias -> block id for structures {id: blocks with local ids, before rotation}.

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
    """Return alias -> id of the free block nearest to each corner of the box around all free blocks.

    Of several at the same distance: the one whose own centre lies nearest to the corner, then the first.
    """
    free = [block for block in blocks if not block.fixed]
    if not free:
        return {}
    corners = [[corners_of(part) for part in block.parts] for block in free]
    vertices = np.concatenate([part[:, [0, -1]] for own in corners for part in own])  # in space as seen from -y
    first = np.cumsum([0, *(sum(map(len, own)) for own in corners[:-1])])
    low, high = np.minimum.reduceat(vertices, first), np.maximum.reduceat(vertices, first)
    foot, extent = low.min(axis=0), np.ptp(vertices, axis=0)
    result = {}
    for alias, fractions in CORNERS.items():
        corner = foot + np.array(fractions) * extent
        outside = np.maximum(np.maximum(low - corner, corner - high), 0.0)
        distances = np.stack([np.hypot(*((low + high) / 2.0 - corner).T), np.hypot(*outside.T)])
        ranks = np.lexsort(np.rint(distances / (1e-9 * np.hypot(*extent))))  # rounded against round-off
        result[alias] = free[ranks[0]].id
    return result
