"""Time histories that break programs: corners inside corners, extreme joints and dampers, starts that cannot be."""

from __future__ import annotations

import json

import engine
import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner
from engine import block, rectangle, tables, turned

from dem_cli.app.cli.main import main
from dem_cli.errors import CaseError, SolverError

PULSE = {"kind": "pulse", "shape": "sine", "amplitude": 7.0, "frequency": 2.0}
GROUND = block("base", rectangle(-3, -1, 3, 0), fixed=True)


def shaken(*blocks: dict, kn: float = 1e9, **more) -> dict:
    """Blocks on the ground, under one sine of 0.7 g."""
    return tables(
        GROUND, *blocks,
        **{
            "joints": {"j": {"friction": 0.7, "kn": kn}}, "motion": PULSE,
            "analysis": {"kind": "time-history", "duration": 0.8}, **more,
        },
    )  # fmt: skip


def column(n: int = 4) -> list[dict]:
    return [block(f"b{i}", rectangle(-0.25, 0.3 * i, 0.25, 0.3 * i + 0.3)) for i in range(n)]


def arch(n: int = 8, inner: float = 1.0, outer: float = 1.2) -> list[dict]:
    angles = np.linspace(0.0, np.pi, n + 1)
    rays = np.column_stack([np.cos(angles), np.where(np.sin(angles) < 1e-12, 0.0, np.sin(angles))])
    return [
        block(f"v{i}", [inner * rays[i], outer * rays[i], outer * rays[i + 1], inner * rays[i + 1]]) for i in range(n)
    ]


@pytest.mark.parametrize("lean", [-0.3, 0.0, 0.2])  # of the faces: corners of 107°, 90° and 79°
@pytest.mark.parametrize("turn", [-0.4, 0.0, 0.4])
def test_corners_inside_each_other_are_pushed_apart_by_one_joint(turn, lean):
    """Whichever way one corner came into the other: never by none of the pairs of faces there, never by two."""
    low, high = [[0, -1], [1, -1], [1, lean], [0, 0]], [[-1, 0.7 * lean], [0, 0], [-0.3, 1], [-1, 1]]
    for direction in np.radians(np.arange(-65, -25, 3)):
        shift = 2e-3 * np.array([np.cos(direction), np.sin(direction)])
        blocks = block("a", low, fixed=True), block("b", np.array(turned(high, turn)) + shift)
        sim = engine.simulation(tables(*blocks), "large")
        pressed = np.minimum.reduceat(sim.measured().gaps, sim.joints.starts[:-1]) < 0.0
        assert pressed.sum() == 1, np.degrees(direction)


@pytest.mark.parametrize("fraction", [5.0, 10.0])
def test_an_arch_that_falls_makes_no_energy(fraction):
    """Voussoirs meet corner to corner while they fall."""
    analysis = {"kind": "time-history", "duration": 0.8, "fallen_deg": 179.0, "dropped": 5.0}
    case = shaken(*arch(), damping={"contact_fraction": fraction}, analysis=analysis)
    summary, records = engine.solve(case)
    energies = [row.energy for row in records.rows]
    errors = [
        e.kinetic + e.elastic + e.gravity + e.friction + e.dashpots - e.external for e in energies
    ]  # fmt: skip
    assert summary["largest_displacement"] > 0.5
    assert np.diff(errors).max() < 0.03 * max(abs(e.gravity) for e in energies)


# -- what a run answers must not depend on what is looked at ----------------------------------------


@pytest.mark.parametrize("output", [{"rate": 50.0}, {"rate": 3333.0}, {"rate": 1e5}, {"rate": 500.0, "frames": 40}])
def test_looking_changes_no_bit(output):
    """Collapse time, energies and places, whatever rate and frames: the samples that both have are the same."""
    analysis = {"kind": "time-history", "duration": 0.7, "fallen_deg": 20.0}
    monitor = [{"block": "v3", "quantity": "rotation"}]
    plain, more = (
        engine.solve(shaken(*arch(), analysis=analysis, monitor=monitor, output={"frames": 0, **o}))
        for o in ({"rate": 500.0}, output)
    )
    for key in ("collapse_time", "largest_displacement", "energy_closure", "energy_shares", "steps"):
        assert plain[0][key] == more[0][key]
    assert plain[0]["collapsed"]
    first, second = plain[1].history, more[1].history
    assert (np.diff(second.times) > 0.0).all()
    _, i, j = np.intersect1d(first.times, second.times, return_indices=True)
    assert len(i) >= 2
    assert (first.monitors[i] == second.monitors[j]).all()


# -- dampers and joints ------------------------------------------------------------------------------


