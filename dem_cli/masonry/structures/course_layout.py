"""Lay out courses around openings: where each course stops at jambs and arches, which head joints meet corners."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from dem_cli.masonry.structures import courses
from dem_cli.masonry.structures.courses import LEAST_PIECE, Pattern, Piece, Span
from dem_cli.masonry.structures.voids import Void

NEAR_CORNER = 0.1  # of a block: head joints so close to a corner of an opening, or to where it meets a bed, go there
FEATHER = 0.25  # of a course: thinner tips over or under an opening belong to the course beyond


class CoursePlan(NamedTuple):
    """Course to be laid, with the openings and quoins in its way."""

    low: float  # lower bed joint [m]
    high: float  # upper bed joint [m]
    spans: Sequence[Span]  # where it is laid, openings included
    taken: Sequence[Span]  # quoins [m]
    length: float  # of a full block [m]
    pattern: Pattern
    anchor: float  # where the bond begins [m]
    stops: Sequence[float]  # corners of openings and of the top of the wall [m]
    below: Sequence[float]  # head joints of the course below [m]


class Interruption(NamedTuple):
    """Interruption of a course by an opening, between two stones."""

    ends: Span  # of the stones beside it; they are cut where it is narrower [m]
    middle: Span  # half way up, from where blocks are counted [m]
    tips: tuple[Span, ...] = ()  # thin leftovers that belong to the course above or below [m]


def interruption(void: Void, low: float, high: float, gap: float) -> Interruption | None:
    """Find where a course stops beside an opening; None: it continues over or under it."""
    foot, head = void.span_at(low, 1, gap), void.span_at(high, -1, gap)
    height = high - low
    middle = void.span_at((low + high) / 2.0, 1, gap)
    if void.shapes and (foot is None or head is None or max(foot[0], head[0]) > min(foot[1], head[1])):
        return None  # cut out of what is laid
    if foot is None or head is None or middle is None:
        across = _thin(void, low, high, foot is not None, gap)
        return Interruption(across, middle or across, (across,)) if across else None
    left, left_tip = _end(void, -foot[0], -head[0], height)
    right, right_tip = _end(void, foot[1], head[1], height)
    tips = []
    thin = _thin(void, low, high, head[1] - head[0] < foot[1] - foot[0], gap) if left_tip or right_tip else None
    if thin and left_tip:
        left = -thin[0]
        tips.append((thin[0], max(foot[0], head[0])))
    if thin and right_tip:
        right = thin[1]
        tips.append((min(foot[1], head[1]), thin[1]))
    return Interruption((-left, right), middle, tuple(tips))


def _thin(void: Void, low: float, high: float, over: bool, gap: float) -> Span | None:
    """Find where so little of a course remains over or under an opening that it belongs to the next course."""
    level = high - FEATHER * (high - low) if over else low + FEATHER * (high - low)
    across = void.span_at(level, 1 if over else -1, gap)
    if across is None:
        return None
    stops, reach = void.stops(low, high, gap), FEATHER * (high - low)
    start, end = near(across[0], stops, reach), near(across[1], stops, reach)
    return (start, end) if end - start > reach else None


def near(x: float, stops: Sequence[float], reach: float) -> float:
    """Return the nearest stop within reach, otherwise the place itself [m]."""
    stop = min(stops, key=lambda other: abs(other - x), default=x)
    return stop if abs(stop - x) <= reach else x


def _end(void: Void, foot: float, head: float, height: float) -> tuple[float, bool]:
    """Return the end of a stone beside an opening, and whether it would have a feather edge."""
    slopes = foot - head if not void.full else abs(foot - head)
    return min(foot, head), bool(len(void.joints)) and slopes > 2.0 * FEATHER * height


def laid_around(plan: CoursePlan, interruptions: Sequence[Interruption], gap: float) -> list[list[Piece]]:
    """Divide a course into runs of blocks between openings, from left to right."""
    counted = {one.ends[i]: one.middle[i] for one in interruptions for i in (0, 1)}
    runs = []
    for span in plan.spans:
        for start, end in courses.without(span, [*plan.taken, *(one.ends for one in interruptions)], gap):
            from_, to = max(start, counted.get(start, start)), min(end, counted.get(end, end))
            if to - from_ < LEAST_PIECE * plan.length:
                from_, to = start, end
            run = _snapped(courses.laid(plan.pattern, (from_, to), plan.length, plan.anchor, plan.below), plan)
            run[-1] = run[-1]._replace(end=end)
            run[0] = run[0]._replace(start=start)
            runs.append(run)
    return runs


def _snapped(run: list[Piece], plan: CoursePlan) -> list[Piece]:
    """Move head joints to nearby corners of openings."""
    found = list(run)
    for i in range(len(found) - 1):
        joint = found[i].end
        stop = near(joint, plan.stops, NEAR_CORNER * plan.length)
        room = LEAST_PIECE * plan.length
        if stop != joint and stop - found[i].start >= room and found[i + 1].end - stop >= room:
            found[i] = found[i]._replace(end=stop)
            found[i + 1] = found[i + 1]._replace(start=stop)
    return found


def split(tip: Span, joints: Sequence[float], stops: Sequence[float], least: float) -> list[Span]:
    """Divide a thin leftover at the head joints of its neighbouring course; no piece shorter than `least`."""
    places = {near(x, stops, 0.5 * least) for x in joints if tip[0] < x < tip[1]}  # others do not get so far
    ends = [tip[0]]
    for x in sorted(places):
        if ends[-1] + least < x < tip[1] - least:
            ends.append(x)
    ends.append(tip[1])
    return list(zip(ends[:-1], ends[1:], strict=True))
