"""Tilings: stones that fill a plane region without gaps and share corners; united, merged with neighbours.

A corner is one point for all stones around it, so that faces of neighbours are the same to the last bit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.decomposition import ROUND_OFF, convex_parts

Loop = tuple[int, ...]  # numbers of the corners around a stone, counter-clockwise
SAME = 1e-9  # relative to the region: closer points are one


@dataclass
class Tiling:
    """Tiling of a plane region by stones with shared corners.

    corners  [m], (n, 2)
    stones   corners around each stone, which may be concave; those of its neighbours on its sides are among them
    courses  number of the course of each stone from 1; 0: in none
    """

    corners: np.ndarray
    stones: list[Loop]
    courses: list[int]

    def outline(self, k: int) -> np.ndarray:
        """Return the corners of a stone [m], (n, 2)."""
        return self.corners[list(self.stones[k])]

    def areas(self) -> np.ndarray:
        """Return the area of each stone [m2], (n_stones,)."""
        starts = np.cumsum([0, *map(len, self.stones)])
        return polygon.properties_of_all(self.corners[[i for loop in self.stones for i in loop]], starts).area

    def parts(self, k: int) -> tuple[np.ndarray, ...]:
        """Return the convex parts of a stone without corners on straight sides: edges on one line are one face."""
        return self._parts[k]

    @cached_property
    def _parts(self) -> list[tuple[np.ndarray, ...]]:
        """Convex parts of all stones, which are tested together: one by one takes most of the time of drawing them."""
        outlines = [polygon.simplified(self.outline(k), ROUND_OFF) for k in range(len(self.stones))]
        solid = [k for k, outline in enumerate(outlines) if len(outline) >= 3]
        starts = np.cumsum([0, *(len(outlines[k]) for k in solid)])
        corners = np.concatenate([np.zeros((0, 2)), *(outlines[k] for k in solid)])
        convex = polygon.are_convex(corners, starts).tolist() if solid else []
        whole = {k for k, yes in zip(solid, convex, strict=True) if yes}
        return [
            (outline,) if k in whole
            else tuple(polygon.simplified(outline[part], ROUND_OFF) for part in convex_parts(outline))
            for k, outline in enumerate(outlines)
        ]  # fmt: skip

    def edges(self) -> dict[tuple[int, int], int]:
        """Return the stone to the left of each edge, from corner to corner."""
        return {edge: k for k, loop in enumerate(self.stones) for edge in around(loop)}

    def edge_lengths(self) -> np.ndarray:
        """Return the lengths of all edges [m], each once, (n,)."""
        pairs = np.array(sorted({(min(edge), max(edge)) for loop in self.stones for edge in around(loop)}))
        return np.hypot(*(self.corners[pairs[:, 1]] - self.corners[pairs[:, 0]]).T)


def around(loop: Loop) -> Iterable[tuple[int, int]]:
    """Return the edges of a loop, from corner to corner."""
    return zip(loop, (*loop[1:], loop[0]), strict=True)


def united(loops: Sequence[Loop]) -> list[Loop]:
    """Unite stones to outlines: one for each group connected by whole edges.

    A group around a hole, or that touches itself in a corner, has no single outline: it stays as it was.
    """
    owner = {edge: k for k, loop in enumerate(loops) for edge in around(loop)}
    group = list(range(len(loops)))

    def first(k: int) -> int:
        while group[k] != k:
            k = group[k]
        return k

    for (a, b), k in owner.items():
        if (b, a) in owner:
            low, high = sorted((first(k), first(owner[b, a])))
            group[high] = low
    found: list[Loop] = []
    for g in sorted({first(k) for k in range(len(loops))}):
        members = [loop for k, loop in enumerate(loops) if first(k) == g]
        outline = _outline(members)
        found += [outline] if outline else members
    return found


def _outline(loops: Sequence[Loop]) -> Loop | None:
    """Return the single outline of some stones; None: there are several, or one that touches itself."""
    edges = {edge for loop in loops for edge in around(loop)}
    free = [(a, b) for loop in loops for a, b in around(loop) if (b, a) not in edges]
    following = dict(free)
    if len(following) < len(free):
        return None
    start = free[0][0]
    outline = [start]
    while (after := following[outline[-1]]) != start:
        outline.append(after)
    return tuple(outline) if len(outline) == len(free) else None


def width(outline: np.ndarray) -> float:
    """Return twice the area over the size of a stone [m]; of a strip twice its width."""
    return 2.0 * polygon.area(outline) / polygon.size(outline)


def merged(tiling: Tiling, least: float, narrowest: float = 0.0) -> Tiling:
    """Merge stones below an area `least` [m2] or a width [m] with the neighbour of the longest shared face.

    A stone that has no neighbour stays.
    """
    stones: dict[int, Loop] = dict(enumerate(tiling.stones))
    areas = dict(enumerate(tiling.areas().tolist()))
    courses = dict(enumerate(tiling.courses))
    owner = tiling.edges()

    def is_sliver(k: int) -> bool:
        return areas[k] < least or width(tiling.corners[list(stones[k])]) < narrowest

    waiting = {k for k in stones if is_sliver(k)}
    while waiting:
        k = min(waiting, key=lambda i: (areas[i], i))
        waiting.discard(k)
        shared: dict[int, float] = defaultdict(float)
        for a, b in around(stones[k]):
            if (b, a) in owner:
                shared[owner[b, a]] += float(np.hypot(*(tiling.corners[b] - tiling.corners[a])))
        for other in sorted(shared, key=lambda i: (-shared[i], i)):
            outline = _outline([stones[k], stones[other]])
            if outline is None:
                continue
            stones[other] = outline
            areas[other] += areas[k]
            del stones[k]
            owner |= dict.fromkeys(around(outline), other)
            waiting = waiting | {other} if is_sliver(other) else waiting - {other}
            break
    kept = sorted(stones)
    return Tiling(tiling.corners, [stones[k] for k in kept], [courses[k] for k in kept])
