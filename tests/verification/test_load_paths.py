"""Load paths, steps of the load, and a collapse under the load of failure."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, solve, tables

from dem_cli.errors import CaseError

SLOPE = 0.05  # of the outer sides of the polygon below
STACK = [block("base", rectangle(-1.0, -1.0, 2.0, 0.0), fixed=True), block("top", rectangle(0.0, 0.0, 1.0, 2.0))]


def on_polygon(**analysis) -> dict:
    """A block of 1 × 2 m that rolls on three sides, the middle one 0.2 m long."""
    case = tables(*STACK, analysis=analysis, monitor=[{"block": "top", "quantity": "rotation"}])
    case["joints"] = {"rough": {"friction": 1.0, "profile": {"sides": 3, "central": 0.2, "aperture": 0.4 * SLOPE}}}
    return case


def rolls_at(turned: float, vertex: tuple[float, float]) -> float:
    """Load at which the weight, turned clockwise, lies over a vertex (from the middle of the base) of the block."""
    c, s = np.cos(turned), np.sin(turned)
    x, y = -vertex[0], 1.0 - vertex[1]  # to the centroid
    return -(c * x + s * y) / (c * y - s * x)


def test_a_cycle_rolls_there_and_back_at_the_loads_of_statics():
    summary, seen = solve(on_polygon(kind="cycle", path=[0.2, -0.2, 0.0], step=0.005))
    assert summary["status"] == "ok"
    assert [turn["load"] for turn in summary["turning_points"]] == [0.2, -0.2, 0.0]
    assert (summary["highest_load"], summary["lowest_load"]) == pytest.approx((0.2, -0.2), rel=1e-9)
    loads = np.array([row.load for row in seen.rows])
    turned = np.array([row.monitors[0] for row in seen.rows])
    jumps = np.flatnonzero(np.abs(np.diff(turned)) > 0.5 * SLOPE)
    out, back = rolls_at(0.0, (0.1, 0.0)), rolls_at(np.arctan(SLOPE), (0.1, 0.0))
    # A load held at the threshold itself, 0.1, may fall on either side of it.
    assert loads[jumps] == pytest.approx([out, back, -out, -back], abs=0.0051)
    assert loads[jumps + 1] == pytest.approx([out, back, -out, -back], abs=0.0051)
    assert turned[-1] == pytest.approx(0.0, abs=1e-5)


def test_a_path_that_a_structure_does_not_stand_says_where_it_fails():
    summary, seen = solve(on_polygon(kind="cycle", path=[0.3, 0.6], step=0.05))
    assert summary["status"] == "fails on the way"
    exact = rolls_at(np.arctan(SLOPE), (0.5, 0.4 * SLOPE))
    assert exact < summary["failure_load"] <= exact + 0.05
    assert [turn["load"] for turn in summary["turning_points"]] == [0.3]
    assert seen.rows[-1].stage == "collapse"


def test_steps_of_the_load_are_never_longer_than_asked():
    case = on_polygon(step=0.02, resolution=0.005)
    summary, _ = solve(case)
    tried = [entry["load"] for entry in summary["search"]]
    assert tried[0] == pytest.approx(0.02)
    assert np.diff(tried).max() <= 0.02 * (1 + 1e-9)
    assert summary["start"]["kind"] == "gravity"
    exact = rolls_at(np.arctan(SLOPE), (0.5, 0.4 * SLOPE))
    low, high = summary["failure_load_bracket"]
    assert low <= exact * (1 + 1e-3)
    assert exact * (1 - 1e-3) <= high
    assert summary["onset_of_displacements"] == pytest.approx(rolls_at(0.0, (0.1, 0.0)), abs=0.0201)


def test_fixed_geometry_and_a_profile_exclude_each_other():
    with pytest.raises(CaseError, match=r"microrotations at the profile of joint 'rough' move the blocks"):
        solve(on_polygon(kinematics="fixed"))


def test_a_collapse_under_the_load_of_failure():
    """A block that slides: the load stays, the friction takes μ W u."""
    case = tables(*STACK, friction=0.3, analysis={"follow": 0.4, "collapse": "load"}, output={"frames": 6})
    summary, seen = solve(case)
    falling = [row for row in seen.rows if row.stage == "collapse"]
    assert summary["failure_load"] == pytest.approx(0.3, rel=2e-3)
    assert {round(row.load, 9) for row in falling} == {round(summary["failure_load_bracket"][1], 9)}
    assert falling[-1].displacement >= 0.4
    weight = 2000.0 * 2.0 * 9.81
    assert falling[-1].energy.friction == pytest.approx(0.3 * weight * falling[-1].displacement, rel=2e-3)
    assert abs(summary["energy_closure"]) < 1e-3
    assert len(seen.frames) >= 5
