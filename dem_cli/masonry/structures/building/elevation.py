"""Elevation of one wall of a building: openings, floor pockets, gable slopes, and joints fixed beforehand."""

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

SMALL = 1e-6  # of a block: a shorter length counts as zero


Box = tuple[float, float, float, float]  # left, low, right, high [m]


class Hole(NamedTuple):
    """Rectangle of the elevation without whole blocks: an opening, its lintel, its arch [m]."""

    left: float
    right: float
    low: float
    high: float
    opening: int
    arch: Interruption | None = None  # as it narrows upwards


class Pocket(NamedTuple):
    """Pocket of a floor: a stretch of one course where it leaves the wall part of its thickness, or none [m]."""

    left: float
    right: float
    course: int  # from 0
    across: tuple[float, float]  # what is left of the wall, from its right to its left; empty: nothing


@dataclass(frozen=True)
class WallElevation:
    """Elevation of a wall before it is laid; lengths along its axis, heights from its foot [m]."""

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
        """Outermost places of the wall along its axis [m]."""
        low = min(float(run.start.min()) for runs in self.runs for run in runs)
        return low, max(float(run.stop.max()) for runs in self.runs for run in runs)

    @cached_property
    def voids(self) -> list[Void]:
        """Openings with lintels and arches. Raises KeyProblem where one does not lie within the wall."""
        found = [opening.void.fitted(self.levels) for opening in self.table.openings]
        for i, void in enumerate(found):
            self._check(void.reach, i)
        return found

    def holes(self, course: int) -> list[Hole]:
        """Return the holes that openings cut out of a course."""
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
        """Return the courses between two heights."""
        small = SMALL * self.length
        first = int(np.searchsorted(self.levels, low + small, side="right")) - 1
        return range(max(first, 0), min(int(np.searchsorted(self.levels, high - small)), len(self.runs)))

    @cached_property
    def outline(self) -> tops.Profile | None:
        """Slopes of a gable; None: there is none."""
        gable = self.table.gable
        return None if gable is None else tops.gable_profile(gable, *self.span, self.eaves)

    @property
    def top(self) -> tops.Profile | None:
        """Profile along which the uppermost courses are cut; None: the top is level, or stepped."""
        return None if self.is_stepped else self.outline

    @property
    def is_stepped(self) -> bool:
        """Tell whether the wall has a stepped gable."""
        return self.table.gable is not None and self.table.gable.edges == "stepped"

    def roof(self, height: float) -> tuple[float, float]:
        """Return both ends of the wall at a height: under a gable it narrows."""
        return self.span if self.outline is None else tops.level_span(self.outline, height)

    def roof_of(self, course: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return both ends of the wall at the foot and at the head of a course; of a step at mid-height."""
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
        """Return the fixed head joints of a course: ends of runs, jambs, pockets [m]."""
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
        """Return the ends of a run with their skew in plan and along the slopes of a gable."""
        foot, head = self.roof_of(course)
        start, stop = np.maximum(run.start, foot[0]), np.minimum(run.stop, foot[1])
        inner = max(float(start.max()), head[0]), min(float(stop.min()), head[1])
        outer = float(start.min()), float(stop.max())
        first, last = 0.5 * (inner[0] + outer[0]), 0.5 * (inner[1] + outer[1])
        return RunEnds(first, last, inner[0] - first, last - inner[1])

    @property
    def across(self) -> tuple[float, float]:
        """Right and left face of the wall, measured from the axis [m]."""
        right, left = self.axis.faces.tolist()
        return right, left
