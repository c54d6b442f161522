"""Plan of a building: junctions of wall axes, and which wall passes there in each course."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.arithmetic.products import product
from dem_cli.masonry.structures.building.table import Building

SHARPEST = 20.0  # angle between walls that meet [deg]
SAME = 1e-9  # of the size of the plan: round-off
TWO_STEMS = ((0, 1, 0, 0), (0, 0, 0, 1))  # one from either side of a wall: each passes in every fourth course


class PlanAxis(NamedTuple):
    """Wall in plan; its own x runs along the axis from its start, y across to the left."""

    name: str
    start: np.ndarray  # [m], (2,)
    along: np.ndarray  # unit vector, (2,)
    length: float  # [m]
    thickness: float  # [m]

    @property
    def across(self) -> np.ndarray:
        """Unit vector to the left of the axis, (2,)."""
        return np.array([-self.along[1], self.along[0]])

    @property
    def faces(self) -> np.ndarray:
        """Places of the two faces across the axis [m], (2,)."""
        return np.array([-0.5, 0.5]) * self.thickness

    def local(self, points: np.ndarray) -> np.ndarray:
        """Convert points of the plan to coordinates of the wall, (n, 2)."""
        return product(points - self.start, np.column_stack([self.along, self.across]))

    def corners(self) -> np.ndarray:
        """Corners of the footprint from end to end of the axis, counter-clockwise, (4, 2)."""
        low, high = self.faces
        local = np.array([[0.0, low], [self.length, low], [self.length, high], [0.0, high]])
        return self.start + product(local, np.stack([self.along, self.across]))


class Junction(NamedTuple):
    """Junction of two walls."""

    walls: tuple[int, int]  # in the order of the case
    at: tuple[float, float]  # where the axes cross, along either [m]
    ends: tuple[int, int]  # of either: -1 it starts here, 1 it ends here, 0 it goes on
    turns: tuple[int, ...] = (0, 1)  # which of the two passes, course by course, over and over

    def of(self, wall: int) -> int:
        """Return 0 or 1: the place of a wall in the junction."""
        return self.walls.index(wall)


class Plan(NamedTuple):
    """Plan of a building: all wall axes and their junctions."""

    axes: tuple[PlanAxis, ...]
    junctions: tuple[Junction, ...]

    def face(self, wall: int, other: int, side: int) -> np.ndarray:
        """Intersect a face of another wall (side: -1 right, 1 left) with both faces of this one [m], (2,)."""
        here, there = self.axes[wall], self.axes[other]
        away = float(product(here.start - there.start, there.across))
        sine, cosine = float(product(here.along, there.across)), float(product(here.across, there.across))
        return (side * 0.5 * there.thickness - away - cosine * here.faces) / sine

    def towards(self, wall: int, other: int, arm: int) -> int:
        """Return the side of another wall (-1 right, 1 left) on which an arm of this one lies: arm 1 goes on along the
        axis.
        """
        return arm * int(math.copysign(1.0, float(product(self.axes[wall].along, self.axes[other].across))))

    def near(self, wall: int, other: int, arm: int) -> np.ndarray:
        """Return the face of another wall that an arm of this one reaches first, as `face`."""
        return self.face(wall, other, self.towards(wall, other, arm))

    def far(self, wall: int, other: int, arm: int) -> np.ndarray:
        """Return the face of another wall behind which an arm of this one would come out, as `face`."""
        return self.face(wall, other, -self.towards(wall, other, arm))

    def zone(self, wall: int, junction: Junction) -> tuple[float, float]:
        """Return both ends of the zone along a wall that the other wall of a junction occupies [m]."""
        other = junction.walls[1 - junction.of(wall)]
        places = np.concatenate([self.face(wall, other, side) for side in (-1, 1)])
        return float(places.min()), float(places.max())

    def met(self, wall: int) -> list[Junction]:
        """Return the junctions of a wall, along its axis."""
        mine = [junction for junction in self.junctions if wall in junction.walls]
        return sorted(mine, key=lambda junction: junction.at[junction.of(wall)])


def plan_of(building: Building) -> Plan:
    """Create the plan of a building. Raises KeyProblem where walls meet in a way that cannot be bonded."""
    axes = tuple(
        PlanAxis(wall.id, np.array(wall.axis[0]), *_direction(wall.axis), wall.thickness or building.thickness)
        for wall in building.walls
    )
    reach = SAME * float(np.ptp(np.concatenate([axis.corners() for axis in axes]), axis=0).max())
    found = []
    for i, j in combinations(range(len(axes)), 2):
        junction = _meeting(axes, i, j, reach)
        if junction is not None:
            found.append(junction)
    plan = _with_turns(Plan(axes, tuple(found)), 0.25 * building.block[0] - reach)
    _check_others(plan, reach)
    return plan


def _direction(axis: Sequence[Sequence[float]]) -> tuple[np.ndarray, float]:
    arm = np.subtract(axis[1], axis[0])
    length = float(np.hypot(*arm))
    return arm / length, length


def _meeting(axes: Sequence[PlanAxis], i: int, j: int, reach: float) -> Junction | None:
    """Find the junction of two axes, within the reach of their thicknesses; None: they do not meet."""
    a, b = axes[i], axes[j]
    sine = float(product(a.along, b.across))
    if abs(sine) < math.sin(math.radians(SHARPEST)) * (1.0 - SAME):
        return None
    at = (float(product(b.start - a.start, b.across)) / sine, float(product(a.start - b.start, a.across)) / -sine)
    ends = []
    for place, axis, other in ((at[0], a, b), (at[1], b, a)):
        around = 0.5 * other.thickness / abs(sine) + reach
        if not -around <= place <= axis.length + around:
            return None
        starts, stops = abs(place) <= around, abs(place - axis.length) <= around
        if starts and stops:
            message = f"wall '{axis.name}' is too short: it lies within the thickness of '{other.name}'"
            raise KeyProblem(message, "walls", i if axis is a else j, "axis")
        ends.append(-1 if starts else int(stops))
    return Junction((i, j), at, (ends[0], ends[1]))


def overlap(one: np.ndarray, other: np.ndarray, reach: float) -> bool:
    """Test whether two convex footprints overlap: no side of either separates them."""
    return not (_apart(one, other, reach) or _apart(other, one, reach))


def _apart(shape: np.ndarray, other: np.ndarray, reach: float) -> bool:
    """Test whether a side of a convex shape (n, 2), counter-clockwise, separates it from another shape."""
    sides = np.roll(shape, -1, axis=0) - shape
    outwards = np.column_stack([sides[:, 1], -sides[:, 0]]) / np.hypot(*sides.T)[:, None]
    heights = product(other, outwards.T).min(axis=0) - (outwards * shape).sum(axis=1)
    return bool((heights >= -reach).any())


def _beside(one: PlanAxis, other: PlanAxis) -> str:
    sine = abs(float(product(one.along, other.across)))
    if sine < math.sin(math.radians(SHARPEST)):
        angle = math.degrees(math.asin(min(sine, 1.0)))
        return (
            f"walls '{one.name}' and '{other.name}' overlap at an angle of {angle:.3g}°; walls that meet do so at "
            f"{SHARPEST:g}° or more, and what lies in one line is one wall"
        )
    return f"walls '{one.name}' and '{other.name}' overlap, but their axes do not meet: extend one to the other"


def _check_others(plan: Plan, reach: float) -> None:
    """Raise KeyProblem where walls without a junction overlap, or continue each other end to end."""
    hosts = [_hosts(plan, wall) for wall in range(len(plan.axes))]
    met = {junction.walls for junction in plan.junctions}
    for i, j in combinations(range(len(plan.axes)), 2):
        a, b = plan.axes[i], plan.axes[j]
        if (i, j) in met or hosts[i] & hosts[j]:
            continue
        if overlap(a.corners(), b.corners(), reach):
            raise KeyProblem(_beside(a, b), "walls", j, "axis")
        places, off = a.local(np.stack([b.start, b.start + b.length * b.along])).T
        in_line = np.abs(off).max() < 0.5 * (a.thickness + b.thickness) - reach
        if in_line and min(abs(places.max()), abs(places.min() - a.length)) <= reach:
            message = f"walls '{a.name}' and '{b.name}' go on in one line: draw them as one wall"
            raise KeyProblem(message, "walls", j, "axis")


def _hosts(plan: Plan, wall: int) -> set[int]:
    """Return the walls into which one ends, between their ends."""
    return {
        junction.walls[1 - junction.of(wall)]
        for junction in plan.met(wall)
        if junction.ends[junction.of(wall)] and not junction.ends[1 - junction.of(wall)]
    }


def _with_turns(plan: Plan, least: float) -> Plan:
    """Alternate two walls that end at the same place from either side of a third; others keep their distance."""
    changed: dict[Junction, tuple[int, ...]] = {}
    dropped: set[Junction] = set()
    for wall in range(len(plan.axes)):
        for one, two in pairwise(plan.met(wall)):
            if plan.zone(wall, two)[0] - plan.zone(wall, one)[1] >= least:
                continue
            stems = [junction.walls[1 - junction.of(wall)] for junction in (one, two)]
            between = [each for each in plan.junctions if set(each.walls) == set(stems)]
            if not _from_both_sides(plan, wall, (one, two)):
                if _is_host(plan, stems, wall):
                    continue
                raise KeyProblem(_too_near(plan, wall, stems, one), "walls", max(wall, *stems), "axis")
            for junction, turns in zip((one, two), TWO_STEMS, strict=True):
                host = junction.of(wall)
                changed[junction] = tuple(host if turn == 0 else 1 - host for turn in turns)
            dropped |= set(between)
    kept = [each._replace(turns=changed.get(each, each.turns)) for each in plan.junctions if each not in dropped]
    return plan._replace(junctions=tuple(kept))


def _is_host(plan: Plan, stems: Sequence[int], wall: int) -> bool:
    """Test whether one of three walls at one place is that in which both others end, from either side."""
    for host in stems:
        others = [each for each in plan.met(host) if each.walls[1 - each.of(host)] in {wall, *stems} - {host}]
        if len(others) == 2 and _from_both_sides(plan, host, (others[0], others[1])):
            return True
    return False


def _from_both_sides(plan: Plan, wall: int, junctions: tuple[Junction, Junction]) -> bool:
    """Test whether two walls end at this one, between its ends, one on either side."""
    sides = []
    for junction in junctions:
        mine, other = junction.of(wall), junction.walls[1 - junction.of(wall)]
        if junction.ends[mine] or not junction.ends[1 - mine]:
            return False
        sides.append(plan.towards(other, wall, -junction.ends[1 - mine]))
    return sides[0] != sides[1]


def _too_near(plan: Plan, wall: int, stems: Sequence[int], junction: Junction) -> str:
    axis = plan.axes[wall]
    x, y = axis.start + junction.at[junction.of(wall)] * axis.along
    names = "', '".join(plan.axes[k].name for k in (wall, *stems))
    return (
        f"walls '{names}' meet too near to each other at [{x:.4g}, {y:.4g}]: two meet at one place, or two more end at "
        "one from either side; move one by its thickness and a quarter of a block"
    )
