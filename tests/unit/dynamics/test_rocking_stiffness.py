"""Stiffness of "auto" joints in time histories: the angle that it goes by, and what bounds it."""

from __future__ import annotations

import math
from dataclasses import replace

import engine
import numpy as np
import pytest
from engine import block, rectangle, scene, tables
from oracle.base_motion import Sine
from oracle.newmark_slider import Slope, slide

from dem_cli.analyses.estimate import describe
from dem_cli.analyses.stiffness_check import change, trifles
from dem_cli.analyses.time_history import alone
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.rocking_stiffness import rocking_stiffness, turn_sideways
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.model.scales import smallest_edge
from dem_cli.core.records.requests import MonitorRequest
from dem_cli.masonry.assembly.solver_request import solver_request
from dem_cli.results.output.ending import ending_words

KN, DENSITY, G = 1e9, 2000.0, 9.81
GROUND = block("ground", rectangle(-30.0, -1.0, 30.0, 0.0), fixed=True)
ROCKING = DEFAULT.rocking


def drums(n: int, b: float, h: float, left: float = 0.0, foot: float = 0.0) -> list[dict]:
    return [block(f"d{left:g}-{i}", rectangle(left, foot + i * h, left + b, foot + (i + 1) * h)) for i in range(n)]


def turn(*blocks: dict) -> float:
    """ε of blocks on joints of KN."""
    case, model = scene(
        tables(GROUND, *blocks, density=DENSITY, joints={"dry": {"friction": 0.7, "kn": KN, "points": 2}})
    )
    properties = joint_properties(solver_request(case), model)
    return turn_sideways(model, joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints)


def chosen(*blocks: dict, duration: float = 10.0, kn="auto", settings=DEFAULT, **analysis):
    shaken = {"analysis": {"kind": "time-history", "duration": duration, **analysis}, "motion": {"kind": "none"}}
    joints = {"dry": {"friction": 0.7, "kn": kn}}
    case, model = scene(tables(GROUND, *blocks, density=DENSITY, joints=joints, **shaken))
    return rocking_stiffness(solver_request(case), model, settings)


def of_drums(n: int, b: float, h: float) -> float:
    """Sum of the rotations of all joints, each moment over kn b³/4: two springs of kn b/2 at the ends of the joint."""
    weight = DENSITY * G * b * h
    return sum(weight * h * (n - j) ** 2 / 2 for j in range(n)) / (KN * b**3 / 4)


@pytest.mark.parametrize("aspect", [0.3, 2.0, 10.0])
def test_one_block(aspect):
    """2 ρ g (h/b)²/kn."""
    assert turn(*drums(1, 0.4, 0.4 * aspect)) == pytest.approx(2.0 * DENSITY * G * aspect**2 / KN, rel=1e-6)


@pytest.mark.parametrize("n", [2, 8, 20])
def test_columns_of_drums(n):
    assert turn(*drums(n, 0.5, 0.4)) == pytest.approx(of_drums(n, 0.5, 0.4), rel=1e-4)


def test_columns_side_by_side_do_not_hold_each_other():
    """Their head joints carry nothing, and open."""
    assert turn(*drums(5, 0.5, 0.4), *drums(5, 0.5, 0.4, left=0.5)) == pytest.approx(of_drums(5, 0.5, 0.4), rel=1e-3)


def test_a_pinnacle_on_a_wall_counts():
    wall = block("wall", rectangle(0.0, 0.0, 8.0, 3.0))
    one = of_drums(1, 0.3, 1.8)
    assert turn(wall, *drums(1, 0.3, 1.8, left=2.0, foot=3.0)) == pytest.approx(one, rel=0.02)


def test_what_nothing_holds_does_not_count():
    assert turn(*drums(1, 0.5, 1.0), block("up", rectangle(5.0, 0.5, 6.0, 1.0))) == pytest.approx(
        of_drums(1, 0.5, 1.0), rel=1e-3
    )


