"""Irregular courses: kinked bed joints and inclined head joints by five statistical parameters (Lemos 2019, 3.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive
from dem_cli.core.arithmetic import functions
from dem_cli.input_limits import MOST_STONES
from dem_cli.masonry.structures.patterns.cut import within
from dem_cli.masonry.structures.patterns.panel import LEAST_SHARE, WallPanel, fitted
from dem_cli.masonry.structures.patterns.tiling import Tiling

SHORTEST = 0.05  # of the mean side: corners on a bed that would be closer become one

Size = tuple[Positive, NonNegative]  # mean and deviation
Error = tuple[float, NonNegative]


class CoursedPattern(CaseModel):
    """Stones in irregular courses: each parameter is [mean, deviation], drawn evenly from mean - deviation to mean +
    deviation."""

    spacing: Size = Field(description="of bed joints: heights of the courses [m]", examples=[[1.0, 0.1]])
    segment: Size = Field(description="lengths of the straight pieces of a bed joint [m]", examples=[[2.0, 1.0]])
    deviation: Error = Field(
        description="of the kinks of a bed joint, upwards from its mean trace [m]", examples=[[0.0, 0.2]]
    )
    head_spacing: Size = Field(description="of head joints: lengths of the stones [m]", examples=[[1.5, 0.5]])
    head_angle_deg: Error = Field(
        (0.0, 0.0), description="of head joints from the vertical, to the right [deg]", examples=[[0.0, 5.0]]
    )

    @model_validator(mode="after")
    def _no_slivers(self) -> CoursedPattern:
        for key in ("spacing", "segment", "head_spacing"):
            mean, deviation = getattr(self, key)
            most = (1.0 - LEAST_SHARE) * mean
            if deviation > most * (1.0 + 1e-9):
                message = f"a deviation of {deviation:g} is not allowed; must be at most {most:.4g}, so that "
                raise KeyProblem(f"{message}nothing is below a quarter of the mean, {mean:g}", key)
        if self.steepest > math.radians(60.0):
            angle = math.degrees(self.steepest)
            raise KeyProblem(f"{angle:g} is not allowed; must be at most 60 with its deviation", "head_angle_deg")
        return self

    @property
    def steepest(self) -> float:
        """Largest angle of a head joint from the vertical [rad]."""
        return math.radians(abs(self.head_angle_deg[0]) + self.head_angle_deg[1])

    def check(self, length: float, height: float) -> None:
        """Raise KeyProblem where beds or heads could cross in a panel of that size [m], or stones are too many."""
        count = length * height / (self.spacing[0] * self.head_spacing[0])
        if count > MOST_STONES:
            raise KeyProblem(f"makes {count:.3g} stones; at most {MOST_STONES:,}", "head_spacing")
        for key, total in (("spacing", height), ("head_spacing", length)):
            if getattr(self, key)[0] > 1.5 * total:
                raise KeyProblem(f"{getattr(self, key)[0]:g} is not allowed; the panel has only {total:g}", key)
        least, allowed = least_part(height, self.spacing), LEAST_SHARE * self.spacing[0]
        shift, error = abs(self.deviation[0]), self.deviation[1]
        if pieces(height, self.spacing[0]) > 1 and (room := least - allowed) < max(2.0 * error, shift + error):
            most = min(room / 2.0, room - shift)
            message = f"with kinks {error:g} off, beds {least:.4g} apart could come closer than {allowed:.4g}, a "
            message += f"quarter of the mean spacing; the deviation must be at most {max(most, 0.0):.4g}"
            raise KeyProblem(message if most > 0.0 else f"{message}: reduce that of spacing", "deviation")
        low, high = (math.radians(self.head_angle_deg[0] + sign * self.head_angle_deg[1]) for sign in (-1, 1))
        course = self.spacing[0] + self.spacing[1] + 2.0 * error + shift
        lost = 0.5 * course * max(math.tan(high) - math.tan(low), math.tan(self.steepest))
        least = least_part(length, self.head_spacing)
        if lost > least - LEAST_SHARE * self.head_spacing[0] and pieces(length, self.head_spacing[0]) > 1:
            message = "heads that lean so much could come closer than a quarter of their mean spacing in a course of "
            raise KeyProblem(f"{message}{course:.4g}, where stones may be {least:.4g} long", "head_angle_deg")


class CoursedStones(NamedTuple):
    """Stones of a panel in irregular courses, and the random values drawn for them."""

    tiling: Tiling
    drawn: dict[str, np.ndarray]  # key -> values [m, deg]


def pieces(total: float, mean: float) -> int:
    """Return the nearest number of pieces of a mean length that fill a total [m]."""
    return max(round(total / mean), 1)


def least_part(total: float, size: Size) -> float:
    """Return the shortest possible piece of a divided length [m]: one shortest, the others longest."""
    mean, deviation = size
    n = pieces(total, mean)
    return (mean - deviation) * min(total / (mean - deviation + (n - 1) * (mean + deviation)), 1.0)


def divided(total: float, size: Size, draws: np.random.Generator) -> np.ndarray:
    """Divide a length into random pieces that are scaled to fit [m]; returns places from 0, (n + 1,)."""
    n = pieces(total, size[0])
    lengths = draws.uniform(size[0] - size[1], size[0] + size[1], n)
    places = np.concatenate([[0.0], np.cumsum(lengths)]) * (total / lengths.sum())
    places[-1] = total
    return places


def stones_in(panel: WallPanel, pattern: CoursedPattern, draws: np.random.Generator) -> CoursedStones:
    """Generate stones in irregular courses that fill a panel; those with a kink are compounds of convex parts.

    Raises KeyProblem: beds or heads could cross.
    """
    low, high = panel.outline.min(axis=0), panel.outline.max(axis=0)
    length, height = (high - low).tolist()
    pattern.check(length, height)
    made = _Courses(length, height, pattern, draws)
    tiling = made.tiling()
    tiling.corners += low
    if len(panel.outline) != 4 or abs(panel.area - length * height) > 1e-9 * panel.area:
        tiling = within(tiling, panel.outline)
    mean = pattern.spacing[0] * pattern.head_spacing[0]
    return CoursedStones(fitted(tiling, panel, mean, SHORTEST), made.drawn)


class _Courses:
    """Courses of a rectangle, laid from below: the bed, its head joints, then the kinks of the bed above."""

    def __init__(self, length: float, height: float, pattern: CoursedPattern, draws: np.random.Generator):
        self.pattern, self.draws, self.length = pattern, draws, length
        self.reach = SHORTEST * (pattern.spacing[0] * pattern.head_spacing[0]) ** 0.5
        self.levels = divided(height, pattern.spacing, draws)
        n = len(self.levels) - 1
        self.beds = [self._bed(k) if 0 < k < n else [(0.0, y), (length, y)] for k, y in enumerate(self.levels.tolist())]
        self.drawn = {
            "spacing": np.diff(self.levels),
            "segment": np.concatenate([np.empty(0), *(np.diff([x for x, _ in bed]) for bed in self.beds[1:-1])]),
            "deviation": np.concatenate(
                [np.empty(0), *([y - self.levels[k] for _, y in self.beds[k]] for k in range(1, n))]
            ),
        }
        self.heads: list[list[tuple[float, float]]] = []  # of each course: x of foot and head of each head joint
        lengths, slopes = [], []
        for k in range(n):
            places, leans = self._lay(k)
            lengths.append(np.diff(places))
            slopes.append(leans)
        self.drawn["head_spacing"] = np.concatenate(lengths)
        self.drawn["head_angle_deg"] = np.degrees(functions.arctan(np.concatenate(slopes)))

    def _bed(self, k: int) -> list[tuple[float, float]]:
        """Draw the kinks of an inner bed joint from left to right."""
        mean, deviation = self.pattern.deviation
        xs = divided(self.length, self.pattern.segment, self.draws)
        ys = self.levels[k] + mean + self.draws.uniform(-deviation, deviation, len(xs))
        if deviation == 0.0:
            xs, ys = xs[[0, -1]], ys[[0, -1]]
        return list(zip(xs.tolist(), ys.tolist(), strict=True))

    def _lay(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Draw the head joints of course k (from 0): places of ends and heads at mid-height, and their slopes dx/dy."""
        middle = 0.5 * float(self.levels[k] + self.levels[k + 1])
        places = divided(self.length, self.pattern.head_spacing, self.draws)
        mean, deviation = self.pattern.head_angle_deg
        slopes = functions.tan(np.radians(self.draws.uniform(mean - deviation, mean + deviation, len(places) - 2)))
        below = [x for x, _ in self.beds[k][1:-1]]
        feet = []
        for i, slope in enumerate(slopes.tolist()):
            x, y = self._meeting(self.beds[k], float(places[i + 1]), slope, middle)
            near = min(below, key=lambda other: abs(other - x), default=math.inf)
            if abs(near - x) < self.reach and near not in feet:
                y = dict(self.beds[k])[near]
                places[i + 1], x = near + slope * (middle - y), near
            feet.append(x)
            self._add(k, x, y)
        self._draw_kinks(k + 1, places[1:-1].tolist(), slopes.tolist(), middle)
        tops = []
        for place, slope in zip(places[1:-1].tolist(), slopes.tolist(), strict=True):
            x, y = self._meeting(self.beds[k + 1], place, slope, middle)
            tops.append(x)
            self._add(k + 1, x, y)
        self.heads.append(list(zip(feet, tops, strict=True)))
        return places, slopes

    def _add(self, k: int, x: float, y: float) -> None:
        """Add a corner on bed k."""
        if x not in dict(self.beds[k]):
            self.beds[k] = sorted([*self.beds[k], (x, y)])

    def _draw_kinks(self, k: int, places: list[float], slopes: list[float], middle: float) -> None:
        """Move the kinks of bed k that lie near head joints from below onto them, at their own level."""
        if k == len(self.beds) - 1:
            return
        kinks = [self.beds[k][0]]
        for x, y in self.beds[k][1:-1]:
            at = [place + slope * (y - middle) for place, slope in zip(places, slopes, strict=True)]
            away, near = min(((abs(other - x), other) for other in at), default=(math.inf, x))
            moved = near if away < self.reach else x
            if kinks[-1][0] + self.reach <= moved <= self.length - self.reach or len(kinks) == 1:
                kinks.append((moved, y))
        self.beds[k] = [*kinks, self.beds[k][-1]]

    def _meeting(
        self, bed: list[tuple[float, float]], place: float, slope: float, middle: float
    ) -> tuple[float, float]:
        """Intersect a head joint with a bed; exact at a corner of the bed."""
        aside = [x - place - slope * (y - middle) for x, y in bed]
        small = 1e-9 * self.length
        for i, (x, y) in enumerate(bed):
            if abs(aside[i]) <= small:
                return x, y
        i = next(i for i in range(len(bed) - 1) if aside[i] < 0.0 < aside[i + 1])
        share = aside[i] / (aside[i] - aside[i + 1])
        (x0, y0), (x1, y1) = bed[i], bed[i + 1]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0)

    def tiling(self) -> Tiling:
        """Return the stones; corners of both courses at a bed are corners of all stones there."""
        numbers: list[dict[float, int]] = []
        corners: list[tuple[float, float]] = []
        for bed in self.beds:
            numbers.append({x: len(corners) + i for i, (x, _) in enumerate(bed)})
            corners += bed
        stones, courses = [], []
        for k, heads in enumerate(self.heads):
            ends = [(0.0, 0.0), *heads, (self.length, self.length)]
            for (foot0, top0), (foot1, top1) in zip(ends[:-1], ends[1:], strict=True):
                below = [i for x, i in numbers[k].items() if foot0 <= x <= foot1]
                above = [i for x, i in numbers[k + 1].items() if top0 <= x <= top1]
                stones.append((*below, *above[::-1]))
                courses.append(k + 1)
        return Tiling(np.array(corners), stones, courses)
