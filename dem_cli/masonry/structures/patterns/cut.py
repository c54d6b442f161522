"""Cut stones by the sides of a convex polygon: around openings and quoins, along the slopes of a gable."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.decomposition import convex_parts
from dem_cli.masonry.structures.patterns.tiling import SAME, Loop, Tiling, around, united, width


def without_holes(tiling: Tiling, holes: Sequence[np.ndarray], narrowest: float = 0.0) -> Tiling:
    """Cut convex holes (n, 2) out of the stones; one around a single corner of a hole stays whole.

    Pieces narrower than that [m] are stones of their own: lips along a hole, for `merged` to give to a neighbour.
    """
    for hole in holes:
        tiling = _Cut(tiling, hole).outside(narrowest)
    return tiling


def within(tiling: Tiling, outline: np.ndarray) -> Tiling:
    """Cut the stones to a convex outline (n, 2)."""
    return _Cut(tiling, outline).inside()


class _Cut:
    """Stones cut by the sides of a convex polygon; new corners are made once for both stones at an edge."""

    def __init__(self, tiling: Tiling, shape: np.ndarray):
        self.tiling, self.shape = tiling, shape
        self.ends = np.roll(shape, -1, axis=0)
        self.corners = list(tiling.corners)
        self.new: dict[tuple[int, int, int], int] = {}  # (edge, side of the polygon) -> corner
        self.on_edge: dict[tuple[int, int], list[int]] = defaultdict(list)
        self.split: set[int] = set()  # ends of the edges on which there are new corners
        self.gap = SAME * polygon.size(tiling.corners)
        arms = tiling.corners[:, None] - shape
        self.left = _left_of(self.ends - shape, arms, self.gap)  # of each corner from each side [m], (n, n_sides)

    def outside(self, narrowest: float) -> Tiling:
        """Return the parts of the stones outside the polygon."""
        loops = self.tiling.stones
        counts = [len(loop) for loop in loops]
        if not loops:
            return self._whole([])
        furthest = np.maximum.reduceat(self.left[np.concatenate(loops)], np.cumsum([0, *counts[:-1]]))
        clear: np.ndarray = np.any(furthest <= 0.0, axis=1)  # wholly beyond a side, as nearly all are
        return self._whole(
            [
                [loop] if far else self._without(k, narrowest)
                for k, (loop, far) in enumerate(zip(loops, clear, strict=True))
            ]
        )

    def inside(self) -> Tiling:
        """Return the parts of the stones inside the polygon."""
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
        loops, courses = [], []
        for course, some in zip(self.tiling.courses, pieces, strict=True):
            found = [_without_ways_back(self._with_new_corners(loop)) for loop in some]
            loops += [loop for loop in found if loop]
            courses += [course for loop in found if loop]
        idle = self._idle(loops)
        return Tiling(np.array(self.corners), [tuple(i for i in loop if i not in idle) for loop in loops], courses)

    def _idle(self, loops: Sequence[Loop]) -> set[int]:
        """Find new corners on straight edges at which no third edge ends."""
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
        """Sort the sides by steepness, so that a piece beside a hole has its full height."""
        along = np.abs(self.ends - self.shape)
        slopes: list[int] = np.argsort(along[:, 0] / np.hypot(*along.T), kind="stable").tolist()
        return slopes

    def _sharp_corners(self) -> np.ndarray:
        """Return the corners of the polygon where it turns by more than 60°."""
        along = self.ends - self.shape
        along = along / np.hypot(*along.T)[:, None]
        return self.shape[(along * np.roll(along, 1, axis=0)).sum(axis=1) < 0.5]

    def _half(self, loop: Loop, side: int, sign: float) -> Loop:
        """Return the piece of a convex loop to the left (1) or the right (-1) of a side of the polygon; (): none."""
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
        """Return the signed distance of a corner to the left of a side [m]; 0 on its line."""
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
            self.split |= {i, j}
        return self.new[key]

    def _with_new_corners(self, loop: Loop) -> Loop:
        """Insert all corners that were made on the edges of a loop."""
        if self.split.isdisjoint(loop):
            return loop
        found: list[int] = []
        for i, j in around(loop):
            between = self._all_between(min(i, j), max(i, j))
            found += [i, *(between if i < j else between[::-1])]
        return tuple(found)

    def _all_between(self, i: int, j: int) -> list[int]:
        """Return the corners made on an edge and on its pieces, from i to j."""
        if not self.on_edge.get((i, j)):
            return []
        start, along = self.corners[i], self.corners[j] - self.corners[i]
        near = sorted(self.on_edge[i, j], key=lambda m: float(product(self.corners[m] - start, along)))
        chain, found = [i, *near, j], []
        for a, b in zip(chain[:-1], chain[1:], strict=True):
            inner = self._all_between(min(a, b), max(a, b))
            found += [*(inner if a < b else inner[::-1]), b]
        return found[:-1]


def _without_ways_back(loop: Loop) -> Loop:
    """Remove spikes that go to a corner and straight back; (): nothing else is left of the loop."""
    found = list(loop)
    while len(set(found)) < len(found):
        back = [k for k in range(len(found)) if found[k - 1] == found[(k + 1) % len(found)]]
        if not back:
            break
        found = [i for k, i in enumerate(found) if k not in (back[0], (back[0] - 1) % len(found))]
    return tuple(found) if len(found) > 2 else ()


def _left_of(along: np.ndarray, arms: np.ndarray, gap: float) -> np.ndarray:
    """Return signed distances of points to the left of lines [m]: directions (m, 2), arms from the lines (n, m, 2)."""
    away = (along[:, 0] * arms[:, :, 1] - along[:, 1] * arms[:, :, 0]) / np.hypot(*along.T)
    found: np.ndarray = np.where(np.abs(away) <= gap, 0.0, away)
    return found


def _strictly_inside(outline: np.ndarray, point: np.ndarray, gap: float) -> bool:
    """Test whether a point lies within a simple polygon, further than `gap` from its sides."""
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