def test_maxwell_elements_take_energy_where_joints_slip():
    """They do not hold on to a force that would push on what slips."""
    elements = [{"ratio": 0.49, "frequency": 1.0}]
    summary, records = engine.solve(shaken(*column(), damping={"maxwell": elements}))
    lost = [row.energy.maxwell for row in records.rows]
    assert summary["energy_shares"]["friction"] > 0.3
    assert min(lost) > -1e-3 * max(lost)
    assert abs(summary["energy_closure"]) < 1e-3


def test_the_limit_of_a_step_knows_maxwell_elements():
    plain = engine.solve(shaken(*column(), motion={"kind": "none"}))[0]["largest_time_step"]
    case = shaken(
        *column(), damping={"maxwell": [{"ratio": 0.4, "frequency": 1.0}]},
        analysis={"kind": "time-history", "duration": 0.1, "time_step": 0.9 * plain},
    )  # fmt: skip
    with pytest.raises(CaseError, match="above the largest stable step"):
        engine.solve(case)


def test_books_without_gravity():
    """Blocks that float, and stand still relative to the base when it does: no energy is left, and none is missing."""
    summary, _ = engine.solve(shaken(*column(), gravity=0.0))
    assert summary["status"] == "ok"
    assert abs(summary["energy_closure"]) < 1e-12


@pytest.mark.parametrize("kind", ["time-history", "fragility"])
@pytest.mark.parametrize("stiffness", [{}, {"kn": "auto"}])
def test_joints_of_automatic_stiffness_need_weights(kind, stiffness):
    """Their stiffness goes by the weights, so that blocks of none blew up on joints of next to nothing."""
    case = shaken(*column(), gravity=0.0, joints={"j": {"friction": 0.7, **stiffness}})
    case["analysis"] = {"kind": kind} | ({"intensities": [1.0]} if kind == "fragility" else {})
    with pytest.raises(CaseError) as refused:
        engine.scene(case)
    (problem,) = refused.value.problems
    assert problem.path == ("gravity",)
    assert f"0 is not allowed in kind = '{kind}' where joints.j.kn is 'auto'" in problem.message
    case["analysis"] = {"kind": "gravity"}
    engine.scene(case)


def test_joints_too_stiff_for_rest_are_given_up_early():
    case = shaken(*column(), kn=1e15)
    case["analysis"]["max_steps"] = 200_000
    with pytest.raises(SolverError, match="no rest under dead loads was found in 200,000 steps before the motion"):
        engine.solve(case)


# -- starts ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "pair"),
    [
        ({"block": "b3", "displacement": [0.0, -0.01]}, "'b2' and 'b3' 0.01 m"),
        ({"block": "b3", "displacement": [0.0, -0.3]}, "'b2' and 'b3' 0.3 m"),
        ({"block": "b0", "tilt": 0.1}, "'b0' and 'b1' 0.0484 m"),
    ],
)
def test_a_start_inside_another_block_is_refused(start, pair):
    with pytest.raises(CaseError, match=f"puts blocks {pair} into each other"):
        engine.solve(shaken(*column(), initial=[start]))


@pytest.mark.parametrize("kn", [1e6, 1e9])
def test_a_start_that_touches_is_not_refused(kn):
    """Soft joints are inside each other at rest already."""
    summary, _ = engine.solve(shaken(*column(), kn=kn, initial=[{"blocks": ["b2", "b3"], "tilt": 0.02}]))
    assert summary["status"] == "ok"
    assert abs(summary["energy_closure"]) < 1e-2


def test_a_run_that_makes_energy_stops_and_keeps_what_came_before(tmp_path):
    """A block that falls, at 0.9 of the longest stable step. Exit 3; when, where and why; results up to there."""
    case = tables(
        block("base", rectangle(-2, -0.5, 2, 0), fixed=True),
        block("b", rectangle(-0.25, 0, 0.25, 1)),
        joints={"j": {"friction": 10.0, "kn": 1e9}},
        analysis={"kind": "time-history", "duration": 1.0, "margin": 0.9},
        damping={"contact_fraction": 0.0},
        initial=[{"block": "b", "velocity": [0.0, -0.1, 0.0]}],
        monitor=[{"block": "b", "component": "y"}],
    )
    path = tmp_path / "case.toml"
    path.write_text(tomli_w.dumps(case), encoding="utf-8")
    result = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "out"), "-q"])
    assert result.exit_code == 3, result.output
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["status"] == "not converged"
    assert any(text.startswith("blew up at 0.1") and "block 'b' is the fastest" in text for text in summary["warnings"])
    assert summary["reached"]["stage"] == "shaking"
    assert len((tmp_path / "out" / "history.csv").read_text(encoding="utf-8").splitlines()) >= 2  # names and values
