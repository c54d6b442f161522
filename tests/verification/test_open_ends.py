"""Corners on faces, and loads close to nothing: exact loads of single blocks, by every start and by limit analysis.

A face that only its corner touches has its other end metres away from anything: it carries nothing, neither in limit
analysis nor on the path. Small loads ask for a balance of forces that is as much closer.
"""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, solve, tables, turned
from scipy.optimize import linprog

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads

PUSH = {"kind": "pushover", "direction": [-1.0, 0.0]}


class Polygon:
    """A polygon by its corners, counter-clockwise."""

    def __init__(self, corners: np.ndarray) -> None:
        x, y = corners.T
        crossed = x * np.roll(y, -1) - np.roll(x, -1) * y
        around = corners + np.roll(corners, -1, axis=0)
        self.centroid = (around * crossed[:, None]).sum(axis=0) / (3.0 * crossed.sum())


THICK, LONG = 0.2, 3.0  # of the ladder [m]


def ladder(degrees: float, friction: float) -> dict:
    """A slab that leans with one corner on the ground, and with one against a wall."""
    slab = np.array(turned(rectangle(0.0, 0.0, LONG, THICK), np.radians(degrees)))
    wall = float(slab[:, 0].max())
    blocks = [
        block("ground", rectangle(-5.0, -1.0, wall, 0.0), fixed=True),
        block("wall", rectangle(wall, -1.0, wall + 2.0, 10.0), fixed=True),
        block("slab", slab),
    ]
    return tables(*blocks, friction=friction, analysis=PUSH)


def exact(degrees: float, friction: float) -> float:
    """The largest load for which forces at the two corners balance the slab: a linear program of five unknowns."""
    slab = np.array(turned(rectangle(0.0, 0.0, LONG, THICK), np.radians(degrees)))
    centre, foot, head = slab.mean(axis=0), slab[slab[:, 1].argmin()], slab[slab[:, 0].argmax()]
    columns = []
    for place, normal, tangent in ((foot, (0.0, 1.0), (1.0, 0.0)), (head, (-1.0, 0.0), (0.0, 1.0))):
        for sign in (1.0, -1.0):
            force = np.array(normal) + sign * friction * np.array(tangent)
            arm = place - centre
            columns.append([*force, arm[0] * force[1] - arm[1] * force[0]])
    columns.append([-1.0, 0.0, 0.0])  # the load, of the weight
    found = linprog([0, 0, 0, 0, -1], A_eq=np.array(columns).T, b_eq=[0.0, 1.0, 0.0])
    return float(found.x[-1])


@pytest.mark.parametrize(("degrees", "friction"), [(70.0, 0.4), (80.0, 0.4), (60.0, 0.6)])
def test_a_ladder(degrees, friction):
    case, load = ladder(degrees, friction), exact(degrees, friction)
    made = scene(case)
    limits = limit_loads(made.model, joint_properties(made.request, made.model), law_of(made.request))
    assert limits.associated.multiplier == pytest.approx(load, rel=1e-6)
    assert limits.non_associated.load == pytest.approx(load, rel=1e-4)
    for start in ("auto", "path"):
        low, high = solve(case, f'analysis.start="{start}"')[0]["failure_load_bracket"]
        assert low * (1.0 - 1e-5) <= load <= high * (1.0 + 1e-5)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("wedge", [1e-5, 1e-3, 0.02])
def test_a_block_sits_down_on_a_wedge(wedge, direction):
    """Its foot touches at one end only: exact is the block turned until it lies flat. 5 % too high at 20 mm once."""
    foot = [[0.0, 0.0], [1.0, wedge], [1.0, 2.0], [0.0, 2.0]]
    blocks = [block("ground", rectangle(-3.0, -1.0, 4.0, 0.0), fixed=True), block("top", foot)]
    analysis = {"kind": "pushover", "direction": [direction, 0.0]}
    summary = solve(tables(*blocks, friction=0.9, analysis=analysis))[0]
    assert "may close at one end" in summary["skipped"][0]
    flat = np.array(turned(foot, -np.arctan(wedge)))
    x, y = Polygon(flat).centroid
    load = (flat[:2, 0].max() - x) / y if direction > 0.0 else x / y
    low, high = summary["failure_load_bracket"]
    assert low * 0.998 <= load <= high * 1.002


def test_a_block_on_its_apex_carries_nothing():
    blocks = [block("ground", rectangle(-5.0, -1.0, 5.0, 0.0), fixed=True), block("top", [[0, 0], [0.5, 1], [-0.5, 1]])]
    summary = solve(tables(*blocks, friction=0.5, analysis={"kind": "pushover"}))[0]
    assert summary["failure_load_bracket"] == pytest.approx([0.0, 0.0], abs=1e-5)


@pytest.mark.parametrize("load", [2e-4, 5e-3, 2e-2])
def test_small_loads(load):
    """A block 1 m high that overhangs until λ = arm / (height / 2) is left: 10 % too high at 2e-4 once."""
    arm = 0.5 * load
    blocks = [
        block("base", rectangle(-2.0, -1.0, 0.0, 0.0), fixed=True),
        block("top", rectangle(-0.5 - arm, 0.0, 0.5 - arm, 1.0)),
    ]
    low, high = solve(tables(*blocks, friction=0.6, analysis={"kind": "pushover"}))[0]["failure_load_bracket"]
    assert low <= load * (1.0 + 1e-4)
    assert load * (1.0 - 1e-4) <= high <= low * 1.0021


def test_no_friction_carries_nothing_and_is_known_at_once():
    """It was waited for until 42 times as many steps as allowed were gone."""
    blocks = [block("base", rectangle(-1.0, -1.0, 2.0, 0.0), fixed=True), block("top", rectangle(0.0, 0.0, 1.0, 1.0))]
    summary = solve(tables(*blocks, friction=0.0, analysis={"kind": "pushover", "max_steps": 20_000}))[0]
    assert summary["status"] == "ok"
    assert summary["failure_load_bracket"] == pytest.approx([0.0, 0.0], abs=1e-5)