@pytest.mark.parametrize("aspect", [2.0, 7.0])
def test_the_wanted_turn_is_met(aspect):
    found = chosen(*drums(1, 0.5, 0.5 * aspect))
    assert found.turn == pytest.approx(ROCKING.turn, rel=1e-6)
    # kn h/W counts W over √(b h) for a joint, here over b
    assert found.ratio == pytest.approx(2.0 * aspect**2 / ROCKING.turn / math.sqrt(aspect), rel=1e-6)


def test_never_softer_than_the_least():
    assert chosen(block("slab", rectangle(0.0, 0.0, 8.0, 0.5))).ratio == DEFAULT.stiffness.dynamics


def test_given_stiffness_is_not_touched():
    found = chosen(*drums(1, 0.5, 3.0), kn=1e8)
    assert not found.automatic
    assert found.applied(DEFAULT) == DEFAULT


def test_bounds():
    """The user's time step, and work per √(height/g): a tenth of the steps."""
    blocks = drums(4, 0.5, 1.0)
    free = chosen(*blocks)
    steps = free.work / (8 + ROCKING.points_per_step)  # per second
    tenth = replace(ROCKING, work=0.1 * free.work * math.sqrt(4.0 / G))
    for found in (chosen(*blocks, time_step=10.0 / steps), chosen(*blocks, settings=replace(DEFAULT, rocking=tenth))):
        assert found.work / (8 + ROCKING.points_per_step) == pytest.approx(0.1 * steps, rel=1e-4)
        assert found.turn == pytest.approx(100.0 * free.turn, rel=1e-3)  # the step goes with √kn
    with_work = replace(DEFAULT, rocking=replace(ROCKING, work=1.0))
    assert chosen(*blocks, settings=with_work).ratio == DEFAULT.stiffness.dynamics


def test_no_joint_knows_the_duration_the_repeats_or_the_limit_of_steps():
    """Many drums, whose stiffness the budget bounds."""
    blocks = drums(20, 0.5, 0.4)
    one = chosen(*blocks)
    assert one.turn > 2.0 * ROCKING.turn
    for other in ({"duration": 60.0}, {"duration": 0.5}, {"repeats": 6}, {"max_steps": 1000}):
        assert chosen(*blocks, **other) == one


def test_a_model_and_its_prototype_turn_alike():
    """√(height/g) is the time of rocking: the scale of a structure changes no angle."""
    small, large = chosen(*drums(20, 0.05, 0.04)), chosen(*drums(20, 0.5, 0.4))
    assert large.turn > 2.0 * ROCKING.turn  # bounded by the budget
    assert small.turn == pytest.approx(large.turn, rel=1e-6)


def test_round_off_bounds_it():
    """Far from the origin among blocks: digits of places are forces."""
    far = block("far", rectangle(900.0, -1.0, 901.0, 0.0), fixed=True)
    column, other = drums(4, 0.5, 1.0), drums(1, 0.5, 0.5, left=900.2)
    near, away = chosen(*column, duration=0.5), chosen(*column, far, *other, duration=0.5)
    assert away.ratio < 0.1 * near.ratio


def run(kn, *blocks: dict, settings=DEFAULT, **more):
    watched = {"monitor": [{"block": blocks[-1]["id"], "quantity": "rotation"}], "damping": {"restitution": "housner"}}
    joints = {"dry": {"friction": 5.0, "kn": kn}}
    case = tables(GROUND, *blocks, density=DENSITY, joints=joints, **watched, **more)
    return engine.solve(case, settings=settings)[0]


PULSE = {"motion": {"kind": "pulse", "shape": "sine", "amplitude": 3.0, "frequency": 1.0}}
SHORT = {"analysis": {"kind": "time-history", "duration": 1.5}}


def test_a_run_says_what_it_chose_and_how_far_its_peaks_move():
    found = run("auto", *drums(1, 0.5, 2.0), **PULSE, **SHORT)
    assert found["elastic_turn"] == pytest.approx(ROCKING.turn)
    assert 0.0 <= found["softer_joints_move"] < ROCKING.moved
    assert found["warnings"] == []
    assert "elastic_turn" not in run(1e9, *drums(1, 0.5, 2.0), **PULSE, **SHORT)


