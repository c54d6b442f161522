"""Elastic joints, whose pressure is integrated over what is closed, against sections, panels and columns by hand."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, solve, tables
from oracle.no_tension_joint import Panel, rotation, tip_of_column, turns_of_a_rectangle
from studies.space.structures import box

KN, FORCE, MU = 1e9, 1e5, 0.7
ARMS = [0.0, 0.1, 1.0 / 6.0, 0.25, 0.35, 0.4, 0.45]
JOINT = {"friction": MU, "kn": KN, "ks": KN}
FIXED = {"kind": "gravity", "kinematics": "fixed"}
MOVING = FIXED | {"kinematics": "large"}


def row(dimension: int, arms: list[tuple[float, float]], analysis: dict, height: float = 0.5) -> dict:
    """Blocks of a metre beside each other on the ground, without much weight, each under a force off its middle."""
    names, loads, monitors = [f"b{k}" for k in range(len(arms))], [], []
    for k, (name, (x, y)) in enumerate(zip(names, arms, strict=True)):
        at = [2.0 * k + x, height] if dimension == 2 else [2.0 * k + x, y, height]
        loads.append({"block": name, "force": [0.0] * (dimension - 1) + [-FORCE], "at": at})
        for component in ["x", "y"][: dimension if dimension > 2 else 0] or [None]:
            more = {} if component is None else {"component": component}
            monitors.append({"block": name, "quantity": "rotation", "name": f"{name}{component}"} | more)
    far = 2.0 * len(arms)
    if dimension == 2:
        base = block("base", rectangle(-1.0, -0.2, far, 0.0), fixed=True)
        blocks = [block(name, rectangle(2.0 * k - 0.5, 0.0, 2.0 * k + 0.5, height)) for k, name in enumerate(names)]
    else:
        base = box("base", (-1.0, -1.0, -0.2), (far, 1.0, 0.0), fixed=True)
        corners = [((2.0 * k - 0.5, -0.5, 0.0), (2.0 * k + 0.5, 0.5, height)) for k in range(len(arms))]
        blocks = [box(name, *ends) for name, ends in zip(names, corners, strict=True)]
    more = {} if dimension == 2 else {"dimension": 3}
    return tables(
        base, *blocks, density=1.0, joints={"bed": JOINT}, load=loads, monitor=monitors, analysis=analysis, **more
    )  # fmt: skip


def turns_of(case: dict) -> np.ndarray:
    """Rotations of all blocks at the end [rad], as their monitors are listed."""
    summary, records = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    return np.array(records.rows[-1].monitors)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_section_without_tension_turns_as_its_pressure_asks(dimension):
    """Rotation under a force up to 0.45 of the width off the middle, in the plane as in space."""
    found = turns_of(row(dimension, [(arm, 0.0) for arm in ARMS], FIXED))
    total = FORCE + 9.81 * 0.5  # with the weight of a block
    exact = np.array([rotation(total, arm * FORCE / total, 1.0, KN) for arm in ARMS])
    about_y = -found if dimension == 2 else found.reshape(-1, 2)[:, 1]
    assert about_y == pytest.approx(exact, rel=2e-4, abs=1e-9)


def test_a_section_without_tension_turns_both_ways():
    """A force that is off the middle in both directions leaves a triangle, a quadrilateral or a pentagon closed."""
    arms = [(0.05, 0.05), (0.2, 0.1), (0.2, 0.2), (0.3, 0.3), (0.4, 0.1), (0.1, 0.42)]
    found = turns_of(row(3, arms, FIXED)).reshape(-1, 2)
    slopes = np.array([turns_of_a_rectangle(FORCE, arm, (1.0, 1.0), KN) for arm in arms])
    assert found[:, 1] == pytest.approx(slopes[:, 0], rel=5e-4)
    assert -found[:, 0] == pytest.approx(slopes[:, 1], rel=5e-4)


@pytest.mark.parametrize("dimension", [2, 3])
def test_geometry_that_moves_has_the_same_sections(dimension):
    """Low blocks, since their loads go along with them: what they turn by brings next to no arm."""
    arms = [(arm, 0.0) for arm in (0.1, 0.25, 0.4)]
    found = turns_of(row(dimension, arms, MOVING, height=0.1))
    exact = np.array([rotation(FORCE, arm, 1.0, KN) for arm, _ in arms])
    about_y = -found if dimension == 2 else found.reshape(-1, 2)[:, 1]
    assert about_y == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("analysis", [FIXED, MOVING], ids=["fixed", "moving"])
def test_joints_with_points_beside_them_change_nothing(dimension, analysis):
    """A bonded pair in the same case has another loop in the plane; sections turn as without it."""
    alone = row(dimension, [(arm, 0.0) for arm in (0.1, 0.25, 0.45)], analysis)
    mixed = alone | {
        "materials": alone["materials"] | {"brick": {"density": 1.0}},
        "joints": alone["joints"] | {"mortar": JOINT | {"law": "mohr-coulomb", "tension": 1e5, "cohesion": 1e5}},
        "interface": [{"between": ["brick", "brick"], "joint": "mortar"}],
    }
    if dimension == 2:
        pair = [block("c", rectangle(-9, 0, -8, 1), fixed=True), block("d", rectangle(-9, 1, -8, 2))]
    else:
        pair = [box("c", (-9, 0, 0), (-8, 1, 1), fixed=True), box("d", (-9, 0, 1), (-8, 1, 2))]
    stones = [one | {"material": "stone"} for one in alone["block"]]
    mixed["block"] = [*stones, *(one | {"material": "brick"} for one in pair)]
    assert turns_of(mixed) == pytest.approx(turns_of(alone), rel=1e-3, abs=1e-9)  # as near as equilibria are sought


def rocking(dimension: int, panel: Panel, depth: float, follow: float) -> dict:
    """A block under its weight and `top` that is pushed at its centre, or at its top where a force stands there."""
    joint = {"friction": 5.0, "kn": panel.kn, "ks": 0.4 * panel.kn}
    analysis = {"kind": "pushover", "control": "displacement", "follow": follow, "increments": 40}
    size = (panel.width, panel.height)
    flat = dimension == 2
    at = [panel.width / 2, panel.height] if flat else [panel.width / 2, depth / 2, panel.height]
    loads = [
        {"block": "p", "force": [0.0] * (dimension - 1) + [-panel.top * (1.0 if flat else depth)], "at": at},
        {"block": "p", "force": [1.0] + [0.0] * (dimension - 1), "at": at, "kind": "live"},
    ]
    more = {}
    if panel.top:
        more["load"] = [load | {"follows": "point"} for load in loads]
        analysis["pattern"] = "live"
    if flat:
        blocks = [block("base", rectangle(-1, -1, 2, 0), fixed=True), block("p", rectangle(0, 0, *size))]
    else:
        more["dimension"] = 3
        blocks = [box("base", (-1, -1, -1), (2, 2, 0), fixed=True), box("p", (0, 0, 0), (size[0], depth, size[1]))]
    density = panel.weight / (9.81 * panel.width * panel.height)
    return tables(*blocks, density=density, joints={"dry": joint}, analysis=analysis, **more)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kn", [1e9, 6e9, 1e11])
def test_a_panel_rocks_at_its_load(dimension, kn):
    """A wall of 0.3 × 3 m out of its plane: 0.1 where its joint is rigid."""
    panel = Panel(0.3, 3.0, 2000.0 * 9.81 * 0.9, kn, pushed_at=1.5)
    summary, _ = solve(rocking(dimension, panel, 0.8, 0.17))
    assert summary["failure_load"] == pytest.approx(panel.strength / panel.weight, rel=2e-3)
    curve = summary["capacity_curve"]
    displacements = np.array(curve["displacements"])
    turns = np.linspace(1e-3, 0.15, 1500)
    late = displacements > 0.015
    assert late.sum() > 20
    exact = np.interp(displacements[late], [panel.moved(turn) for turn in turns], [panel.push(turn) for turn in turns])
    assert np.array(curve["loads"])[late] == pytest.approx(exact / panel.weight, abs=2e-4)
    assert abs(summary["energy_closure"]) < 2e-3


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_pier_under_a_force_rocks_at_its_load(dimension):
    panel = Panel(1.0, 2.0, 2000.0 * 9.81 * 2.0, 6e9, pushed_at=2.0, top=1e5)
    summary, _ = solve(rocking(dimension, panel, 1.0, 0.06))
    assert summary["failure_load"] == pytest.approx(panel.strength, rel=2e-3)


@pytest.mark.parametrize("arm", [0.1, 1.0 / 6.0, 1.0 / 3.0])
def test_a_column_under_a_force_off_its_middle(arm):
    """Ten blocks of 0.3 m at 30 % of their load of buckling: joints that open in part, and a force that goes along."""
    n, side, kn, density = 10, 0.3, 10.0 / 3.0 * 1e9, 100.0
    load = {0.1: 2e5, 1.0 / 6.0: 1e5, 1.0 / 3.0: 2e4}[arm]
    blocks = [block(f"b{k}", rectangle(0.0, side * k, side, side * (k + 1))) for k in range(n)]
    at = [side * (0.5 + arm), side * n]
    case = tables(
        block("base", rectangle(-0.5, -0.3, 0.8, 0.0), fixed=True), *blocks, density=density,
        joints={"bed": {"friction": 1.0, "kn": kn, "ks": 100.0 * kn}},
        load=[{"block": f"b{n - 1}", "force": [0.0, -load], "at": at, "follows": "point"}],
        monitor=[{"point": [side / 2, side * n], "component": "x", "name": "tip"}], analysis=MOVING,
    )  # fmt: skip
    summary, records = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    exact = tip_of_column(n, side, density * 9.81 * side**2, load, arm * side, kn)
    assert records.rows[-1].monitors[0] == pytest.approx(exact, rel=0.01)
