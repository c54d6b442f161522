"""Elevation of one wall of a building: courses in blocks around openings and pockets, under a gable."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.structures.building.bond import SHORTEST, Ends, laid
from dem_cli.structures.building.plan import Axis
from dem_cli.structures.building.runs import Run
from dem_cli.structures.building.table import PlanWall

SMALL = 1e-6  # of a block: shorter is nothing


class Hole(NamedTuple):
    """A rectangle of the elevation without blocks of the wall: an opening or its lintel [m]."""

    left: float
    right: float
    low: float
    high: float
    opening: int


class Pocket(NamedTuple):
    """A stretch of one course where a floor leaves the wall less than its thickness, or nothing [m]."""

    left: float
    right: float
    course: int  # from 0
    across: tuple[float, float]  # what is left of the wall, from its right to its left; empty: nothing


class Stone(NamedTuple):
    """One block as laid: a box along the wall, or several, and where it is cut askew."""

    name: str
    course: int  # from 1
    boxes: tuple[tuple[float, ...], ...]  # each [left, low, right, high, from, to across] [m]
    start: np.ndarray | None = None  # end of its run that it is cut along
    stop: np.ndarray | None = None
    material: str = ""


class Stretch(NamedTuple):
    """A part of a run with the same heights free all along."""

    left: float
    right: float
    free: tuple[tuple[float, float], ...]  # from where to where up [m]
    across: tuple[float, float]


@dataclass(frozen=True)
class Elevation:
    """What a wall is laid from. Lengths along it from the start of its axis, heights from its foot [m]."""

    number: int  # of the wall, in the case
    axis: Axis
    table: PlanWall
    length: float  # of a full block
    levels: np.ndarray  # bed joints, with those of the gable
    eaves: float  # where a gable begins
    runs: Sequence[Sequence[Run]]  # of each course
    pockets: Sequence[Pocket]

    @cached_property
    def span(self) -> tuple[float, float]:
        """The outermost places of the wall."""
        low = min(float(run.start.min()) for runs in self.runs for run in runs)
        return low, max(float(run.stop.max()) for runs in self.runs for run in runs)

    @cached_property
    def holes(self) -> list[Hole]:
        """Openings and lintels. Raises KeyProblem where one does not lie within the wall."""
        found = []
        for i, opening in enumerate(self.table.openings):
            left, right = opening.x, opening.x + opening.width
            low, high = opening.y, opening.y + opening.height
            found.append(Hole(left, right, low, high, i))
            if opening.lintel is not None:
                bearing = opening.lintel.bearing
                found.append(Hole(left - bearing, right + bearing, high, high + opening.lintel.height, i))
        for hole in found:
            self._check(hole)
        return found

    def roof(self, height: float) -> tuple[float, float]:
        """From where to where the wall goes at a height: under the gable it narrows."""
        low, high = self.span
        gable = self.table.gable
        if gable is None or height <= self.eaves:
            return low, high
        inwards = 0.5 * (high - low) * (height - self.eaves) / gable.height
        return low + inwards, high - inwards

    def roof_planes(self) -> list[tuple[np.ndarray, float]]:
        """Normals (3,) and heights of both slopes of the gable, in coordinates of the wall."""
        if self.table.gable is None:
            return []
        (low, high), rise = self.span, self.table.gable.height
        half = 0.5 * (high - low)
        slope = math.hypot(half, rise)
        normals = [np.array([sign * rise, 0.0, half]) / slope for sign in (-1.0, 1.0)]
        feet = (np.array([low, 0.0, self.eaves]), np.array([high, 0.0, self.eaves]))
        return [(normal, float(normal @ foot)) for normal, foot in zip(normals, feet, strict=True)]

    def _check(self, hole: Hole) -> None:
        top = float(self.levels[-1])
        if hole.high > top + SMALL * self.length:
            message = f"it reaches up to {hole.high:g}; wall '{self.axis.name}' is {top:g} high"
            raise KeyProblem(message, *self._key(hole))
        low, high = self.roof(hole.high)
        if hole.left < low - SMALL * self.length or hole.right > high + SMALL * self.length:
            message = f"it goes from {hole.left:g} to {hole.right:g} along wall '{self.axis.name}', "
            raise KeyProblem(f"{message}which goes from {low:g} to {high:g} there", *self._key(hole))

    def _key(self, hole: Hole) -> tuple[str | int, ...]:
        return ("walls", self.number, "openings", hole.opening)

    # -- joints that are given before any block is laid ---------------------------------------------------------

    def joints(self, course: int) -> list[float]:
        """Upright joints of a course that are there however it is laid: ends of runs, jambs, pockets."""
        if not 0 <= course < len(self.runs):
            return []
        found = [float(x) for run in self.runs[course] for line in run for x in set(line.tolist())]
        for hole in self._beside(course):
            found += [hole.left, hole.right]
        for pocket in self._pockets(course):
            found += [pocket.left, pocket.right]
        return found

    def _beside(self, course: int) -> list[Hole]:
        low, high = self.levels[course : course + 2]
        small = SMALL * self.length
        return [hole for hole in self.holes if hole.low < high - small and hole.high > low + small]

    def _pockets(self, course: int) -> list[Pocket]:
        return [pocket for pocket in self.pockets if pocket.course == course]

    def ends(self, run: Run, course: int) -> Ends:
        """Ends of a run, with what they are askew in plan and along the slopes of a gable."""
        foot, head = (self.roof(float(level)) for level in self.levels[course : course + 2])
        start, stop = np.maximum(run.start, foot[0]), np.minimum(run.stop, foot[1])
        inner = max(float(start.max()), head[0]), min(float(stop.min()), head[1])
        outer = float(start.min()), float(stop.max())
        middles = [0.5 * (a + b) for a, b in zip(inner, outer, strict=True)]
        return Ends(*middles, inner[0] - middles[0], middles[1] - inner[1])

    @cached_property
    def first(self) -> float:
        """A place to which the heads of odd courses belong; those of even ones lie between them.

        Of those that suit an end of a run, the one with which the lowest courses cost least, openings left aside.
        """
        courses = [k for k in range(min(4, len(self.runs))) if self.levels[k] < self.eaves]
        tried: dict[float, float] = {}
        for k in courses:
            for run in self.runs[k]:
                ends = self.ends(run, k)
                for place in (ends.start, ends.stop):
                    for shift in (0.0, 0.5):
                        first = round((place / self.length + shift + 0.5 * (k % 2)) % 1.0, 9) * self.length
                        tried.setdefault(first % self.length, 0.0)
        for first in tried:
            tried[first] = sum(self._cost(k, first) for k in courses)
        least = min(tried.values())
        return next(first for first, cost in tried.items() if cost <= least + 1e-9)

    def _cost(self, course: int, first: float) -> float:
        near = [x for k in (course - 1, course + 1) if 0 <= k < len(self.runs) for run in self.runs[k]
                for line in run for x in set(line.tolist())]  # fmt: skip
        return sum(
            laid(self.ends(run, course), self.length, self.place(course, first), np.array(near)).cost
            for run in self.runs[course]
        )

    def place(self, course: int, first: float) -> float:
        """A place to which heads of a course belong."""
        return first + 0.5 * self.length * (course % 2)

    # -- courses ---------------------------------------------------------------------------------------------------

    def stones(self) -> list[Stone]:
        """All blocks, course by course from below, lintels last. Raises KeyProblem where a piece would be too small."""
        found = []
        for course in range(len(self.runs)):
            row = [stone for run in self.runs[course] for stone in self._of_run(run, course)]
            row.sort(key=lambda stone: stone.boxes[0][:2])
            found += [stone._replace(name=f"{self.axis.name}-{course + 1}-{n}") for n, stone in enumerate(row, start=1)]
        return found + self._lintels()

    def _lintels(self) -> list[Stone]:
        right, left = self.axis.faces
        found = []
        for i, opening in enumerate(self.table.openings):
            if opening.lintel is None:
                continue
            lintel = self.holes[[hole.opening for hole in self.holes].index(i) + 1]
            box = (lintel.left, lintel.low, lintel.right, lintel.high, right, left)
            found.append(Stone(f"{self.axis.name}-lintel-{i + 1}", 0, (box,), material=opening.lintel.material))
        return found

    def _of_run(self, run: Run, course: int) -> list[Stone]:
        ends = self.ends(run, course)
        avoid = np.array(self.joints(course - 1) + self.joints(course + 1))
        first, found, row = self.place(course, self.first), [], self._stretches(run, ends, course)
        outer = ends.start - ends.start_askew, ends.stop + ends.stop_askew
        for stretch in row:
            at_start, at_stop = stretch.left == ends.start, stretch.right == ends.stop
            part = Ends(stretch.left, stretch.right, ends.start_askew * at_start, ends.stop_askew * at_stop)
            heads = laid(part, self.length, first, avoid).heads if stretch.free else np.zeros(0)
            if at_start and at_stop and self._is_tip(course):
                count = math.ceil((outer[1] - outer[0]) / self.length - SMALL)
                heads = outer[0] + (outer[1] - outer[0]) * np.arange(1, count) / count
            limits = [outer[0] if at_start else stretch.left, *heads.tolist(), outer[1] if at_stop else stretch.right]
            for n, (a, b) in enumerate(pairwise(limits)):
                start = run.start if at_start and n == 0 else None
                stop = run.stop if at_stop and n == len(limits) - 2 else None
                for low, high in stretch.free:
                    found.append(Stone("", course + 1, ((a, low, b, high, *stretch.across),), start, stop))
        return self._joined(found, course)

    def _is_tip(self, course: int) -> bool:
        """Whether it is the course under the tip of a gable."""
        return self.table.gable is not None and course == len(self.runs) - 1

    def _stretches(self, run: Run, ends: Ends, course: int) -> list[Stretch]:
        """A run, cut where what is free changes. Raises KeyProblem: an opening in another wall, slivers beside it."""
        small = SMALL * self.length
        holes = [h for h in self._beside(course) if h.left < ends.stop - small and h.right > ends.start + small]
        inner = ends.start + ends.start_askew, ends.stop - ends.stop_askew
        for hole in holes:
            if hole.left < inner[0] - small or hole.right > inner[1] + small:
                message = f"it goes from {hole.left:g} to {hole.right:g} along wall '{self.axis.name}', which is free "
                message += f"of other walls from {inner[0]:.6g} to {inner[1]:.6g}"
                raise KeyProblem(message, *self._key(hole))
        pockets = self._pockets(course)
        edges = {x for thing in (*holes, *pockets) for x in (thing.left, thing.right)}
        between = sorted(x for x in edges if inner[0] + small < x < inner[1] - small)
        between = [x for x, before in zip(between, [-math.inf, *between]) if x - before > small]
        low, high = (float(level) for level in self.levels[course : course + 2])
        found: list[Stretch] = []
        for a, b in pairwise([ends.start, *between, ends.stop]):
            middle = 0.5 * (a + b)
            over = [hole for hole in holes if hole.left < middle < hole.right]
            across = self._left_over([p.across for p in pockets if p.left < middle < p.right])
            free = self._free(low, high, over) if across[1] > across[0] else ()
            if found and found[-1][2:] == (free, across):
                found[-1] = found[-1]._replace(right=b)
            else:
                found.append(Stretch(a, b, free, across))
        self._check_lengths(found, course, holes)
        return found

    def _left_over(self, across: Sequence[tuple[float, float]]) -> tuple[float, float]:
        """What pockets leave of the thickness."""
        right, left = self.axis.faces.tolist()
        return max([right, *(a for a, _ in across)]), min([left, *(b for _, b in across)])

    def _free(self, low: float, high: float, over: Sequence[Hole]) -> tuple[tuple[float, float], ...]:
        """Heights of a course that holes leave. Raises KeyProblem where that is less than a quarter of a course."""
        found, at = [], low
        for hole in (*sorted(over, key=lambda each: each.low), None):
            until = high if hole is None else hole.low
            height = until - at
            if height > SMALL * (high - low):
                if height < SHORTEST * (high - low) * (1.0 - SMALL):
                    near = hole or max(over, key=lambda each: each.high)
                    message = f"a piece {height:.3g} m high is left of the course from {low:g} to {high:g}; "
                    message += "let the opening and its lintel end at bed joints, or a quarter of a course from them"
                    raise KeyProblem(message, *self._key(near))
                found.append((at, until))
            at = max(at, high if hole is None else hole.high)
        return tuple(found)

    def _check_lengths(self, row: Sequence[Stretch], course: int, holes: Sequence[Hole]) -> None:
        """Raises KeyProblem where a stretch is too short for a block."""
        least = SHORTEST * self.length * (1.0 - SMALL)
        for stretch in row:
            length = stretch.right - stretch.left
            if not stretch.free or length >= least or stretch.across != tuple(self.axis.faces.tolist()):
                continue
            where = f"{length:.3g} m long, at {stretch.left:.4g} m in course {course + 1} of wall '{self.axis.name}'"
            near = [h for h in holes if min(abs(h.left - stretch.right), abs(h.right - stretch.left)) < least]
            key = self._key(near[0]) if near else ("walls", self.number, "axis")
            raise KeyProblem(f"a piece is left that is too short, {where}; at least a quarter of a block", *key)

    def _joined(self, stones: list[Stone], course: int) -> list[Stone]:
        """Pieces behind narrow pockets become part of the stone beside them."""
        least, found = SHORTEST * self.length * (1.0 - SMALL), list[Stone]()
        for stone in stones:
            left, low, right, high = stone.boxes[0][:4]
            narrow = right - left < least and stone.boxes[0][4:] != tuple(self.axis.faces.tolist())
            if narrow and found and found[-1].boxes[0][1:4] == (low, left, high):
                found[-1] = found[-1]._replace(boxes=(*found[-1].boxes, stone.boxes[0]), stop=stone.stop)
            else:
                found.append(stone)
        return found