def test_ensembles_and_estimates_choose_alike():
    """A fragility, a single run and `dem check`: one structure, one step."""
    blocks = drums(1, 0.5, 2.0)
    levels = {"unit_acceleration": 3.0, "intensities": [0.5, 1.0]}
    case = tables(GROUND, *blocks, joints={"dry": {"friction": 5.0}}, **PULSE, **SHORT)
    many = {"kind": "fragility", "duration": 1.5} | levels
    single, ensemble = (engine.solve({**case, "analysis": a})[0]["time_step"] for a in (SHORT["analysis"], many))
    assert ensemble == single
    assert dict(describe(*scene(case)))["time step"].startswith(f"{single:.3g} s")


def test_a_run_on_joints_that_had_to_stay_soft_says_what_that_changed():
    """The change that was measured on still softer joints, not a number that holds for other structures."""
    soft = replace(DEFAULT, rocking=replace(ROCKING, work=1.0))
    gentle = {"motion": PULSE["motion"] | {"amplitude": 1.8}}
    found = run("auto", *drums(1, 0.5, 3.5), settings=soft, **gentle, **SHORT)
    assert found["elastic_turn"] > ROCKING.doubtful
    moved = found["softer_joints_move"]
    assert moved > ROCKING.moved
    assert "joints are softer than rocking asks for" in found["warnings"][0]
    assert f"on joints 10 times as soft peaks move, rotation of 'd0-0' by {moved:.1%}" in found["warnings"][0]
    falls = run("auto", *drums(1, 0.5, 3.5), settings=soft, **PULSE, **SHORT)
    assert "on joints 10 times as soft it collapses as well" in falls["warnings"][0]


def test_a_run_that_falls_on_softer_joints_says_so_beside_its_result():
    """Just below the pulse that overturns it on joints that had to stay soft."""
    soft = replace(DEFAULT, rocking=replace(ROCKING, work=1.0))
    motion = {"motion": PULSE["motion"] | {"amplitude": 1.95}}
    found = run("auto", *drums(1, 0.5, 3.5), settings=soft, **motion, **SHORT)
    assert found["collapsed"] is False
    assert ending_words(found).endswith("; on softer joints it collapses")
    assert any("on joints 10 times as soft the structure collapses" in text for text in found["warnings"])


@pytest.mark.parametrize(("amplitude", "friction"), [(4.0, 0.2), (9.0, 0.2), (3.0, 0.1)])
def test_a_block_that_slides_does_not_hang_on_its_stiffness(amplitude, friction):
    """Its largest slip is Newmark's. Bounce and turn are ten times as large on softer joints, and nothing."""
    motion = {"kind": "pulse", "shape": "sine", "amplitude": amplitude, "frequency": 1.0}
    follow = [("displacement", "x"), ("displacement", "y"), ("velocity", "x"), ("velocity", "y"), ("rotation", None)]
    watched = [{"block": "d0-0", "quantity": q} | ({"component": c} if c else {}) for q, c in follow]
    case = tables(GROUND, *drums(1, 0.5, 0.2), density=DENSITY, joints={"dry": {"friction": friction}}, monitor=watched,
                  motion=motion, analysis={"kind": "time-history", "duration": 2.0})  # fmt: skip
    found, records = engine.solve(case)
    exact = np.abs(slide(Slope(friction), Sine(amplitude, 1.0, 0.0, 1.0), 2.0).slips).max()
    assert np.abs(records.history.monitors[:, 0]).max() == pytest.approx(exact, rel=2e-3)
    assert found["softer_joints_move"] < ROCKING.moved
    assert not any("as soft" in text for text in found["warnings"])


