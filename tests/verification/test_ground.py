"""The frame that moves with the base, supports with motions of their own, first states of motion."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables

from dem_cli.errors import CaseError, SolverError

PULSE = {"kind": "pulse", "shape": "sine", "amplitude": 4.0, "frequency": 2.0}


def rocking(motion: dict | list, *more: dict, **analysis) -> dict:
    """A block that rocks on its base."""
    return tables(
        block("base", rectangle(-2, -0.5, 2, 0), fixed=True),
        block("b", rectangle(-0.25, 0, 0.25, 1.5)),
        *more,
        joints={"j": {"friction": 2.0, "kn": 1e9}},
        motion=motion,
        analysis={"kind": "time-history", "duration": 1.5, **analysis},
        damping={"contact_fraction": 1.0},
        monitor=[
            {"block": "b", "quantity": "rotation"},
            {"block": "b", "component": "x"},
            {"block": "b", "component": "x", "absolute": True},
            {"block": "b", "component": "x", "absolute": True, "quantity": "acceleration"},
        ],
    )


def test_a_support_that_moves_is_a_base_that_moves():
    """The same motion as body force and as a prescribed support, seen from where the base stands still."""
    far = block("far", rectangle(50, 0, 51, 1), fixed=True)
    _, carried = engine.solve(rocking(PULSE, far))
    summary, moved = engine.solve(rocking({**PULSE, "blocks": ["base"]}, far))
    assert abs(summary["energy_closure"]) < 2e-3  # with the work of the support, through springs and dashpots
    ground = carried.history.base[:, 2, 0]
    assert np.ptp(ground) > 0.1
    assert (moved.history.base == 0.0).all()
    here, there = carried.history.monitors.T, moved.history.monitors.T
    scale = np.abs(here[0]).max()
    assert scale > 0.02
    # Velocities of supports are means over steps: both ways agree to the second order of the step.
    assert np.abs(here[0] - there[0]).max() < 1e-3 * scale
    assert np.abs(here[1] + ground - there[1]).max() < 1e-3 * np.ptp(here[1])
    assert np.abs(here[2] - there[2]).max() < 1e-3 * np.ptp(here[2])


def test_all_supports_with_the_same_motion_are_the_base():
    _, named = engine.solve(rocking({**PULSE, "blocks": ["base"]}))
    _, base = engine.solve(rocking(PULSE))
    assert (named.history.monitors == base.history.monitors).all()


def test_motions_of_a_support_add_up():
    _, whole = engine.solve(rocking(PULSE))
    half = {**PULSE, "amplitude": 2.0}
    _, parts = engine.solve(rocking([half, half]))
    assert np.abs(whole.history.monitors - parts.history.monitors)[:, 0].max() < 1e-9


def test_absolute_displacement_is_that_of_the_base_while_nothing_slips_or_rocks():
    weak = {**PULSE, "amplitude": 0.5}
    _, records = engine.solve(rocking(weak))
    history = records.history
    moved = history.base[:, 2, 0]
    assert np.abs(history.monitors[:, 2] - moved).max() < 2e-3 * np.ptp(moved)  # the joint gives
    assert np.abs(history.monitors[:, 1]).max() < 2e-3 * np.ptp(moved)  # the joint gives


def test_supports_that_move_apart_do_work():
    """Two piers under a lintel; one is carried away slowly: the lintel turns about the end that stays."""
    rise = 0.02
    case = tables(
        block("left", rectangle(-1.5, -1, -0.5, 0), fixed=True),
        block("right", rectangle(0.5, -1, 1.5, 0), fixed=True),
        block("lintel", rectangle(-1.5, 0, 1.5, 0.3)),
        joints={"j": {"friction": 0.7, "kn": 1e9}},
        motion={"kind": "pulse", "shape": "sine", "amplitude": 2 * np.pi * rise / 4.0, "frequency": 0.5,
                "direction": [0.0, 1.0], "blocks": ["right"]},
        analysis={"kind": "time-history", "duration": 3.0},
        damping={"contact_fraction": 1.0},
        monitor=[{"block": "lintel", "quantity": "rotation"}],
    )  # fmt: skip
    summary, records = engine.solve(case)
    # One sine of acceleration a for T lifts by a T²/(2π); the lintel bears on the inner edge of the left pier
    # and the inner edge of the right one.
    lifted = 2 * np.pi * rise / 4.0 * 4.0 / (2 * np.pi)
    assert records.history.monitors[-1, 0] == pytest.approx(np.arctan(lifted / 2.0), rel=0.02)
    supports = records.rows[-1].energy.supports
    assert supports > 0.0
    gained = records.rows[-1].energy.gravity - records.rows[0].energy.gravity
    assert supports == pytest.approx(gained, rel=0.05)
    assert abs(summary["energy_closure"]) < 1e-3


def test_a_step_above_the_limit_is_refused():
    with pytest.raises(CaseError, match=r"0.01 s is above the largest stable step, .*'b' on 'base' vibrates at"):
        engine.solve(rocking(PULSE, time_step=0.01))


def test_a_history_needs_a_duration():
    case = rocking({"kind": "none"})
    del case["analysis"]["duration"]
    with pytest.raises(CaseError, match=r"missing; must be a number > 0 .* where no \[motion\] says how long"):
        engine.solve(case)


def test_too_many_steps_are_refused_before_they_are_done():
    with pytest.raises(SolverError, match=r"more than analysis.max_steps \(1,000\): 'b' on 'base' vibrates"):
        engine.solve(rocking(PULSE, settle=False, max_steps=1000))


def test_a_structure_that_does_not_stand_is_not_shaken():
    case = rocking(PULSE)
    case["block"][1]["vertices"] = [[1.9, 0.0], [2.9, 0.0], [2.9, 1.0], [1.9, 1.0]]
    summary, records = engine.solve(case)
    assert summary["status"] == "does not stand under its dead loads"
    assert summary["collapsed"]
    assert not records.stretches


def test_the_same_bytes_every_time():
    first, second = (engine.solve(rocking(PULSE))[1].history for _ in range(2))
    assert first.monitors.tobytes() == second.monitors.tobytes()


def test_free_fall():
    """A block dropped from 1 m: y = −g t²/2 until it meets the base."""
    case = tables(
        block("base", rectangle(-1, -1, 1, 0), fixed=True),
        block("b", rectangle(-0.5, 0.0, 0.5, 0.5)),
        analysis={"kind": "time-history", "duration": 0.4, "settle": False, "dropped": 3.0},
        damping={"none": True},
        initial=[{"block": "b", "displacement": [0.0, 1.0]}],
        monitor=[{"block": "b", "component": "y"}, {"block": "b", "component": "y", "quantity": "acceleration"}],
    )
    summary, records = engine.solve(case)
    t, (y, a) = records.history.times, records.history.monitors.T
    assert np.abs(y - (1.0 - 0.5 * 9.81 * t**2)).max() < 1e-9
    assert np.abs(a + 9.81).max() < 1e-7
    assert abs(summary["energy_closure"]) < 1e-9


@pytest.mark.parametrize("order", [1, -1])
def test_first_tilts_do_not_depend_on_their_order(order):
    """The lower block with the upper one on it, and the upper one on the lower: each about the corner it stands on."""
    lower = {"blocks": ["b", "upper"], "tilt": 0.05}
    case = rocking({"kind": "none"}, block("upper", rectangle(-0.2, 1.5, 0.2, 2.5)), duration=0.05)
    case["initial"] = [lower, {"block": "upper", "tilt": 0.04}][::order]
    case["monitor"] = [{"block": name, "component": axis} for name in ("b", "upper") for axis in "xy"]
    _, records = engine.solve(case)
    turn = np.array([[np.cos(0.05), -np.sin(0.05)], [np.sin(0.05), np.cos(0.05)]])
    pivot, hinge = np.array([-0.25, 0.0]), np.array([-0.2, 1.5])
    arm = np.array([[np.cos(0.04), -np.sin(0.04)], [np.sin(0.04), np.cos(0.04)]]) @ [0.2, 0.5]
    places = [pivot + turn @ ([0.0, 0.75] - pivot), pivot + turn @ (hinge + arm - pivot)]
    starts = [[0.0, 0.75], [0.0, 2.0]]
    assert records.history.monitors[0] == pytest.approx((np.array(places) - starts).ravel(), abs=1e-4)
