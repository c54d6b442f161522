"""Tall structures whose geometry moves fail at the load of rigid blocks, however soft "auto" joints are in the solver.

Exact: a column of rigid blocks, each on a side of width c in the middle of its joint, stands up to c / H; drums have
c = b. (With a gap beside them blocks could move further than joints deform, so that nothing is frozen.)
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from casefiles import CASES
from engine import Records, block, rectangle, scene, solve, tables
from oracle.rolling_column import fall, foot

from dem_cli.core.engine import measures
from dem_cli.core.engine.job import Job
from dem_cli.core.engine.rigid_joints import motion_that_opens, rigid_points, take_back, unrelieved
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.statics.equilibrium import relax, settle_or_fail, stand

RESOLUTION = 0.002
WIDTH, HEIGHT, GAP = 0.5, 1.0, 3e-4
SIDES, DEEP, THICK = (
    [0.016, 0.008, 0.016],
    1e-4,
    0.0175,
)  # of the thesis's joint: sides, aperture; height of a block [m]


def drums(number: int, **analysis) -> dict:
    """Drums of 0.5 × 1 m, a fixed block 0.3 mm beside the lowest, on the side that they do not lean to."""
    blocks = [block(f"drum-{i}", rectangle(0.0, i * HEIGHT, WIDTH, (i + 1) * HEIGHT)) for i in range(number)]
    beside = block("beside", rectangle(-0.5 - GAP, 0.0, -GAP, 0.5), fixed=True)
    base = block("base", rectangle(-1.0, -1.0, 2.0, 0.0), fixed=True)
    return tables(base, beside, *blocks, analysis={"resolution": RESOLUTION, **analysis})


def profiled(number: int) -> dict:
    """Blocks of 40 × 17.5 mm on the joint of thesis 7.4.1."""
    profile = {"sides": len(SIDES), "lengths": SIDES, "aperture": DEEP}
    column = {"kind": "column", "block": [sum(SIDES), THICK], "courses": number, "base_extension": 0.02}
    joints = {"rough": {"friction": 0.6, "profile": profile}}
    return tables(structure=[column], joints=joints, analysis={"resolution": RESOLUTION})


def started(case: dict | object, *overrides: str) -> tuple[Job, Simulation]:
    """At rest under its dead loads, as analyses do it."""
    made = scene(case, *overrides)
    job = Job.start(made.request, made.model, Records())
    sim = job.first_simulation()
    assert sim.kinematics == "large"
    assert stand(sim, job.budget).state == "equilibrium"
    return job, sim


def raised(sim: Simulation, loads: list[float], most: int = 400_000) -> str:
    """How the last of some loads ends, put on one after the other; multipliers as users know them."""
    verdicts = [
        relax(sim, load / sim.live_scale, DEFAULT.relaxation.tolerance, most, elastic=False).state for load in loads
    ]
    assert verdicts[:-1] == ["equilibrium"] * (len(loads) - 1)
    return verdicts[-1]


@pytest.mark.parametrize("number", [5, 12, 20])
def test_drums_with_a_gap_beside_them_fail_as_rigid_ones(number):
    """On joints of kn·h/W = 1e6 they leaned: 30 drums fell at 0.01609 instead of 0.01667, 3.4 % below."""
    summary, _ = solve(drums(number))
    exact = WIDTH / (number * HEIGHT)
    low, high = summary["failure_load_bracket"]
    assert summary["status"] == "ok"
    assert summary["kinematics"] == "large"
    assert low <= exact * (1 + 0.25 * RESOLUTION)
    assert high >= exact * (1 - 0.25 * RESOLUTION)
    assert high - low <= RESOLUTION * exact
    assert abs(summary["energy_closure"]) < 1e-4
    assert summary["warnings"] == []


def test_a_column_of_40_on_the_joint_of_the_thesis():
    """0.01143, c/H and that of rigid blocks that roll; on elastic joints it was 0.01042."""
    rolling = fall(40, THICK, foot(SIDES, DEEP)).load
    assert rolling == pytest.approx(SIDES[1] / (40 * THICK), rel=1e-9)
    job, sim = started(profiled(40))
    assert raised(sim, [0.7 * rolling, 0.95 * rolling]) == "equilibrium"
    ends = {}
    for share in (0.98, 0.99, 0.995, 1.0 - RESOLUTION, 1.0 + RESOLUTION):
        ends[share] = settle_or_fail(sim, share * rolling / sim.live_scale, job.budget, 2e-4).state
    assert ends.popitem() == (1.0 + RESOLUTION, "failure")
    assert set(ends.values()) == {"equilibrium"}


@pytest.mark.parametrize(("case", "exact"), [(drums(100), 0.005), (profiled(100), SIDES[1] / (100 * THICK))])
def test_a_hundred_stand(case, exact):
    """On joints of kn·h/W = 1e6 they fell by their own weight: "failure load" 5.9e-6, without a word."""
    _, sim = started(case)
    assert raised(sim, [0.6 * exact]) == "equilibrium"


def test_ten_times_the_stiffness_is_the_same_structure():
    stiffer = replace(DEFAULT, stiffness=replace(DEFAULT.stiffness, statics=1e7))
    loads = [solve(drums(12), settings=settings)[0]["failure_load"] for settings in (DEFAULT, stiffer)]
    assert loads[0] == pytest.approx(loads[1], rel=RESOLUTION)


@pytest.mark.parametrize(("ratio", "load", "holds"), [(1e4, 0.6436, False), (1e6, 0.6457, True)])
def test_a_load_that_hangs_on_the_stiffness_says_so(ratio, load, holds):
    """21 blocks, 0.6460 if rigid: on joints of kn·h/W = 1e4 0.4 % are lost, more than the resolution."""
    settings = replace(DEFAULT, stiffness=replace(DEFAULT.stiffness, statics=ratio))
    path = CASES / "verification" / "wall_21_mu070.toml"
    summary, _ = solve(path, "analysis.kinematics=large", "analysis.follow=0", settings=settings)
    assert summary["failure_load"] == pytest.approx(load, rel=RESOLUTION)  # the last bits of a machine decide within it
    assert summary["softer_joints_hold"] is holds
    assert any("on joints 10 times as soft" in warning for warning in summary["warnings"]) is not holds


@pytest.mark.parametrize(
    ("name", "exact"),
    [("wall_21_mu070", 0.64596), ("arch_21_mu040", 0.05216), ("column_14", 0.163265)],
)
def test_moving_geometry_carries_what_that_of_the_start_does(name, exact):
    """Where all joints are closed, both are the same structure; the books close, too."""
    path = CASES / "verification" / f"{name}.toml"
    summary, _ = solve(path, "analysis.kinematics=large", "analysis.follow=0")
    assert summary["failure_load"] == pytest.approx(exact, rel=0.0025)
    assert abs(summary["energy_closure"]) < 1e-3


def test_forces_stay_and_blocks_go_back():
    """Five drums under half of their load: all closure is taken back at once, to the last digit of the forces."""
    _, sim = started(drums(5))
    relax(sim, 0.05 / sim.live_scale, 1e-9)
    points = rigid_points(sim)
    pressed, slid = sim.contacts.normal.copy(), sim.contacts.shear.copy()
    assert len(points) == 2 * 5
    assert unrelieved(sim, points) > 0.1
    leans = sim.places()[sim.free, 0] - sim.first_places[sim.free, 0]
    take_back(sim, points)
    assert unrelieved(sim, points) < 1e-4
    assert (sim.contacts.normal == pressed).all()
    assert (sim.contacts.shear == slid).all()
    still = sim.places()[sim.free, 0] - sim.first_places[sim.free, 0]
    assert np.abs(still).max() < 0.05 * np.abs(leans).max()  # what is left slid along the joints
    carried = sim.joints.kn * (sim.contacts.closure - sim.measured().gaps)
    assert carried[points] == pytest.approx(pressed[points], rel=1e-9)


def test_given_stiffness_is_a_property():
    """Joints with a kn close as they do: a block sinks by W / kn A, and nothing of it is taken back."""
    kn = 1e6
    blocks = [block("base", rectangle(-1, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))]
    case = tables(*blocks, joints={"dry": {"friction": 0.6, "kn": kn}}, analysis={"kinematics": "large"})
    _, sim = started(case)
    sunk = sim.first_places[1, 1] - sim.places()[1, 1]
    assert sunk == pytest.approx(2000.0 * 9.81 / kn, rel=1e-4)
    assert not len(rigid_points(sim))


def test_a_load_path_to_next_to_failure_stands():
    """30 drums to 0.99 of their load, where elastic joints leave 0.965."""
    case = drums(30)
    case["analysis"] = {"kind": "cycle", "path": [0.0165], "step": 0.0055}
    assert solve(case)[0]["status"] == "ok"


def test_a_tall_stack_stands_a_settlement():
    """Of 1 mm; joints chosen for overlaps alone let 30 drums fall by their own weight."""
    case = drums(30)
    case["analysis"] = {"kind": "settlement"}
    case["settlement"] = [{"block": "base", "displacement": [0.0, -0.001]}]
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["largest_displacement"] == pytest.approx(0.001, rel=0.01)


def test_what_round_off_leaves_too_soft_is_said():
    """300 drums need kn·h/W = 3e8; forces would then balance to 4e-5 of the weight at best, not to 1e-5."""
    said = {}
    for number in (30, 300):
        made = scene(drums(number))
        job = Job.start(made.request, made.model, Records())
        said[number] = " ".join(job.outcome([job.first_simulation()], {"status": "ok"}).summary["warnings"])
    assert "as stiff as round-off allows" in said[300]
    assert said[30] == ""


def test_a_block_on_two_points_side_by_side_does_not_turn_into_its_neighbours():
    """A block over a head joint: closures that differ by 0.5 µm, 10 µm apart, are no turn of 0.05 (which it made)."""
    supports = [
        block("left", rectangle(-1, -1, 0, 0), fixed=True),
        block("right", rectangle(1e-5, -1, 1, 0), fixed=True),
    ]
    crate = block("crate", rectangle(-0.5, 0, 0.5, 1))
    _, sim = started(tables(*supports, crate, analysis={"kind": "gravity", "kinematics": "large"}))
    x = sim.joints.points[:, 0]
    middle = np.abs(x) < 0.1
    sim.contacts.normal[:] = np.where(middle, 1e4, 0.0)
    gaps = np.where(middle, np.where(x > 5e-6, -0.5e-6, -1e-6), 0.0)
    moved = motion_that_opens(sim, np.flatnonzero(middle), gaps)
    assert middle.sum() == 2
    assert abs(moved[-1, 2]) < 1e-4
    assert moved[-1, 1] == pytest.approx(0.75e-6, rel=0.5)


def test_balance_is_not_asked_for_beyond_round_off():
    """Coordinates of 1 km are known to 1e-13 m: a block of 4 m² on kn·h/W 1e6 rests to about 1e-7 of its weight."""
    case = drums(2)
    _, near = started(case)
    for one in case["block"]:
        one["vertices"] = [[x + 1000.0, y] for x, y in one["vertices"]]
    _, far = started(case)
    assert measures.round_off(near) < 1e-8
    assert measures.round_off(far) == pytest.approx(1000.0 / 2.0 * measures.round_off(near), rel=0.5)


@pytest.mark.parametrize(
    "wall",
    [
        {"kind": "coursed-wall", "size": [1.6, 1.2], "thickness": 0.4, "spacing": [0.3, 0.03], "segment": [0.8, 0.2],
         "head_spacing": [0.5, 0.1], "deviation": [0.0, 0.01]},
        {"kind": "wall", "block": [0.5, 0.25], "courses": 6, "blocks_per_course": 3},
    ],
)  # fmt: skip
def test_the_same_joints_open_and_press_in_both_geometries(wall):
    """Head joints that springs open carry nothing in either one; they closed again where closure was taken back, and
    forces differed by 1 % of the weight.
    """
    case = tables(structure=[wall], joints={"dry": {"friction": 0.6}})
    forces = {}
    for kinematics in ("fixed", "large"):
        made = scene(case, f"analysis.kinematics={kinematics}")
        job = Job.start(made.request, made.model, Records())
        sim = job.first_simulation()
        assert stand(sim, job.budget).state == "equilibrium"
        steps = []
        for load in (0.08, 0.16, 0.24):
            assert raised(sim, [load]) == "equilibrium"
            steps.append(np.bincount(sim.joints.owners, sim.measured().normal, len(sim.joints.blocks)))
        forces[kinematics] = np.array(steps)
    weight = np.abs(made.model.dead_loads).sum()
    assert (forces["fixed"] == 0.0).any()
    assert forces["large"] == pytest.approx(forces["fixed"], abs=1e-6 * weight)


def test_open_points_stay_open_by_no_more_than_springs_opened_them():
    """A wall over two grounds, of which one settles: joints open by far more than springs do, and close again. Blocks
    overlapped by 1.6 mm where all of that opening was kept."""
    grounds = [
        block("left", rectangle(-0.5, -0.5, 1.29, 0.0), fixed=True),
        block("right", rectangle(1.29, -0.5, 3.2, 0.0), fixed=True),
    ]
    wall = {"kind": "wall", "block": [0.43, 0.21], "courses": 6, "blocks_per_course": 6, "base": False}
    case = tables(*grounds, structure=[wall], analysis={"kind": "settlement"})
    case["settlement"] = [{"block": "right", "displacement": [0.003, -0.005]}]
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["largest_overlap"] < 1e-3 * 0.21