def test_peaks_that_matter_are_compared():
    """Of one that is a thousandth of another of its kind, and of a thousandth of the block, nothing is said."""
    monitors = [MonitorRequest(q, "x", selected="b") for q in ("displacement", "displacement", "velocity")]
    peaks = np.array([2.0, 1.9e-3, 3.0])
    least = trifles(monitors, peaks, 0.5, 9.81, DEFAULT)
    assert least == pytest.approx([2e-3, 2e-3, 3e-3])
    assert trifles(monitors, 1e-9 * peaks, 0.5, 9.81, DEFAULT) == pytest.approx([5e-4, 5e-4, 1e-3 * np.sqrt(4.905)])
    assert change(peaks, np.array([2.2, 1.0e-3, 3.0]), least) == pytest.approx([1.0 / 11.0, 0.0, 0.0])
    assert change(peaks, np.array([2.0, 4e-3, 3.0]), least) == pytest.approx([0.0, 2.1 / 4.0, 0.0])


def repeated(**changes) -> tuple[dict, list]:
    """A block whose friction differs from run to run, which does not matter to one that rocks; and its rows."""
    analysis = SHORT["analysis"] | {"repeats": 3, "perturb": {"friction": 0.1, "geometry": 0.0, "motion": 0.0}}
    watched = {"monitor": [{"block": "d0-0", "quantity": "rotation"}], "damping": {"restitution": "housner"}}
    joints = {"dry": {"friction": 5.0, "kn": "auto"}}
    blocks = drums(1, 0.5, 2.0)
    case = tables(GROUND, *blocks, density=DENSITY, joints=joints, **watched, **PULSE, analysis=analysis | changes)
    return engine.solve(case)


def test_repeats_are_the_structure_of_the_run_beside_them():
    """Nothing that matters differs: their peaks are the one of the case to the last digits, on its very joints."""
    summary, records = repeated()
    peaks = summary["repeats"]["peaks"][0]
    own = np.abs(records.history.monitors[:, 0]).max()
    assert peaks["min"] == pytest.approx(own, rel=1e-3)
    assert peaks["max"] == pytest.approx(own, rel=1e-3)
    assert not any("chance" in text for text in summary["warnings"])


def test_peaks_that_their_repeats_scatter_or_pass_are_told():
    """Of structures that differ by a tenth, or are another one all."""
    summary, _ = repeated(perturb={"friction": 0.0, "geometry": 0.0, "motion": 0.2})
    assert any(text.startswith("the peak rotation of 'd0-0' hangs on chance") for text in summary["warnings"])
    case = scene(tables(GROUND, *drums(1, 0.5, 2.0), joints={"dry": {"friction": 5.0}}, **PULSE, **SHORT,
                        monitor=[{"block": "d0-0", "quantity": "rotation"}]))[0]  # fmt: skip
    around = {"peaks": [{"min": 1.0, "p16": 1.0, "median": 1.0, "p84": 1.1, "max": 2.0}]}
    assert alone(case, np.array([1.5]), around, 0.2) == []
    for peak in (0.99, 2.01):
        (said,) = alone(case, np.array([peak]), around, 0.2)
        assert f"{peak:.3g}, lies outside of those of its repeats, 1 to 2" in said


def test_a_peak_that_hangs_on_stiffness_is_doubted():
    """Every peak does, by next to nothing; of a block that does not lift off nothing is said but that."""
    strict = replace(DEFAULT, rocking=replace(ROCKING, moved=1e-9))
    found = run("auto", *drums(1, 0.5, 2.0), **PULSE, **SHORT, settings=strict)
    assert 1e-9 < found["softer_joints_move"] < ROCKING.moved
    assert any("peaks move, rotation of 'd0-0' by" in text for text in found["warnings"])
    gentle = {"motion": {"kind": "pulse", "shape": "sine", "amplitude": 0.5, "frequency": 1.0}}
    found = run("auto", *drums(1, 0.5, 2.0), **gentle, **SHORT, settings=strict)
    assert found["softer_joints_move"] is None
    assert ["nothing rocked or slid" in text for text in found["warnings"]] == [True]
