"""Tilings: stones that fill a plane region without gaps, with common corners, cut around holes, merged with neighbours.

A corner is one point for all stones around it, so that faces of neighbours are the same to the last bit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from dem_cli.geometry import polygon
from dem_cli.geometry.decomposition import ROUND_OFF, convex_parts

Loop = tuple[int, ...]  # numbers of the corners around a stone, counter-clockwise
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
        """Convex parts of a stone, corners on straight sides left out: edges on one line are one face of a part."""
        outline = polygon.simplified(self.outline(k), ROUND_OFF)
        if polygon.is_convex(outline):
            return (outline,)
        return tuple(polygon.simplified(outline[part], ROUND_OFF) for part in convex_parts(outline))

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


def without_holes(tiling: Tiling, holes: Sequence[np.ndarray], narrowest: float = 0.0) -> Tiling:
    """What convex holes (n, 2) leave of the stones; one around a single corner of a hole stays whole.

    Pieces narrower than that [m] are stones of their own: lips along a hole, for `merged` to give to a neighbour.
    """
    for hole in holes:
        tiling = _Cut(tiling, hole).outside(narrowest)
    return tiling


def width(outline: np.ndarray) -> float:
    """Twice the area over the size of a stone [m]: of a strip its width, twice."""
    return 2.0 * polygon.area(outline) / polygon.size(outline)


def within(tiling: Tiling, outline: np.ndarray) -> Tiling:
    """What of the stones lies in a convex outline (n, 2)."""
    return _Cut(tiling, outline).inside()


class _Cut:
    """Stones cut by the sides of a convex polygon; new corners are made once for both stones at an edge."""

    def __init__(self, tiling: Tiling, shape: np.ndarray):
        self.tiling, self.shape = tiling, shape
        self.ends = np.roll(shape, -1, axis=0)
        self.corners = list(tiling.corners)
        self.new: dict[tuple[int, int, int], int] = {}  # (edge, side of the polygon) -> corner
        self.on_edge: dict[tuple[int, int], list[int]] = defaultdict(list)
        self.gap = SAME * polygon.size(tiling.corners)
        arms = tiling.corners[:, None] - shape
        self.left = _left_of(self.ends - shape, arms, self.gap)  # of each corner from each side [m], (n, n_sides)

    def outside(self, narrowest: float) -> Tiling:
        """The stones without what lies in the polygon."""
        return self._whole([self._without(k, narrowest) for k in range(len(self.tiling.stones))])

    def inside(self) -> Tiling:
        """What of the stones lies in the polygon."""
        found: list[list[Loop]] = []
        for k in range(len(self.tiling.stones)):
            pieces = []
            for part in self._parts(k):
                for side in range(len(self.shape)):
                    part = self._half(part, side, 1.0)
                pieces += [part] if part else []
            found.append(united([self._with_new_corners(piece) for piece in pieces]))
        return self._whole(found)

    def _whole(self, pieces: Sequence[list[Loop]]) -> Tiling:
        courses = [course for course, some in zip(self.tiling.courses, pieces, strict=True) for _ in some]
        loops = [self._with_new_corners(loop) for some in pieces for loop in some]
        idle = self._idle(loops)
        return Tiling(np.array(self.corners), [tuple(i for i in loop if i not in idle) for loop in loops], courses)

    def _idle(self, loops: Sequence[Loop]) -> set[int]:
        """New corners on straight edges at which no third edge ends."""
        neighbours: dict[int, set[int]] = {i: set() for i in range(len(self.left), len(self.corners))}
        for loop in loops:
            for i, j in around(loop):
                for here, there in ((i, j), (j, i)):
                    if here >= len(self.left):
                        neighbours[here].add(there)
        return {
            i
            for i, others in neighbours.items()
            if len(others) == 2 and np.hypot(*(self.shape - self.corners[i]).T).min() > self.gap
        }

    def _parts(self, k: int) -> list[Loop]:
        loop, outline = self.tiling.stones[k], self.tiling.outline(k)
        if polygon.is_convex(outline):
            return [loop]
        return [tuple(loop[i] for i in part) for part in convex_parts(outline)]

    def _without(self, k: int, narrowest: float) -> list[Loop]:
        loop = self.tiling.stones[k]
        if (self.left[list(loop)].max(axis=0) <= 0.0).any():
            return [loop]
        pieces = []
        for part in self._parts(k):
            rest = part
            for side in self._upright_first():
                pieces.append(self._half(rest, side, -1.0))
                rest = self._half(rest, side, 1.0)
        pieces = [self._with_new_corners(piece) for piece in pieces if piece]
        lips = [piece for piece in pieces if width(np.array([self.corners[i] for i in piece])) < narrowest]
        pieces = [piece for piece in pieces if piece not in lips]
        outline = self.tiling.outline(k)
        inside = sum(_strictly_inside(outline, corner, self.gap) for corner in self._sharp_corners())
        return lips + (pieces if inside > 1 else united(pieces))

    def _upright_first(self) -> list[int]:
        """The sides, the steepest first: what is left beside a hole has its full height."""
        along = np.abs(self.ends - self.shape)
        slopes: list[int] = np.argsort(along[:, 0] / np.hypot(*along.T), kind="stable").tolist()
        return slopes

    def _sharp_corners(self) -> np.ndarray:
        """Corners of the polygon where it turns by more than 60°."""
        along = self.ends - self.shape
        along = along / np.hypot(*along.T)[:, None]
        return self.shape[(along * np.roll(along, 1, axis=0)).sum(axis=1) < 0.5]

    def _half(self, loop: Loop, side: int, sign: float) -> Loop:
        """The piece of a convex loop to the left (1) or the right (-1) of a side of the polygon; (): none."""
        away = [sign * self._away(i, side) for i in loop]
        if not loop or max(away) <= 0.0:
            return ()
        kept: list[int] = []
        for i, j, here, there in zip(loop, (*loop[1:], loop[0]), away, (*away[1:], away[0]), strict=True):
            if here >= 0.0:
                kept.append(i)
            if here * there < 0.0:
                kept.append(self._crossing(i, j, side))
        return tuple(kept)

    def _away(self, i: int, side: int) -> float:
        """How far a corner lies to the left of a side [m]; 0 on its line."""
        if i < len(self.left):
            return float(self.left[i, side])
        start, along = self.shape[side], self.ends[side] - self.shape[side]
        return float(_left_of(along[None], (self.corners[i] - start)[None, None], self.gap)[0, 0])

    def _crossing(self, i: int, j: int, side: int) -> int:
        i, j = min(i, j), max(i, j)
        key = (i, j, side)
        if key not in self.new:
            a, b = self.corners[i], self.corners[j]
            here, there = self._away(i, side), self._away(j, side)
            point = a + here / (here - there) * (b - a)
            for axis in (0, 1):  # exactly on sides along an axis
                if self.shape[side, axis] == self.ends[side, axis]:
                    point[axis] = self.shape[side, axis]
            self.new[key] = len(self.corners)
            self.corners.append(point)
            self.on_edge[i, j].append(self.new[key])
        return self.new[key]

    def _with_new_corners(self, loop: Loop) -> Loop:
        """The loop with all corners that were made on its edges."""
        found: list[int] = []
        for i, j in around(loop):
            between = self._all_between(min(i, j), max(i, j))
            found += [i, *(between if i < j else between[::-1])]
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


def _left_of(along: np.ndarray, arms: np.ndarray, gap: float) -> np.ndarray:
    """How far points lie to the left of lines [m]: directions (m, 2), arms from a point of each line (n, m, 2)."""
    away = (along[:, 0] * arms[:, :, 1] - along[:, 1] * arms[:, :, 0]) / np.hypot(*along.T)
    found: np.ndarray = np.where(np.abs(away) <= gap, 0.0, away)
    return found


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


def merged(tiling: Tiling, least: float, narrowest: float = 0.0) -> Tiling:
    """Stones below an area `least` [m2] or a width [m] joined to the neighbour with which they share the longest face.

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
