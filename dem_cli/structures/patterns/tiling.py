"""Tilings: stones that fill a plane region without gaps, with common corners, cut around holes, merged with neighbours.

A corner is one point for all stones around it, so that faces of neighbours are the same to the last bit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from dem_cli.geometry import polygon
from dem_cli.geometry.decomposition import convex_parts

Loop = tuple[int, ...]  # numbers of the corners around a stone, counter-clockwise
Box = tuple[float, float, float, float]  # left, bottom, right, top [m]
SAME = 1e-9  # relative to the region: closer points are one


@dataclass
class Tiling:
    """Stones of a region of the plane.

    corners  [m], (n, 2)
    stones   corners around each stone, which may be concave; those of its neighbours on its sides are among them
    courses  number of the course of each stone from 1; 0: in none
    """

    corners: np.ndarray
    stones: list[Loop]
    courses: list[int]

    def outline(self, k: int) -> np.ndarray:
        """Corners of a stone [m], (n, 2)."""
        return self.corners[list(self.stones[k])]

    def areas(self) -> np.ndarray:
        """Area of each stone [m2], (n_stones,)."""
        starts = np.cumsum([0, *map(len, self.stones)])
        return polygon.properties_of_all(self.corners[[i for loop in self.stones for i in loop]], starts).area

    def parts(self, k: int) -> tuple[np.ndarray, ...]:
        """Convex parts of a stone, corners on straight sides left out."""
        outline = self.outline(k)
        if not polygon.is_convex(outline):
            return tuple(polygon.simplified(outline[part]) for part in convex_parts(outline))
        return (polygon.simplified(outline),)

    def edges(self) -> dict[tuple[int, int], int]:
        """The stone to the left of each edge, from corner to corner."""
        return {edge: k for k, loop in enumerate(self.stones) for edge in around(loop)}

    def edge_lengths(self) -> np.ndarray:
        """Lengths of all edges [m], each once, (n,)."""
        pairs = np.array(sorted({(min(edge), max(edge)) for loop in self.stones for edge in around(loop)}))
        return np.hypot(*(self.corners[pairs[:, 1]] - self.corners[pairs[:, 0]]).T)


def around(loop: Loop) -> Iterable[tuple[int, int]]:
    """The edges of a loop, from corner to corner."""
    return zip(loop, (*loop[1:], loop[0]), strict=True)


def united(loops: Sequence[Loop]) -> list[Loop]:
    """Outlines of stones that are put together: one for each group that hangs together by whole edges.

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
    """The single outline of some stones; None: there are several, or one that touches itself."""
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


def without_holes(tiling: Tiling, holes: Sequence[Box]) -> Tiling:
    """What holes leave of the stones: a stone around one corner of a hole stays one, others fall apart."""
    for hole in holes:
        tiling = _Cut(tiling, hole).rest()
    return tiling


