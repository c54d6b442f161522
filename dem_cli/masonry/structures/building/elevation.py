"""Elevation of one wall of a building: openings, pockets of floors, the slopes of a gable, joints that are given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.bonding import BondKeys
from dem_cli.masonry.structures.building.bond import RunEnds
from dem_cli.masonry.structures.building.plan import PlanAxis
from dem_cli.masonry.structures.building.runs import Run
from dem_cli.masonry.structures.building.table import PlanWall
from dem_cli.masonry.structures.course_layout import Interruption, interruption
from dem_cli.masonry.structures.voids import Void

SMALL = 1e-6  # of a block: shorter is nothing


Box = tuple[float, float, float, float]  # left, low, right, high [m]


class Hole(NamedTuple):
    """A rectangle of the elevation without whole blocks of the wall: an opening, its lintel, its arch [m]."""

    left: float
    right: float
    low: float
    high: float
    opening: int
    arch: Interruption | None = None  # as it narrows upwards


class Pocket(NamedTuple):
    """A stretch of one course where a floor leaves the wall less than its thickness, or nothing [m]."""

    left: float
    right: float
    course: int  # from 0
    across: tuple[float, float]  # what is left of the wall, from its right to its left; empty: nothing


@dataclass(frozen=True)
class WallElevation:
    """What a wall is laid around. Lengths along it from the start of its axis, heights from its foot [m]."""

    number: int  # of the wall, in the case
    axis: PlanAxis
    table: PlanWall
    length: float  # of a full block
    keys: BondKeys  # of the building
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
    def voids(self) -> list[Void]:
        """Openings with what is built over them. Raises KeyProblem where one does not lie within the wall."""
        found = [opening.void.fitted(self.levels) for opening in self.table.openings]
        for i, void in enumerate(found):
            self._check(void.reach, i)
        return found

    def holes(self, course: int) -> list[Hole]:
        """What openings take of a course."""
        return self._holes[course]

    @cached_property
    def _holes(self) -> list[list[Hole]]:
        found: list[list[Hole]] = [[] for _ in self.runs]
        small = SMALL * self.length
        for i, void in enumerate(self.voids):
            for course in self._beside(void.reach[1], void.reach[3]):
                low, high = (float(level) for level in self.levels[course : course + 2])
                if len(void.joints):
                    stops = interruption(void, low, high, small)
                    found[course] += [] if stops is None else [Hole(*stops.ends, low, high, i, stops)]
                    continue
                boxes = [box for box in void.boxes if box[1] < high - small and box[3] > low + small]
                found[course] += [Hole(x0, x1, y0, y1, i) for x0, y0, x1, y1 in boxes]
        return found

    def _beside(self, low: float, high: float) -> range:
        """Courses between two heights."""
        small = SMALL * self.length
        first = int(np.searchsorted(self.levels, low + small, side="right")) - 1
        return range(max(first, 0), min(int(np.searchsorted(self.levels, high - small)), len(self.runs)))

    @cached_property
    def outline(self) -> tops.Profile | None:
        """The slopes of a gable; None: there is none."""
        gable = self.table.gable
        return None if gable is None else tops.gable_profile(gable, *self.span, self.eaves)

    @property
    def top(self) -> tops.Profile | None:
        """Along which courses are cut; None: the top is level, or stepped."""
        return None if self.is_stepped else self.outline

    @property
    def is_stepped(self) -> bool:
        """Whether it has a gable in steps."""
        return self.table.gable is not None and self.table.gable.edges == "stepped"

    def roof(self, height: float) -> tuple[float, float]:
        """From where to where the wall goes at a height: under a gable it narrows."""
        return self.span if self.outline is None else tops.level_span(self.outline, height)

    def roof_of(self, course: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """The same at the foot and at the head of a course; of a step in its middle."""
        low, high = (float(level) for level in self.levels[course : course + 2])
        if self.is_stepped and low >= self.eaves:
            low = high = 0.5 * (low + high)
        return self.roof(low), self.roof(high)

    def _check(self, reach: Box, i: int) -> None:
        left, _, right, height = reach
        top, small = float(self.levels[-1]), SMALL * self.length
        if height > top + small:
            raise KeyProblem(f"it reaches up to {height:g}; wall '{self.axis.name}' is {top:g} high", *self._key(i))
        low, high = self.roof(height)
        if left < low - small or right > high + small:
            message = f"it goes from {left:g} to {right:g} along wall '{self.axis.name}', which goes from {low:g} to "
            raise KeyProblem(f"{message}{high:g} there", *self._key(i))

    def _key(self, opening: int) -> tuple[str | int, ...]:
        return ("walls", self.number, "openings", opening)

    # -- joints that are given before any block is laid ---------------------------------------------------------

    def joints(self, course: int) -> list[float]:
        """Upright joints of a course that are there however it is laid: ends of runs, jambs, pockets."""
        if not 0 <= course < len(self.runs):
            return []
        found = [float(x) for run in self.runs[course] for line in run for x in set(line.tolist())]
        for hole in self.holes(course):
            found += [hole.left, hole.right]
        for pocket in self._pockets(course):
            found += [pocket.left, pocket.right]
        return found

    def _pockets(self, course: int) -> list[Pocket]:
        return [pocket for pocket in self.pockets if pocket.course == course]

    def ends(self, run: Run, course: int) -> RunEnds:
        """Ends of a run, with what they are askew in plan and along the slopes of a gable."""
        foot, head = self.roof_of(course)
        start, stop = np.maximum(run.start, foot[0]), np.minimum(run.stop, foot[1])
        inner = max(float(start.max()), head[0]), min(float(stop.min()), head[1])
        outer = float(start.min()), float(stop.max())
        first, last = 0.5 * (inner[0] + outer[0]), 0.5 * (inner[1] + outer[1])
        return RunEnds(first, last, inner[0] - first, last - inner[1])

    @property
    def across(self) -> tuple[float, float]:
        """Its two faces across, right and left of the axis [m]."""
        right, left = self.axis.faces.tolist()
        return right, left
