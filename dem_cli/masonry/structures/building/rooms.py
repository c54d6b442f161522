"""Find the rooms of a plan: closed polygons between wall axes, counter-clockwise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.masonry.structures.building.plan import Plan


class RoomSide(NamedTuple):
    """Side of a room, or of the space between two walls; the room lies to the left of it."""

    wall: int | None  # None: no wall there
    start: np.ndarray  # a point of the axis [m], (2,)
    along: np.ndarray  # unit vector, (2,)

    @property
    def inwards(self) -> np.ndarray:
        """Unit vector towards the room, (2,)."""
        return np.array([-self.along[1], self.along[0]])


Room = tuple[RoomSide, ...]


class Step(NamedTuple):
    """Piece of an axis between two junctions, walked one way."""

    wall: int
    begin: int  # junction
    end: int
    way: int  # 1 along the axis, -1 against it


def rooms_of(plan: Plan) -> list[Room]:
    """Find all rooms, each by its sides in order."""
    steps = _steps(plan)
    angles = {step: _angle(plan, step) for step in steps}
    leaving: dict[int, list[Step]] = {}
    for step in sorted(steps, key=lambda each: angles[each]):
        leaving.setdefault(step.begin, []).append(step)
    left, found = dict.fromkeys(steps), []
    while left:
        walk = [next(iter(left))]
        while True:
            del left[walk[-1]]
            onwards = leaving[walk[-1].end]
            back = Step(walk[-1].wall, walk[-1].end, walk[-1].begin, -walk[-1].way)
            following = onwards[(onwards.index(back) - 1) % len(onwards)]  # the next one clockwise: to the left
            if following == walk[0]:
                break
            walk.append(following)
        corners = np.array([_place(plan, step.wall, step.begin) for step in walk])
        after = np.roll(corners, -1, axis=0)
        if (corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]).sum() > 0.0:
            found.append(_sides(plan, walk))
    return found


def between(plan: Plan, one: int, other: int) -> Room:
    """Return the space between two walls that do not meet, from end to end of both."""
    a, b = plan.axes[one], plan.axes[other]
    ends = [np.stack([axis.start, axis.start + axis.length * axis.along]) for axis in (a, b)]
    first = ends[0] if a.local(ends[1].mean(axis=0)[None])[0, 1] > 0.0 else ends[0][::-1]
    second = ends[1] if product(ends[1][1] - ends[1][0], first[1] - first[0]) < 0.0 else ends[1][::-1]
    corners = np.concatenate([first, second])
    arms = np.roll(corners, -1, axis=0) - corners
    along = arms / np.hypot(*arms.T)[:, None]
    return tuple(RoomSide(wall, corners[k], along[k]) for k, wall in enumerate((one, None, other, None)))


def _steps(plan: Plan) -> list[Step]:
    """List the pieces of axes in both directions, without dead ends."""
    numbers = {id(junction): n for n, junction in enumerate(plan.junctions)}
    pieces = [
        Step(wall, numbers[id(one)], numbers[id(two)], 1)
        for wall in range(len(plan.axes))
        for one, two in pairwise(plan.met(wall))
    ]
    while True:
        met = [step.begin for step in pieces] + [step.end for step in pieces]
        kept = [step for step in pieces if met.count(step.begin) > 1 and met.count(step.end) > 1]
        if len(kept) == len(pieces):
            break
        pieces = kept
    return pieces + [Step(step.wall, step.end, step.begin, -1) for step in pieces]


def _angle(plan: Plan, step: Step) -> float:
    x, y = step.way * plan.axes[step.wall].along
    return math.atan2(y, x)


def _place(plan: Plan, wall: int, junction: int) -> np.ndarray:
    axis, met = plan.axes[wall], plan.junctions[junction]
    return axis.start + met.at[met.of(wall)] * axis.along


def _sides(plan: Plan, walk: Sequence[Step]) -> Room:
    """Merge consecutive steps along the same wall to one side."""
    first = next(k for k in range(len(walk)) if walk[k - 1].wall != walk[k].wall)
    turned = [*walk[first:], *walk[:first]]
    kept = [step for before, step in pairwise([walk[first - 1], *turned]) if before.wall != step.wall]
    return tuple(RoomSide(s.wall, plan.axes[s.wall].start, s.way * plan.axes[s.wall].along) for s in kept)
