"""Build walls of irregular stones: dressed stones where walls meet and at free ends, a pattern between them.

The dressed stones are those of the regular courses that touch another wall or an end, long and short in turn, and
those beside floors. What is left, without openings, is the panel that a pattern fills.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.building.courses import WallCourses
from dem_cli.masonry.structures.building.elevation import SMALL
from dem_cli.masonry.structures.building.jambs import jamb_stones
from dem_cli.masonry.structures.building.patterns import CoursedRubble, VoronoiRubble
from dem_cli.masonry.structures.building.plan import Plan
from dem_cli.masonry.structures.building.table import Building
from dem_cli.masonry.structures.leaves import numbered
from dem_cli.masonry.structures.patterns.panel import LEAST_SHARE, WallPanel, blocks_of
from dem_cli.masonry.structures.patterns.tiling import Tiling
from dem_cli.masonry.structures.stones import Part, Stone, put_together
from dem_cli.masonry.structures.voids import overlap

T = TypeVar("T")
Span = tuple[float, float]
NamedStone = tuple[str, Stone]
SQUARE = 1e-9  # cosine of the angle of walls that meet squarely


class Zone(NamedTuple):
    """Zone of a wall that another wall occupies [m]."""

    left: float
    right: float
    courses: int  # as many of them meet it
    inner: bool  # whether this wall goes on beyond it


def zones_of(building: Building, plan: Plan, wall: WallCourses) -> list[Zone]:
    """Find the zones of other walls in one. Raises KeyProblem where a gable would have to be cut along another wall."""
    found, own = [], len(wall.levels) - 1 if wall.table.gable is None else wall.table.courses or building.courses
    key = ("walls", wall.number, "gable")
    if wall.is_stepped:
        raise KeyProblem("'stepped' is not allowed with a pattern; must be 'cut'", *key, "edges")
    for junction in plan.met(wall.number):
        mine = junction.of(wall.number)
        other = junction.walls[1 - mine]
        count = building.walls[other].courses or building.courses
        askew = abs(float(product(plan.axes[wall.number].along, plan.axes[other].along)))
        if wall.table.gable is not None and count > own:
            message = f"wall '{building.walls[other].id}' meets it above its courses: with a pattern only below"
            raise KeyProblem(message, *key)
        if wall.table.gable is not None and junction.ends[mine] and askew > SQUARE:
            message = f"wall '{building.walls[other].id}' meets it askew: with a pattern a gable has square ends"
            raise KeyProblem(message, *key)
        found.append(Zone(*plan.zone(wall.number, junction), min(count, own), not junction.ends[mine]))
    return found


class WallStones(NamedTuple):
    """Stones of a wall by name, dressed ones and others."""

    dressed: list[NamedStone]  # to be cut where walls meet askew
    others: list[NamedStone]


@dataclass(frozen=True)
class IrregularWall:
    """Wall of a building that a pattern of irregular stones fills."""

    courses: WallCourses
    zones: Sequence[Zone]
    pattern: VoronoiRubble | CoursedRubble
    seed: int

    def stones(self) -> WallStones:
        """Generate all stones. Raises KeyProblem for what the pattern cannot fill."""
        prefix = f"{self.courses.axis.name}-dressed"
        dressed = [(f"{prefix}-{name}", stone) for name, stone in numbered(self._kept)]
        jambs = [
            (f"{self.courses.axis.name}-{name}", Stone(0, (Part(shape, self.courses.across),), 0.0))
            for name, shape in self._jambs
        ]
        return WallStones(dressed, [*self._pattern_stones(), *jambs, *self.courses.over_openings()])

    # -- dressed stones -------------------------------------------------------------------------------------------

    @cached_property
    def regular(self) -> WallCourses:
        """Wall in regular courses, without openings and gable."""
        wall = self.courses
        count = int(np.searchsorted(wall.levels, wall.eaves - self.small))
        table = wall.table.model_copy(update={"openings": (), "gable": None})
        return replace(wall, table=table, levels=wall.levels[: count + 1], runs=wall.runs[:count])

    @property
    def small(self) -> float:
        """Length below which a difference counts as zero [m]."""
        return SMALL * self.courses.length

    @cached_property
    def _laid(self) -> list[Stone]:
        return put_together(self.regular.laid_stones(), self.small)

    @cached_property
    def _intervals(self) -> list[list[Span]]:
        """Intervals of dressed masonry in each course [m], in order, apart from each other."""
        return [self._of_course(course) for course in range(len(self.regular.runs))]

    @cached_property
    def _kept(self) -> list[Stone]:
        """Stones of which a part lies in a dressed stretch."""
        return [stone for stone in self._laid if any(self._is_dressed(part) for part in stone.parts)]

    def _is_dressed(self, part: Part) -> bool:
        left, right, course = self._place(part)
        return any(a - self.small <= left and right <= b + self.small for a, b in self._intervals[course])

    def _place(self, part: Part) -> tuple[float, float, int]:
        """Return both ends of a part along the wall and its course, from 0."""
        (left, low), (right, high) = part.shape.min(axis=0).tolist(), part.shape.max(axis=0).tolist()
        return left, right, int(np.searchsorted(self.regular.levels, 0.5 * (low + high))) - 1

    def _of_course(self, course: int) -> list[Span]:
        """Return the dressed stretches of a course; a gap shorter than a block is dressed as well."""
        spans = [(left, right) for left, right in self._ends_and_zones[course] if right - left > self.small]
        spans += [(pocket.left, pocket.right) for pocket in self.courses.pockets if pocket.course == course]
        for stone in self._laid:
            places = [self._place(part) for part in stone.parts]
            thin = any(part.across != self.courses.across for part in stone.parts)
            if thin or any(self._touches(place) for place in places):
                spans += [(left, right) for left, right, k in places if k == course]
        return _joined(spans, self.courses.length * (1.0 - SMALL), self.small)

    def _touches(self, place: tuple[float, float, int]) -> bool:
        """Test whether a part [left, right, course] touches another wall or an end."""
        left, right, course = place
        return any(left <= b + self.small and right >= a - self.small for a, b in self._ends_and_zones[course])

    @cached_property
    def _ends_and_zones(self) -> list[list[Span]]:
        return [self._given(course) for course in range(len(self.regular.runs))]

    def _given(self, course: int) -> list[Span]:
        """Return both ends of a course and the walls that meet it, as intervals."""
        low, high = self.courses.span
        runs = self.regular.runs[course]
        met = [(max(z.left, low), min(z.right, high)) for z in self.zones if course < z.courses]
        return [(low, float(runs[0].start.max())), (float(runs[-1].stop.min()), high), *met]

    def _dressed_boxes(self) -> Iterator[np.ndarray]:
        """Yield dressed rectangles: first those common to many courses, then what protrudes from them."""
        low, high = self.courses.span
        inner = [((z.left, z.right), min(z.courses, len(self._intervals))) for z in self.zones if z.inner]
        whole = [((low, low), len(self._intervals)), ((high, high), len(self._intervals)), *inner]
        cores = [(self._core(span, count), count) for span, count in sorted(whole, key=lambda each: -each[1])]
        levels = self.regular.levels.tolist()
        done: list[Span] = []
        for (left, right), count in cores:
            for a, b in _without((left, right), done, self.small):
                yield _box(a, 0.0, b, levels[count])
            done.append((left, right))
        for course, found in enumerate(self._intervals):
            taken = [core for core, count in cores if course < count]
            for interval in found:
                for a, b in _without(interval, taken, self.small):
                    yield _box(a, levels[course], b, levels[course + 1])

    def _core(self, span: Span, count: int) -> Span:
        """Return the interval around a stretch that is dressed in each of the lowest `count` courses."""
        middle = 0.5 * (span[0] + span[1])
        around = [
            next((a, b) for a, b in found if a - self.small <= middle <= b + self.small)
            for found in self._intervals[:count]
        ]
        return max(a for a, _ in around), min(b for _, b in around)

    @cached_property
    def _boxes(self) -> list[np.ndarray]:
        return list(self._dressed_boxes())

    @cached_property
    def _jambs(self) -> list[tuple[str, np.ndarray]]:
        """Dressed stones beside openings by name."""
        return jamb_stones(self.courses, self._boxes) if self.pattern.jambs == "dressed" else []

    # -- the pattern ----------------------------------------------------------------------------------------------

    @cached_property
    def _panel(self) -> WallPanel:
        """Panel that the pattern fills."""
        wall, (low, high) = self.courses, self.courses.span
        outline = _box(low, 0.0, high, wall.eaves)
        if wall.table.gable is not None:
            outline = np.insert(outline, 3, tops.gable_profile(wall.table.gable, low, high, wall.eaves)[1], axis=0)
        boxes = self._boxes
        for i, void in enumerate(wall.voids):
            for box in boxes:
                if overlap([box], void.outlines) > self.small * wall.length:
                    (x0, y0), (x1, y1) = box[0].tolist(), box[2].tolist()
                    message = "it reaches into dressed stones where walls meet, end or carry a floor, from "
                    message += f"{x0:.4g} to {x1:.4g} m along wall '{wall.axis.name}', {y0:.4g} to {y1:.4g} m high"
                    raise KeyProblem(message, "walls", wall.number, "openings", i)
        jambs = [shape for _, shape in self._jambs]
        return WallPanel(outline, (*boxes, *jambs, *(shape for void in wall.voids for shape in void.outlines)))

    def _key(self) -> tuple[str | int, ...]:
        return ("walls", self.courses.number, "pattern") if self.courses.table.pattern is not None else ("pattern",)

    @cached_property
    def _mean(self) -> float:
        """Area of a mean stone [m2]."""
        panel = self._panel
        return self._of_pattern(lambda: self.pattern.mean(panel))

    @cached_property
    def tiling(self) -> Tiling:
        """Stones of the pattern. Raises KeyProblem for what it cannot fill."""
        wall, panel = self.courses, self._panel
        draws = np.random.default_rng([self.seed, *wall.axis.name.encode()])
        tiling, mean = self._of_pattern(lambda: self.pattern.stones_in(panel, draws)), self._mean
        if not tiling.stones:
            return tiling
        areas = tiling.areas()
        if areas.min() < LEAST_SHARE * mean * (1.0 - SMALL):
            x, y = polygon.centroid(tiling.outline(int(areas.argmin()))).tolist()
            message = f"a stone of {areas.min():.3g} m2 is left alone at {x:.4g} m along wall '{wall.axis.name}', "
            message += f"{y:.4g} m high; at least {LEAST_SHARE * mean:.3g}, a quarter of a mean stone: smaller ones, "
            raise KeyProblem(message + "or openings elsewhere", *self._key())
        return tiling

    def _of_pattern(self, drawn: Callable[[], T]) -> T:
        """Call a function of the pattern and add the name of the wall to its errors."""
        try:
            return drawn()
        except KeyProblem as problem:
            raise KeyProblem(f"{problem} (wall '{self.courses.axis.name}')", *self._key(), *problem.keys) from None

    def _pattern_stones(self) -> list[NamedStone]:
        wall, found = self.courses, []
        if not self.tiling.stones:
            return []
        for block in blocks_of(self.tiling, prefix=f"{wall.axis.name}-"):
            parts = tuple(Part(np.asarray(part), wall.across) for part in block.parts)
            found.append((block.id, Stone(block.course, parts, self._mean)))
        return found


def _box(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _joined(spans: Sequence[Span], gap: float, small: float) -> list[Span]:
    """Merge intervals that are closer than a gap, in order."""
    found: list[Span] = []
    for left, right in sorted(spans):
        if right - left <= small:
            continue
        if found and left - found[-1][1] < gap:
            found[-1] = (found[-1][0], max(found[-1][1], right))
        else:
            found.append((left, right))
    return found


def _without(span: Span, taken: Sequence[Span], small: float) -> list[Span]:
    """Subtract intervals from an interval."""
    found, at = [], span[0]
    for left, right in sorted(taken):
        if left - at > small and at < span[1]:
            found.append((at, min(left, span[1])))
        at = max(at, right)
    return [*found, (at, span[1])] if span[1] - at > small else found
