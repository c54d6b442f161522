"""Stones of a wall while it is drawn: pieces left by openings, small ones joined to their neighbours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry import cuts, polygon
from dem_cli.masonry.structures.courses import LEAST_PIECE, Span

ALMOST = 1e-6  # relative: a stone that much below a quarter of a block is one


class Part(NamedTuple):
    """Convex piece of a stone."""

    shape: np.ndarray  # in the elevation of the wall, counter-clockwise [m], (n, 2)
    across: Span  # from where to where it goes square to it [m]

    @property
    def volume(self) -> float:
        """Volume [m3]."""
        return polygon.area(self.shape) * (self.across[1] - self.across[0])


class Stone(NamedTuple):
    """Stone of a wall, which becomes a block."""

    course: int  # from 1
    parts: tuple[Part, ...]
    full: float  # area of a full block of its course, in elevation [m2]
    leaf: str = ""  # "a", "b", "c"; "": through all of them
    material: str = ""
    name: str = ""  # of its own; "": by course and number

    @property
    def share(self) -> float:
        """Volume of the stone as a share of a full block of the same depth."""
        deep = max(part.across[1] - part.across[0] for part in self.parts)
        return sum(part.volume for part in self.parts) / (self.full * deep)

    @property
    def is_small(self) -> bool:
        """Tell whether the stone is smaller than a quarter of a block."""
        return self.share < LEAST_PIECE * (1.0 - ALMOST)

    @property
    def box(self) -> np.ndarray:
        """Bounding box [left, bottom, right, top] in elevation [m]."""
        corners = np.concatenate([part.shape for part in self.parts])
        return np.concatenate([corners.min(axis=0), corners.max(axis=0)])


def put_together(stones: Sequence[Stone], gap: float) -> list[Stone]:
    """Merge stones below a quarter of a block with the stones that they touch.

    The smallest one first, each becomes a part of the stone with which it shares most of its face: of one in the same
    leaf if there is one. Parts that are convex together become one. gap: edges so close touch [m].
    """
    found: list[Stone | None] = list(stones)
    if not found:
        return []
    boxes = np.array([stone.box for stone in stones])
    small = {i: stone.share for i, stone in enumerate(stones) if stone.is_small}
    joined = set()
    while small:
        i = min(small, key=lambda k: (round(small[k], 9), k))
        del small[i]
        stone = found[i]
        assert stone is not None
        near = (boxes[:, :2] <= boxes[i, 2:] + gap).all(axis=1) & (boxes[:, 2:] >= boxes[i, :2] - gap).all(axis=1)
        shared = [
            (other.leaf == stone.leaf, face, -k)
            for k in np.flatnonzero(near).tolist()
            if k != i and (other := found[k]) is not None and (face := _shared_face(stone, other, gap)) > 0.0
        ]
        if not shared:
            continue
        k = -max((same, round(face, 9), number) for same, face, number in shared)[2]
        other = found[k]
        assert other is not None
        found[k] = one = other._replace(parts=other.parts + stone.parts)
        found[i] = None
        boxes[k], boxes[i] = one.box, np.inf
        joined.add(k)
        small.pop(k, None)
        if one.is_small:
            small[k] = one.share
    return [_simpler(stone, gap) if len(stone.parts) > 1 else stone for stone in found if stone is not None]


def _shared_face(a: Stone, b: Stone, gap: float) -> float:
    """Return the contact area of two stones, square to the elevation [m2]."""
    return sum(
        cuts.common_edge(p.shape, q.shape, gap) * depth
        for p in a.parts
        for q in b.parts
        if (depth := min(p.across[1], q.across[1]) - max(p.across[0], q.across[0])) > gap
    )


def _simpler(stone: Stone, gap: float) -> Stone:
    """Merge the parts of a stone that are convex together."""
    return stone._replace(parts=tuple(_joined(stone.parts, gap)))


def _joined(parts: Sequence[Part], gap: float) -> Iterator[Part]:
    for across in sorted({part.across for part in parts}):
        for shape in cuts.unions([part.shape for part in parts if part.across == across], gap):
            yield Part(shape, across)
