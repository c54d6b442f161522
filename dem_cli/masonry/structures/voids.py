"""Voids in masonry: openings, lintels and arches cut out of the courses, in elevation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import cuts, polygon

Box = tuple[float, float, float, float]  # left, bottom, right, top [m]
Span = tuple[float, float]  # from where to where along the wall [m]
NEAR_BED = 0.08  # of a course: outer corners of voussoirs so close to a bed joint are drawn out or in to lie on it
NEAR_CORNER = 0.3  # of the smaller side of a shape
LEAST_SLOPE = 0.3  # sine of the slope of a joint of an arch, below which its corner stays where it is


class Void(NamedTuple):
    """Void of an opening with its lintel or arch."""

    boxes: tuple[Box, ...]  # the opening where it is rectangular, its lintel
    joints: np.ndarray  # of its arch [inner, outer] from left to right, (n + 1, 2, 2) [m]; (0, 2, 2): it has none
    full: bool = False  # a ring of voussoirs: joints go round clockwise, the first is the last as well
    shapes: tuple[np.ndarray, ...] = ()  # convex polygons with nothing over them, counter-clockwise [m], each (n, 2)

    @property
    def voussoirs(self) -> list[np.ndarray]:
        """Shapes of the voussoirs from left to right, of a ring clockwise from below."""
        found = [np.array([a[0], b[0], b[1], a[1]]) for a, b in zip(self.joints[:-1], self.joints[1:], strict=True)]
        return [polygon.simplified(shape) for shape in found]

    @property
    def outline(self) -> np.ndarray:
        """Convex outline of the arch and the opening below it, counter-clockwise, (n, 2)."""
        outer = self.joints[::-1, 1]
        return outer[1:] if self.full else np.concatenate([self.joints[[0, -1], 0], outer])

    @property
    def outlines(self) -> list[np.ndarray]:
        """Convex shapes that form the void; they may overlap."""
        boxes = [polygon.rectangle(x0, y0, x1 - x0, y1 - y0) for x0, y0, x1, y1 in self.boxes]
        return [*boxes, *self.shapes, *([self.outline] if len(self.joints) else [])]

    @property
    def solids(self) -> list[np.ndarray]:
        """Convex shapes of the hole, its lintel and its voussoirs."""
        return self.outlines[: len(self.boxes) + len(self.shapes)] + self.voussoirs

    @property
    def reach(self) -> Box:
        """Bounding box of the void."""
        corners = np.concatenate(self.outlines)
        (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return (x0, y0, x1, y1)

    def fitted(self, levels: np.ndarray) -> Void:
        """Move the outer corners of the arch off nearby bed joints, along their joints."""
        joints = self.joints.copy()
        for k, (inner, outer) in enumerate(self.joints):
            way = (outer - inner) / np.hypot(*(outer - inner))
            bed = int(np.abs(levels - outer[1]).argmin())
            course = np.diff(levels)[max(bed - 1, 0) : bed + 1].min()
            up = levels[bed] - outer[1]
            if abs(way[1]) > LEAST_SLOPE and 0.0 < abs(up) <= NEAR_BED * course:
                joints[k, 1] = [outer[0] + way[0] / way[1] * up, levels[bed]]
        if self.full:
            joints[-1] = joints[0]
        found = self._replace(joints=joints)
        return found if all(map(polygon.is_convex, [*found.outlines, *found.voussoirs])) else self

    def span_at(self, level: float, side: int, gap: float) -> Span | None:
        """Return the span just above a level (side: 1) or just below it (−1); None: not there."""
        ends = [end for shape in self.outlines for end in _crossing(shape, level, side * gap)]
        return (min(ends), max(ends)) if ends else None

    def stops(self, low: float, high: float, gap: float) -> list[float]:
        """Return the places along a course where the outline has corners or meets a bed joint."""
        found: list[float] = []
        for shape in self.outlines:
            inside = (shape[:, 1] > low + gap) & (shape[:, 1] < high - gap)
            found += [*shape[inside, 0].tolist(), *_crossing(shape, low, gap), *_crossing(shape, high, -gap)]
        return found

    def left_of(self, shape: np.ndarray, gap: float) -> list[np.ndarray]:
        """Subtract the void from a convex polygon, in convex pieces."""
        pieces = [shape]
        for box in self.boxes:
            pieces = [rest for piece in pieces for rest in cuts.less_box(piece, box, gap)]
        for hole in self.shapes:
            pieces = [rest for piece in pieces for rest in cuts.less_convex(piece, hole, gap)]
        if len(self.joints):
            pieces = [rest for piece in pieces for rest in self._around_arch(piece, gap)]
        return pieces

    def _around_arch(self, shape: np.ndarray, gap: float) -> list[np.ndarray]:
        """Divide the rest of a polygon outside the arch by its extended joints."""
        if not self._meets_arch(shape, gap):
            return [shape]
        joints, found, rest = self.joints, [], shape
        if not self.full:
            rest, under = cuts.halves(rest, joints[0, 0], joints[-1, 0], gap)
            left = cuts.halves(rest, joints[0, 0], joints[0, 1], gap)[0]
            right = cuts.halves(rest, joints[-1, 0], joints[-1, 1], gap)[1]
            found += [under, left, right]
        aimed = _aimed(joints, shape, self.full)
        for a, b in zip(aimed[:-1], aimed[1:], strict=True):
            wedge = cuts.halves(cuts.halves(rest, a[0], a[1], gap)[1], b[0], b[1], gap)[0]
            found.append(cuts.halves(wedge, a[1], b[1], gap)[0])
        return [piece for piece in found if len(piece)]

    def _meets_arch(self, shape: np.ndarray, gap: float) -> bool:
        rest, outline = shape, self.outline
        for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            if np.hypot(*(end - start)) > gap:
                rest = cuts.halves(rest, start, end, gap)[0]
        return len(rest) > 0


def plain_void(shape: np.ndarray) -> Void:
    """Create a void of a convex polygon (n, 2), with nothing built over it."""
    box, no_arch = polygon.upright_box(shape), np.empty((0, 2, 2))
    return Void((box,), no_arch) if box else Void((), no_arch, shapes=(shape,))


def _aimed(joints: np.ndarray, shape: np.ndarray, full: bool) -> np.ndarray:
    """Turn joints of an arch about their outer corner where they would end close to a corner of a shape.

    No further than half of the angle between the outer faces there, so that pieces stay convex.
    """
    found, outer = joints.copy(), joints[:, 1]
    near = NEAR_CORNER * float(np.ptp(shape, axis=0).min())
    chords = np.diff(outer, axis=0)
    for k in range(len(joints)):
        if not full and k in (0, len(joints) - 1):
            continue  # springing joints
        before, after = chords[k - 1], chords[k % len(chords)]
        turn = functions.arctan2(abs(before[0] * after[1] - before[1] * after[0]), product(before, after))
        way = (outer[k] - joints[k, 0]) / np.hypot(*(outer[k] - joints[k, 0]))
        arms = shape - outer[k]
        off = np.abs(arms[:, 0] * way[1] - arms[:, 1] * way[0])
        ahead = np.flatnonzero((off < near) & (off < 0.99 * functions.tan(turn / 2.0) * product(arms, way)))
        if len(ahead):
            found[k, 0] = 2.0 * outer[k] - shape[ahead[off[ahead].argmin()]]
    return found


def _crossing(shape: np.ndarray, level: float, above: float) -> list[float]:
    """Return where the edges of a convex polygon cross a level: none or two places.

    above: corners so far above the level lie on it [m], negative: below.
    """
    heights = shape[:, 1] - level
    after, heights_after = np.roll(shape, -1, axis=0), np.roll(heights, -1)
    found = np.flatnonzero((heights <= above) != (heights_after <= above))
    share = np.clip(heights[found] / (heights[found] - heights_after[found]), 0.0, 1.0)
    return (shape[found, 0] + share * (after[found, 0] - shape[found, 0])).tolist()


def overlap(a: Sequence[np.ndarray], b: Sequence[np.ndarray]) -> float:
    """Return the largest area that a convex shape of one list shares with one of the other [m2]."""
    from dem_cli.core.geometry.compounds import clipped

    shared = [clipped(p, q) for p in a for q in b if (p.min(0) < q.max(0)).all() and (q.min(0) < p.max(0)).all()]
    return max((polygon.area(common) for common in shared if len(common) > 2), default=0.0)
