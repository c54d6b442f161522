"""Cut every block of a structure across its length into pieces with a bonded joint, so that it can crack.

The blocks are whole as generators lay them; here they are cut, whatever drew them, in the plane and in space alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dem_cli.case.base import Crack
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.geometry import cuts, halfspaces, polygon
from dem_cli.core.geometry.polyhedron import Polyhedron, newell
from dem_cli.core.model.blocks import PIECE, Block, corners_of

ALIKE = 1e-6  # relative: second moments of a block that are no longer than another in any direction
LETTERS = "abcdefghijklmnopqrstuvwxyz"


def cracked(blocks: Sequence[Block], crack: Crack | None) -> list[Block]:
    """Cut the movable blocks of a structure into pieces: "3-2" becomes "3-2/a", "3-2/b"; None: all stay whole.

    Blocks that their planes do not cut stay as they are.
    """
    if crack is None:
        return list(blocks)
    return [piece for block in blocks for piece in (_pieces(block, crack) if not block.fixed else [block])]


def _pieces(block: Block, crack: Crack) -> list[Block]:
    corners = np.concatenate([corners_of(part) for part in block.parts])
    normal = along(corners)
    heights = product(corners, normal)
    low, high = float(heights.min()), float(heights.max())
    found, rest = [], list(block.parts)
    for share in crack.at:
        behind, beyond = _cut(rest, normal, low + share * (high - low))
        if behind and beyond:
            found.append(behind)
            rest = beyond
    found.append(rest)
    if len(found) == 1:
        return [block]
    sizes = np.array([sum(map(_size, parts)) for parts in found])
    masses = [None] * len(found) if block.mass is None else (block.mass * sizes / sizes.sum()).tolist()
    return [
        replace(block, id=f"{block.id}{PIECE}{letter}", parts=tuple(parts), mass=mass, crack=crack.joint)
        for letter, parts, mass in zip(LETTERS, found, masses, strict=False)
    ]


def along(corners: np.ndarray) -> np.ndarray:
    """Return the unit vector along the longest extent of a block's corners (n, d); of equal ones, that nearest to x."""
    arms = corners - corners.mean(axis=0)
    values, vectors = diagonalised(product(arms.T, arms))
    longest = vectors[:, values >= (1.0 - ALIKE) * values[-1]]
    for axis in np.eye(len(values)):
        direction = product(longest, product(longest.T, axis))
        if product(direction, axis) > ALIKE:
            break
    direction[np.abs(direction) < ALIKE] = 0.0  # upright to the last bit where it is but for round-off
    return direction / norm(direction)


def _cut(parts: Sequence[Any], normal: np.ndarray, height: float) -> tuple[list[Any], list[Any]]:
    """Cut parts by the plane {x: normal · x = height} [m]; returns those behind and those beyond it."""
    behind, beyond = list[Any](), list[Any]()
    for part in parts:
        sides = _solid_halves(part, normal, height) if isinstance(part, Polyhedron) else _halves(part, normal, height)
        behind += sides[0]
        beyond += sides[1]
    return behind, beyond


def _solid_halves(solid: Polyhedron, normal: np.ndarray, height: float) -> tuple[list[Polyhedron], list[Polyhedron]]:
    both = halfspaces.halves(solid, normal, height)
    return (
        [side for side in (both.behind,) if side is not None],
        [side for side in (both.beyond,) if side is not None],
    )


def _halves(shape: np.ndarray, normal: np.ndarray, height: float) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Cut a polygon by the plane {x: normal · x = height} [m] into the parts behind and beyond it."""
    start = height * normal
    end = start + np.array([-normal[1], normal[0]])
    left, right = cuts.halves(shape, start, end, polygon.ROUND_OFF * polygon.size(shape))
    return [side for side in (left,) if len(side)], [side for side in (right,) if len(side)]


def _size(part: Any) -> float:
    """Return a measure of the size of a part for comparison: its area, or a multiple of its volume [m^d]."""
    if not isinstance(part, Polyhedron):
        return polygon.area(part)
    loops = [part.vertices[face] for face in part.faces]
    return abs(sum(float(product(loop[0], newell(loop))) for loop in loops))
