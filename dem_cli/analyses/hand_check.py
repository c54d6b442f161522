"""Closed-form check of a running-bond wall: whether core/limit/rigid_wall.py applies, and its load multiplier."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.core.limit.rigid_wall import split_load

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FLAT = 1e-9  # sine of the direction of the load, below which it is horizontal


def hand_check(case: Case) -> float | None:
    """Return the closed-form load multiplier of a single running-bond wall of equal courses under self-weight.

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
    """Test whether the load is the multiplier times the weight of each block, along x (a tilting table is the same)."""
    pattern = getattr(analysis, "pattern", None)
    if pattern not in ("mass", "tilt"):
        return False
    x, *others = analysis.direction
    if pattern == "tilt":  # what points up does not matter
        others = others[:-1]
    return math.hypot(*others) <= FLAT * abs(x)


def _regular(wall: Any) -> bool:
    """Test whether a wall is regular: half-block stagger, flush ends, equal courses, no openings, level, upright."""
    stagger = wall.block[0] / 2 if wall.offset is None else wall.offset
    halves = wall.bond != "stack" and np.isclose(stagger, wall.block[0] / 2) and wall.is_plain
    equal = not (wall.course_heights or wall.course_lengths or wall.openings or wall.sides)
    return bool(halves and equal and wall.ends == "half" and wall.rotation_deg == 0.0 and wall.courses > 1)
