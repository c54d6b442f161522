"""Hand check of a running-bond wall: a rigid part turns about the toe (PhD thesis, MIT, about 2000, Appendix B3).

The wall is cut along the line through the toe that rises at the stagger of the blocks, tan α = 2h/b, and what
lies above it turns as one piece; with a heavy load on top the whole wall does (α = 0). Sliding and the breaking
up of the part above the line are left out: the figure is no bound, it says what the geometry would give.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.geometry import polygon

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FLAT = 1e-9  # sine of the direction of the load, below which it is horizontal


class TopLoad(NamedTuple):
    """A weight that moves with the wall and is pushed as it is."""

    weight: float  # [N], or any unit that the weight of the wall has
    from_toe: float  # horizontal distance from the toe [m]
    height: float  # above the foot of the wall [m]


def split_load(width: float, height: float, slope: float, weight: float = 1.0, top: Sequence[TopLoad] = ()) -> float:
    """Multiplier (horizontal over vertical load) at which the wall above the cut turns about its toe.

    width, height: of the wall [m]; slope: tan α of the cut, 0 for the whole wall; weight: of the whole wall.
    """
    corners = above_the_cut(width, height, slope)
    found = polygon.properties(corners)
    share = weight * found.area / (width * height)
    arms = [TopLoad(float(share), float(found.centroid[0]), float(found.centroid[1])), *top]
    return sum(t.weight * t.from_toe for t in arms) / sum(t.weight * t.height for t in arms)


def above_the_cut(width: float, height: float, slope: float) -> np.ndarray:
    """Corners of what turns, x from the toe into the wall [m], (n, 2)."""
    rise = width * slope
    if rise < height:
        return np.array([[0.0, 0.0], [width, rise], [width, height], [0.0, height]])
    return np.array([[0.0, 0.0], [height / slope, height], [0.0, height]])


def hand_check(case: Case) -> float | None:
    """Multiplier of the rigid part of a case that is one running-bond wall of equal courses under its own weight.

    None where the case is anything else: other blocks or loads, openings, a turned wall, a load that is not
    horizontal and proportional to weight.
    """
    if (
        len(case.structure) != 1
        or case.block
        or case.load
        or case.pressure
        or case.fill
        or not _pushed_sideways(case.analysis)
    ):
        return None
    wall = case.structure[0]
    if wall.kind != "wall" or not _regular(wall):
        return None
    length, height = wall.block
    return split_load(wall.extent, wall.courses * height, 2.0 * height / length)


def _pushed_sideways(analysis: Any) -> bool:
    """Whether the load is the multiplier times the weight of each block, along x (a tilting table is the same)."""
    pattern = getattr(analysis, "pattern", None)
    if pattern not in ("mass", "tilt"):
        return False
    x, *others = analysis.direction
    if pattern == "tilt":  # what points up does not matter
        others = others[:-1]
    return math.hypot(*others) <= FLAT * abs(x)


def _regular(wall: Any) -> bool:
    """Half-block stagger, flush ends, equal courses, no openings, level, upright."""
    stagger = wall.block[0] / 2 if wall.offset is None else wall.offset
    halves = wall.bond != "stack" and np.isclose(stagger, wall.block[0] / 2) and wall.is_plain
    equal = not (wall.course_heights or wall.course_lengths or wall.openings or wall.sides)
    return bool(halves and equal and wall.ends == "half" and wall.rotation_deg == 0.0 and wall.courses > 1)
