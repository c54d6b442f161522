"""Motions that are held, [[restraint]]: closed forms in statics, limit analysis, modes and time; what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, solve, tables

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.validate import monitor_problems

MU, WIDE, HIGH, KN, KS = 0.5, 0.2, 0.6, 2e9, 5e8
WEIGHT = 2000.0 * 9.81 * WIDE * HIGH


def slender(held=("rotation",), dimension: int = 2, joint: dict | None = None, **analysis) -> dict:
    """A block three times as high as wide, which rocks at 1/3 unless it cannot turn; 1 m deep in space too."""

    def box(name: str, left: float, low: float, right: float, high: float, **more) -> dict:
        if dimension == 2:
            return block(name, rectangle(left, low, right, high), **more)
        return {"id": name, "vertices": [[x, y, z] for x in (left, right) for y in (-0.5, 0.5) for z in (low, high)],
                **more}  # fmt: skip

    push = {"kind": "pushover", "pattern": "mass", "direction": [1.0] + [0.0] * (dimension - 1)}
    blocks = box("base", -1.5, -0.25, 1.5, 0.0, fixed=True), box("block", -WIDE / 2, 0.0, WIDE / 2, HIGH)
    restraint = [{"block": "block", "fixed": list(held)}] if held else []
    case = tables(*blocks, analysis=analysis or push | {"resolution": 0.002}, restraint=restraint, dimension=dimension)
    return case | {"joints": {"dry": {"friction": MU} | (joint or {})}}


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_a_slender_block_that_cannot_turn_slides(kinematics):
    """At the friction coefficient, not at width over height; the moment that it is held by is that of the push."""
    case = slender()
    case["analysis"]["kinematics"] = kinematics
    summary, _ = solve(case)
    assert summary["failure_load"] == pytest.approx(MU, rel=2e-3)
    assert summary["failure_mode"] == "sliding"
    load = summary["joint_state"]["shear_stress"]["value"] / summary["joint_state"]["normal_stress"]["value"]
    given = summary["joint_state"]["restraints"]["block"]
    assert given == {"rotation": pytest.approx(load * WEIGHT * HIGH / 2, rel=1e-3)}


@pytest.mark.parametrize(("dimension", "held"), [(2, "rotation"), (3, "rotation"), (3, "rotation_y")])
def test_limit_analysis_knows_what_is_held(dimension, held):
    """No moment about that axis has to be in equilibrium: the load of a block that slides, on both ways to it."""
    loads = {}
    for motions in ((held,), ()):
        made = scene(slender(motions, dimension))
        found = limit_loads(made.model, joint_properties(made.request, made.model), law_of(made.request))
        loads[motions] = found.associated.multiplier, found.non_associated.load
        assert not motions or not found.associated.velocities[made.model.held].any()
    assert loads[held,] == pytest.approx((MU, MU), rel=1e-5)
    assert loads[()] == pytest.approx((WIDE / HIGH, WIDE / HIGH), rel=1e-5)


def test_a_block_held_upwards_hangs_and_presses_on_nothing():
    """All of its weight is carried from outside, without work."""
    summary, _ = solve(slender(["y"], kind="gravity"))
    assert summary["joint_state"]["restraints"] == {"block": {"y": pytest.approx(WEIGHT)}}
    assert summary["joint_state"]["normal_stress"]["value"] == 0.0
    assert summary["unbalanced_force"] == 0.0


def test_modes_are_those_of_what_can_move():
    """A block that cannot turn: two springs, sideways and up, no more frequencies and no mechanism."""
    joint = {"kn": KN, "ks": KS}
    summary, _ = solve(slender(joint=joint, kind="modes"))
    mass = WEIGHT / 9.81
    expected = np.sqrt(np.array([KS, KN]) * WIDE / mass) / (2.0 * np.pi)
    assert summary["frequencies"] == pytest.approx(expected, rel=1e-5)  # geometric stiffness: W/(ks h)
    assert summary["mechanisms"] == 0


def test_a_block_pushed_off_slides_to_its_stop_without_turning():
    """v²/2μg, as a flat one; slender it would fall."""
    case = slender(joint={"kn": KN, "ks": KN}, kind="time-history", duration=0.3)
    case["initial"] = [{"block": "block", "velocity": [0.5, 0.0, 0.0]}]
    case["damping"] = {"contact_fraction": 0.35}
    case["monitor"] = [{"name": "x", "block": "block", "component": "x"}, {"name": "turn", "block": "block",
                        "quantity": "rotation"}]  # fmt: skip
    summary, records = solve(case)
    moved, turned = records.history.monitors.T
    assert moved[-1] == pytest.approx(0.25 / (2.0 * MU * 9.81), rel=1e-3)
    assert not turned.any()
    assert abs(summary["energy_closure"]) < 5e-3  # as of a flat block that is free to turn


@pytest.mark.parametrize(
    ("dimension", "change", "said"),
    [
        (2, {"fixed": ["z"]}, "'z' is not allowed in 2D; must be 'x', 'y' or 'rotation'"),
        (2, {"block": "base"}, "block 'base' is fixed; only blocks that can move have motions to hold"),
        (2, {"block": "blok"}, "did you mean 'block'"),
        (3, {"fixed": ["rotation_x"]}, "in kind = 'modes' a block turns about all axes or about none"),
    ],
)
def test_what_cannot_be_held_is_refused(dimension, change, said):
    case = slender(dimension=dimension, kind="modes")
    case["restraint"][0] |= change
    with pytest.raises(CaseError, match=said):
        scene(case)


@pytest.mark.parametrize("dimension", [2, 3])
def test_monitors_follow_what_holds_blocks(dimension):
    """A block that cannot turn, pushed at its middle: F h/2 holds it level, the ground gives weight and push back."""
    push, up = 0.3 * WEIGHT, "y" if dimension == 2 else "z"
    asked = [("base", "reaction", "x", -push), ("base", "reaction", up, WEIGHT), ("base", "reaction", None,
             np.hypot(push, WEIGHT)), ("b*", "reaction", up, WEIGHT)]  # fmt: skip
    # The push turns the block clockwise, in space about y: what holds it gives F h/2 the other way round.
    level = 0.5 * push * HIGH * (1.0 if dimension == 2 else -1.0)
    asked.append(("block", "reaction_moment", None if dimension == 2 else "y", level))
    case = slender(dimension=dimension, kind="gravity")
    case["load"] = [{"block": "block", "force": [push] + [0.0] * (dimension - 1)}]
    case["monitor"] = [
        {"name": f"{i}", "block": block, "quantity": quantity} | ({"component": axis} if axis else {})
        for i, (block, quantity, axis, _) in enumerate(asked)
    ]
    _, records = solve(case)
    assert records.rows[-1].monitors == pytest.approx([value for *_, value in asked], rel=1e-4)


def checked(case: dict) -> None:
    """Raises CaseError for what is wrong with a case and its monitors."""
    made = scene(case)
    if problems := monitor_problems(made.case, made.model):
        raise CaseError(problems)


@pytest.mark.parametrize(
    ("change", "monitor", "said"),
    [
        ({}, {"block": "free", "quantity": "reaction"}, "'reaction' is not allowed of 'free': none of it is fixed"),
        ({}, {"point": [0.0, 0.1], "quantity": "reaction"}, "'reaction' is not allowed of a point"),
        ({}, {"block": "block", "quantity": "reaction_moment", "component": "x"}, "a moment has none in 2D"),
        ({"kind": "modes"}, {"block": "block", "quantity": "reaction"}, "only analyses without time follow"),
    ],
)
def test_reactions_of_what_nothing_holds_are_refused(change, monitor, said):
    case = slender(kind="gravity")
    case["block"].append(block("free", rectangle(0.5, 0.0, 0.7, 0.2)))
    case["analysis"] |= change
    case["monitor"] = [monitor]
    with pytest.raises(CaseError, match=said):
        checked(case)


@pytest.mark.parametrize("by", ["moved", "load"])
def test_a_beam_whose_support_settles(by):
    """It turns about the edge of the other support: what it then asks of the one that sank, by lever arms.

    That support is moved, or it is a block that can only sink, whose load is taken away.
    """
    weight, sunk = 2000.0 * 9.81 * 4.0 * 0.4, 0.05
    foot = block("foot", rectangle(3.5, -0.5, 4.5, 0.0), **({"fixed": True} if by == "moved" else {}))
    beam = block("beam", rectangle(0.0, 0.0, 4.0, 0.4))
    case = tables(block("stays", rectangle(-0.5, -0.5, 0.5, 0.0), fixed=True), foot, beam)
    case["joints"] = {"dry": {"friction": 0.02, "kn": 1e10, "points": 2}}  # no thrust, and it turns about an edge
    case["monitor"] = [{"block": "stays", "quantity": "reaction", "component": "y"}]
    if by == "moved":
        case["analysis"] = {"kind": "settlement"}
        case["settlement"] = [{"block": "foot", "displacement": [0.0, -sunk]}]
    else:
        own = 2000.0 * 9.81 * 0.5
        analysis = {"kind": "cycle", "pattern": "live", "control": "displacement", "path": [sunk], "step": sunk / 2}
        case["analysis"] = analysis
        case["restraint"] = [{"block": "foot", "fixed": ["x", "rotation"]}]
        case["load"] = [
            {"block": "foot", "force": [0.0, weight / 2 + own]},
            {"block": "foot", "force": [0.0, -weight / 2], "kind": "live"},
        ]
    summary, records = solve(case)
    assert summary["status"] == "ok"
    carried = weight * (1.5 + 0.2 * sunk / 3.5) / 3.5  # by the foot: the beam leans towards it
    row = records.rows[-1]
    assert row.monitors[0] == pytest.approx(weight - carried, rel=3e-4)
    if by == "load":
        assert 0.5 * weight * (1.0 - row.load) == pytest.approx(carried, rel=3e-4)
