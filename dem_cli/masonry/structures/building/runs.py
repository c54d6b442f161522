"""Runs of a course: uninterrupted stretches of a wall, given which wall passes at each junction."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.masonry.structures.building.plan import Junction, Plan

Passes = Callable[[Junction, int], int]  # (junction, course from 0) -> 0 or 1: which of its two walls passes


class Run(NamedTuple):
    """Uninterrupted stretch of one course; each end is where it cuts the right and the left face of the wall [m],
    (2,).
    """

    start: np.ndarray
    stop: np.ndarray


def runs_of(plan: Plan, wall: int, course: int, present: Callable[[int, int], bool], passes: Passes) -> list[Run]:
    """Find the runs of a course of a wall, along its axis.

    A wall that passes a corner goes on to the outer face of the other one; one that does not ends at its nearest face.
    Where it passes in the middle of the other one, that ends at both of its faces. present: (wall, course) -> whether
    a wall is as high as that.
    """
    axis = plan.axes[wall]
    start, stop = np.zeros(2), np.full(2, axis.length)
    breaks = []
    for junction in plan.met(wall):
        mine = junction.of(wall)
        other, end = junction.walls[1 - mine], junction.ends[mine]
        gives_way = present(other, course) and passes(junction, course) != mine
        if end:
            line = plan.near(wall, other, -end) if gives_way else plan.far(wall, other, -end)
            start, stop = (line, stop) if end < 0 else (start, line)
        elif gives_way:
            breaks.append((plan.near(wall, other, -1), plan.near(wall, other, 1)))
    lefts, rights = [start, *(after for _, after in breaks)], [*(before for before, _ in breaks), stop]
    return [Run(left, right) for left, right in zip(lefts, rights, strict=True)]


def turn_by_turn(junction: Junction, course: int) -> int:
    """Return which of two walls passes in a course, by the repeating order of the junction."""
    return junction.turns[course % len(junction.turns)]