class _Cut:
    """One hole being cut out; new corners are made once for both stones at an edge."""

    def __init__(self, tiling: Tiling, hole: Box):
        self.tiling, self.hole = tiling, hole
        self.corners = list(tiling.corners)
        self.new: dict[tuple[int, int, int], int] = {}  # (edge, side of the hole) -> corner
        self.on_edge: dict[tuple[int, int], list[int]] = defaultdict(list)
        self.gap = SAME * float(np.abs(np.ptp(tiling.corners, axis=0)).max())

    def rest(self) -> Tiling:
        stones: list[Loop] = []
        courses: list[int] = []
        for k in range(len(self.tiling.stones)):
            pieces = self._stone(k)
            stones += pieces
            courses += [self.tiling.courses[k]] * len(pieces)
        loops = [self._with_new_corners(loop) for loop in stones]
        return Tiling(np.array(self.corners), loops, courses)

    def _stone(self, k: int) -> list[Loop]:
        loop, outline = self.tiling.stones[k], self.tiling.outline(k)
        left, bottom, right, top = self.hole
        low, high = outline.min(axis=0), outline.max(axis=0)
        gap = self.gap
        if low[0] >= right - gap or high[0] <= left + gap or low[1] >= top - gap or high[1] <= bottom + gap:
            return [loop]
        pieces = []
        for part in (
            [loop] if polygon.is_convex(outline) else [tuple(loop[i] for i in p) for p in convex_parts(outline)]
        ):
            pieces += self._around_hole(part)
        return pieces if self._corners_inside(outline) > 1 else united(pieces)

    def _corners_inside(self, outline: np.ndarray) -> int:
        left, bottom, right, top = self.hole
        corners = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
        return sum(_strictly_inside(outline, corner, self.gap) for corner in corners)

    def _around_hole(self, loop: Loop) -> list[Loop]:
        """Convex pieces of a convex part: left and right of the hole at full height, the rest below and above it."""
        left, bottom, right, top = self.hole
        found, middle = [], loop
        for side, axis, value, sign in ((0, 0, left, 1), (1, 0, right, -1), (2, 1, bottom, 1), (3, 1, top, -1)):
            piece = self._half(middle, side, axis, value, -sign)
            middle = self._half(middle, side, axis, value, sign)
            if piece:
                found.append(piece)
            if not middle:
                break
        return found

    def _half(self, loop: Loop, side: int, axis: int, value: float, sign: int) -> Loop:
        """The piece of a convex loop where sign (x - value) > 0; (): none."""
        if not loop:
            return ()
        away = sign * (np.array([self.corners[i][axis] for i in loop]) - value)
        away[np.abs(away) <= self.gap] = 0.0
        if away.max() <= 0.0:
            return ()
        kept: list[int] = []
        for k, i in enumerate(loop):
            j, here, there = loop[(k + 1) % len(loop)], away[k], away[(k + 1) % len(loop)]
            if here >= 0.0:
                kept.append(i)
            if here * there < 0.0:
                kept.append(self._crossing(i, j, side, axis, value))
        return tuple(kept)

    def _crossing(self, i: int, j: int, side: int, axis: int, value: float) -> int:
        i, j = min(i, j), max(i, j)
        key = (i, j, side)
        if key not in self.new:
            a, b = self.corners[i], self.corners[j]
            point = a + (value - a[axis]) / (b[axis] - a[axis]) * (b - a)
            point[axis] = value
            self.new[key] = len(self.corners)
            self.corners.append(point)
            self.on_edge[i, j].append(self.new[key])
        return self.new[key]

    def _with_new_corners(self, loop: Loop) -> Loop:
        """The loop with all corners that were made on its edges."""
        found: list[int] = []
        for i, j in around(loop):
            found.append(i)
            between = self._all_between(min(i, j), max(i, j))
            found += between if i < j else between[::-1]
        return tuple(found)

    def _all_between(self, i: int, j: int) -> list[int]:
        """Corners made on an edge and on its pieces, from i to j."""
        if not self.on_edge.get((i, j)):
            return []
        start, along = self.corners[i], self.corners[j] - self.corners[i]
        near = sorted(self.on_edge[i, j], key=lambda m: float((self.corners[m] - start) @ along))
        chain, found = [i, *near, j], []
        for a, b in zip(chain[:-1], chain[1:], strict=True):
            inner = self._all_between(min(a, b), max(a, b))
            found += [*(inner if a < b else inner[::-1]), b]
        return found[:-1]


def _strictly_inside(outline: np.ndarray, point: np.ndarray, gap: float) -> bool:
    """Whether a point lies within a simple polygon, further than `gap` from its sides."""
    edges = np.roll(outline, -1, axis=0) - outline
    arms = point - outline
    share = np.clip((arms * edges).sum(axis=1) / (edges**2).sum(axis=1), 0.0, 1.0)
    if np.hypot(*(arms - share[:, None] * edges).T).min() <= gap:
        return False
    after = np.roll(outline, -1, axis=0)
    straddles = (outline[:, 1] > point[1]) != (after[:, 1] > point[1])
    rows = np.flatnonzero(straddles)
    places = outline[rows, 0] + (point[1] - outline[rows, 1]) / edges[rows, 1] * edges[rows, 0]
    return bool((places > point[0]).sum() % 2)


def merged(tiling: Tiling, least: float) -> Tiling:
    """Stones below an area `least` [m2] joined to the neighbour with which they share the longest face.

    Neighbours of their own course come first. A stone that has no neighbour stays.
    """
    stones: dict[int, Loop] = dict(enumerate(tiling.stones))
    areas = dict(enumerate(tiling.areas().tolist()))
    courses = dict(enumerate(tiling.courses))
    owner = tiling.edges()
    waiting = {k for k, area in areas.items() if area < least}
    while waiting:
        k = min(waiting, key=lambda i: (areas[i], i))
        waiting.discard(k)
        shared: dict[int, float] = defaultdict(float)
        for a, b in around(stones[k]):
            if (b, a) in owner:
                shared[owner[b, a]] += float(np.hypot(*(tiling.corners[b] - tiling.corners[a])))
        for other in sorted(shared, key=lambda i: (courses[i] != courses[k], -shared[i], i)):
            outline = _outline([stones[k], stones[other]])
            if outline is None:
                continue
            stones[other] = outline
            areas[other] += areas[k]
            del stones[k]
            owner |= dict.fromkeys(around(outline), other)
            if areas[other] >= least:
                waiting.discard(other)
            else:
                waiting.add(other)
            break
    kept = sorted(stones)
    return Tiling(tiling.corners, [stones[k] for k in kept], [courses[k] for k in kept])
