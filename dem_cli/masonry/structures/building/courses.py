"""Lay the courses of one wall of a building: stones around openings and pockets, under a gable."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry import cuts
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.building.bond import SHORTEST, CourseBond, Laid, RunEnds, clearance, laid
from dem_cli.masonry.structures.building.elevation import SMALL, Box, Hole, WallElevation
from dem_cli.masonry.structures.building.runs import Run
from dem_cli.masonry.structures.courses import Pattern, are_through, pattern_of
from dem_cli.masonry.structures.leaves import depths_of, in_leaves, numbered
from dem_cli.masonry.structures.stones import Part, Stone, put_together

WELD = 1e-10  # of a block: round-off of corners that are the same


class Stretch(NamedTuple):
    """Stretch of a run along which the same heights are free of openings."""

    left: float
    right: float
    free: tuple[tuple[float, float], ...]  # from where to where up [m]
    across: tuple[float, float]

    def ends(self, askew: dict[float, float]) -> RunEnds:
        """Return the ends of the stretch; askew: how far stones extend beyond the middle of an end, by its place."""
        start, stop = askew.get(self.left, 0.0), askew.get(self.right, 0.0)
        return RunEnds(self.left + start, self.right - stop, start, stop)


class LaidPiece(NamedTuple):
    """Rectangle of masonry in elevation, before openings with arches and gables are cut."""

    box: Box
    across: tuple[float, float]  # of the wall, or what a floor leaves of it [m]
    whole: bool  # whether it goes through all leaves


class WallCourses(WallElevation):
    """Wall of a building laid in courses."""

    @cached_property
    def first(self) -> float:
        """Reference place of the head joints of odd courses; those of even ones lie between them.

        Of those that suit an end of a run, the one with which the lowest courses cost least, openings left aside.
        """
        courses = [k for k in range(min(4, len(self.runs))) if self.levels[k] < self.eaves]
        tried: dict[float, float] = {}
        for k in courses:
            for run in self.runs[k]:
                ends, bond = self.ends(run, k), self.bond(k, 0.0)
                period = bond.period / self.length
                begins = [float(step) / self.length - shift for step in bond.steps for shift in (0.0, 0.5)]
                for place in (ends.start, ends.stop):
                    for begin in begins:
                        first = round((place / self.length - begin - bond.pattern.start) % period, 9) * self.length
                        tried.setdefault(first % bond.period, 0.0)
        for first in tried:
            tried[first] = sum(self._cost(k, first) for k in courses)
        least = min(tried.values())
        return next(first for first, cost in tried.items() if cost <= least + 1e-9)

    def _cost(self, course: int, first: float) -> float:
        near = [x for k in (course - 1, course + 1) if 0 <= k < len(self.runs) for run in self.runs[k]
                for line in run for x in set(line.tolist())]  # fmt: skip
        bond = self.bond(course, first)
        return sum(laid(self.ends(run, course), bond, near).cost for run in self.runs[course])

    def pattern(self, course: int) -> Pattern:
        """Return the bond pattern of a course."""
        return pattern_of(self.keys.bond or "running", self.keys.offset, course, self.length)

    def bond(self, course: int, first: float) -> CourseBond:
        """Return the periodic bond of a course, begun at a place of the lowest one."""
        pattern = self.pattern(course)
        return CourseBond(pattern, self.length, first + pattern.start * self.length)

    def _laid(self, ends: RunEnds, course: int) -> Laid:
        """Divide a stretch of a course into blocks."""
        fixed, apart = self.joints(course - 1) + self.joints(course + 1), 0.0
        if course:
            apart = clearance(self.pattern(course - 1), self.pattern(course))
        found = laid(ends, self.bond(course, self.first), fixed, self._heads.get(course - 1, ()), apart)
        self._heads.setdefault(course, []).extend(found.heads.tolist())
        return found

    @cached_property
    def _heads(self) -> dict[int, list[float]]:
        """Head joints of the courses laid so far [m]."""
        return {}

    # -- courses ---------------------------------------------------------------------------------------------------

    def stones(self) -> list[tuple[str, Stone]]:
        """Return all stones by name, course by course from below, lintels and arches last.

        Raises KeyProblem for a piece too small.
        """
        laid_ones, over = self.laid_stones(), list(self.over_openings())
        exact = self._welded([*laid_ones, *(stone for _, stone in over)])
        together = put_together(exact[: len(laid_ones)], SMALL * self.length)
        found = [(f"{self.axis.name}-{name}", stone) for name, stone in numbered(together)]
        return found + [(name, stone) for (name, _), stone in zip(over, exact[len(laid_ones) :], strict=True)]

    def laid_stones(self) -> list[Stone]:
        """Lay the stones of all courses, before small ones are merged with others."""
        return [stone for course in range(len(self.runs)) for stone in self._course(course)]

    def _welded(self, stones: Sequence[Stone]) -> list[Stone]:
        """Make shared corners of stones exactly equal."""
        if not any(len(void.joints) for void in self.voids):
            return list(stones)
        shapes = iter(cuts.welded([part.shape for stone in stones for part in stone.parts], WELD * self.length))
        return [one._replace(parts=tuple(Part(next(shapes), part.across) for part in one.parts)) for one in stones]

    def over_openings(self) -> Iterator[tuple[str, Stone]]:
        """Yield lintels and voussoirs."""
        for i, (opening, void) in enumerate(zip(self.table.openings, self.voids, strict=True)):
            if opening.lintel is not None and opening.lintel_box is not None:
                x0, y0, x1, y1 = opening.lintel_box
                part = Part(rectangle(x0, y0, x1 - x0, y1 - y0), self.across)
                yield f"{self.axis.name}-lintel-{i + 1}", Stone(0, (part,), 0.0, material=opening.lintel.material)
            for n, shape in enumerate(void.voussoirs):
                material = opening.arch.material if opening.arch else ""
                stone = Stone(0, (Part(shape, self.across),), 0.0, material=material)
                yield f"{self.axis.name}-arch-{i + 1}-{n + 1}", stone

    def _course(self, course: int) -> Iterator[Stone]:
        """Yield the stones of a course; at skew ends of runs they extend to the outermost place."""
        low, high = (float(level) for level in self.levels[course : course + 2])
        full, small = self.length * (high - low), SMALL * self.length
        arches = [self.voids[i] for i, beside in self._arches if course in beside and self._is_free(i, course)]
        for piece in self._through(course):
            x0, y0, x1, y1 = piece.box
            shapes = [rectangle(x0, y0, x1 - x0, y1 - y0)]
            for void in arches:
                if void.reach[0] < x1 and void.reach[2] > x0:
                    shapes = [piece for shape in shapes for piece in void.left_of(shape, small)]
            if self.top is not None and high > self.eaves:
                shapes = [piece for shape in shapes for piece in tops.below(shape, self.top, small)]
            groups = cuts.connected(shapes, small) if arches else [range(len(shapes))] if shapes else []
            for group in groups:
                stone = Stone(course + 1, tuple(Part(shapes[i], piece.across) for i in group), full)
                yield from [stone] if piece.whole else in_leaves(stone, depths_of(self.across, self.keys.leaves))

    def _through(self, course: int) -> list[LaidPiece]:
        """Return the pieces of a course, marked where they go through all leaves.

        Headers, a share of the others, and all that touch another wall, a free end or a floor.
        """
        pieces = [piece for run in self.runs[course] for piece in self._boxes(run, course)]
        if self.keys.leaves == 1:
            return pieces
        middles = np.array([0.5 * (piece.box[0] + piece.box[2]) for piece in pieces])
        bond = self.bond(course, self.first)
        headers = [bond.pattern.units[k].header for k in bond.units_at(middles).tolist()]
        share = are_through(self.keys.through_stones, len(pieces), course)
        return [
            piece._replace(whole=header or through or self._is_held(piece))
            for piece, header, through in zip(pieces, headers, share, strict=True)
        ]

    def _is_held(self, piece: LaidPiece) -> bool:
        """Test whether a piece touches another wall, an end of its own wall, or a floor."""
        small = SMALL * self.length
        near = any(piece.box[0] <= b + small and piece.box[2] >= a - small for a, b in self._crossed)
        return near or piece.across != self.across

    @cached_property
    def _crossed(self) -> list[tuple[float, float]]:
        """Intervals along the wall where other walls cross it in some course, and its ends in any [m]."""
        starts, stops = ([end for runs in self.runs for end in each(runs)] for each in (_first_ends, _last_ends))
        found = [(min(starts), max(starts)), (min(stops), max(stops))]
        for runs in self.runs:
            found += [(float(one.stop.min()), float(two.start.max())) for one, two in pairwise(runs)]
        return found

    @cached_property
    def _arches(self) -> list[tuple[int, range]]:
        """List the openings under arches with the courses that they interrupt."""
        return [
            (i, self._beside(void.reach[1], void.reach[3])) for i, void in enumerate(self.voids) if len(void.joints)
        ]

    def _is_free(self, opening: int, course: int) -> bool:
        """Test whether an arch lies within one run of a course. Raises KeyProblem where it does not."""
        left, _, right, _ = self.voids[opening].reach
        small = SMALL * self.length
        for run in self.runs[course]:
            if run.start.max() - small <= left and right <= run.stop.min() + small:
                return True
        message = f"its arch, from {left:.4g} to {right:.4g} along wall '{self.axis.name}', reaches into another wall"
        raise KeyProblem(message, *self._key(opening))

    def _boxes(self, run: Run, course: int) -> Iterator[LaidPiece]:
        """Yield the blocks of a run."""
        ends, holes = self.ends(run, course), self.holes(course)
        outer = ends.start - ends.start_askew, ends.stop + ends.stop_askew
        askew = {outer[0]: ends.start_askew, outer[1]: ends.stop_askew}
        for hole in holes:
            if hole.arch is not None:
                askew |= {hole.left: hole.left - hole.arch.middle[0], hole.right: hole.arch.middle[1] - hole.right}
        for stretch in self._stretches(run, ends, course):
            heads = self._laid(stretch.ends(askew), course).heads if stretch.free else np.zeros(0)
            if (stretch.left, stretch.right) == outer and self._is_tip(course):
                count = math.ceil((outer[1] - outer[0]) / self.length - SMALL)
                heads = outer[0] + (outer[1] - outer[0]) * np.arange(1, count) / count
            for low, high in stretch.free:
                for a, b in pairwise([stretch.left, *heads.tolist(), stretch.right]):
                    yield LaidPiece((a, low, b, high), stretch.across, True)
        yield from self._tips(run, holes, course)

    def _tips(self, run: Run, holes: Sequence[Hole], course: int) -> Iterator[LaidPiece]:
        """Yield thin leftovers over and under arches, which become parts of other stones."""
        low, high = (float(level) for level in self.levels[course : course + 2])
        for hole in holes:
            if hole.arch is not None and run.start.max() <= hole.left and hole.right <= run.stop.min():
                for tip in hole.arch.tips:
                    heads = self._laid(RunEnds(*tip), course).heads
                    for a, b in pairwise([tip[0], *heads.tolist(), tip[1]]):
                        yield LaidPiece((a, low, b, high), self.across, True)

    def _is_tip(self, course: int) -> bool:
        """Test whether a course lies under the tip of a gable."""
        return self.top is not None and course == len(self.runs) - 1

    def _stretches(self, run: Run, ends: RunEnds, course: int) -> list[Stretch]:
        """Split a run where its free heights change."""
        small = SMALL * self.length
        holes = [h for h in self.holes(course) if h.left < ends.stop - small and h.right > ends.start + small]
        inner = ends.start + ends.start_askew, ends.stop - ends.stop_askew
        for hole in holes:
            if hole.left < inner[0] - small or hole.right > inner[1] + small:
                message = f"it goes from {hole.left:g} to {hole.right:g} along wall '{self.axis.name}', which is free "
                message += f"of other walls from {inner[0]:.6g} to {inner[1]:.6g}"
                raise KeyProblem(message, *self._key(hole.opening))
        pockets = self._pockets(course)
        edges = {x for hole in holes for x in hole[:2]} | {x for pocket in pockets for x in pocket[:2]}
        between = sorted(x for x in edges if inner[0] + small < x < inner[1] - small)
        between = [x for x, before in zip(between, [-math.inf, *between]) if x - before > small]
        low, high = (float(level) for level in self.levels[course : course + 2])
        found: list[Stretch] = []
        outer = ends.start - ends.start_askew, ends.stop + ends.stop_askew
        for a, b in pairwise([outer[0], *between, outer[1]]):
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
        """Return the part of the thickness that pockets leave."""
        right, left = self.across
        return max([right, *(a for a, _ in across)]), min([left, *(b for _, b in across)])

    def _free(self, low: float, high: float, over: Sequence[Hole]) -> tuple[tuple[float, float], ...]:
        """Return the intervals of height of a course that holes leave free."""
        found, at = [], low
        for hole in (*sorted(over, key=lambda each: each.low), None):
            until = high if hole is None else hole.low
            if until - at > SMALL * (high - low):
                found.append((at, until))
            at = max(at, high if hole is None else hole.high)
        return tuple(found)

    def _check_lengths(self, row: Sequence[Stretch], course: int, holes: Sequence[Hole]) -> None:
        """Raise KeyProblem where a stretch is too short for a block."""
        least = SHORTEST * self.length * (1.0 - SMALL)
        for stretch in row:
            length = stretch.right - stretch.left
            if not stretch.free or length >= least or stretch.across != self.across:
                continue
            where = f"{length:.3g} m long, at {stretch.left:.4g} m in course {course + 1} of wall '{self.axis.name}'"
            near = [h for h in holes if min(abs(h.left - stretch.right), abs(h.right - stretch.left)) < least]
            key = self._key(near[0].opening) if near else ("walls", self.number, "axis")
            raise KeyProblem(f"a piece is left that is too short, {where}; at least a quarter of a block", *key)


def _first_ends(runs: Sequence[Run]) -> list[float]:
    return runs[0].start.tolist() if runs else []


def _last_ends(runs: Sequence[Run]) -> list[float]:
    return runs[-1].stop.tolist() if runs else []
