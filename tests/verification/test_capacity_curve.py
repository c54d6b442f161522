"""Capacity curves under displacement control against closed forms: blocks that slide or rock, 2D, 3D and a table."""

from __future__ import annotations

import numpy as np
import pytest
from engine import Records, block, rectangle, scene, solve, tables
from synthetic.spatial_case import extruded_tables

from dem_cli.core.engine import measures
from dem_cli.core.engine.job import Job
from dem_cli.core.statics.bilinear import bilinear
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.displacement_control import CapacityCurve, CurvePoint, DisplacementControl, trace
from dem_cli.core.statics.equilibrium import stand
from dem_cli.core.statics.implicit_control import ImplicitControl

BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)


def controlled(follow: float, *blocks: dict, friction: float = 0.6, kn: float | None = None, **analysis) -> dict:
    joint = {"friction": friction} | ({} if kn is None else {"kn": kn, "ks": kn, "points": 5})
    keys = {"control": "displacement", "follow": follow, "increments": 40, **analysis}
    return tables(BASE, *blocks, joints={"dry": joint}, analysis=keys)


def curve_of(summary: dict) -> tuple[np.ndarray, np.ndarray]:
    found = summary["capacity_curve"]
    return np.array(found["displacements"]), np.array(found["loads"])


@pytest.mark.parametrize("pattern", ["mass", "tilt"])
def test_a_block_that_slides(pattern):
    """Elastic with the stiffness of its joint, then flat at μ; the bilinear system is the curve."""
    kn, weight = 2e8, 2000.0 * 9.81
    summary, _ = solve(controlled(0.002, block("b", rectangle(0, 0, 1, 0.2)), kn=kn, pattern=pattern))
    u, loads = curve_of(summary)
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(0.6, rel=2e-3)
    assert loads.max() == pytest.approx(0.6, rel=2e-4)  # at rest: 1e-4 of the own weight unbalanced
    assert loads[-1] == pytest.approx(0.6, rel=2e-4)
    system = bilinear(u, loads)
    if pattern == "mass":
        top = 1.0 + 3 * 0.1**2 / 0.5**2  # a push at half of the height turns the block on its joint, h/2 over it
        assert system.stiffness * 0.2 * weight == pytest.approx(kn / top, rel=0.01)  # the windward points slip first
    assert system.yield_load == pytest.approx(0.6, rel=2e-3)


def test_a_block_that_rocks():
    """λ = tan(α − θ) over its whole way: peak b/h, nothing where its centre is over its corner."""
    width, height = 0.2, 1.0
    summary, records = solve(controlled(0.09, block("b", rectangle(0, 0, width, height)), friction=2.0))
    u, loads = curve_of(summary)
    assert summary["failure_load"] == pytest.approx(width / height, rel=2e-3)
    lean = np.arctan2(width, height)
    radius = np.hypot(width, height) / 2.0
    turned = lean - np.arcsin(np.clip(np.sin(lean) - u / radius, -1.0, 1.0))
    rocks = u > 1e-3  # before, its joint opens
    assert rocks.sum() > 20
    assert loads[rocks] == pytest.approx(np.tan(lean - turned[rocks]), abs=2e-4)
    assert summary["capacity_curve"]["whole"]
    assert abs(summary["energy_closure"]) < 1e-3
    stages = [row.stage for row in records.rows]
    assert stages == sorted(stages, key=["gravity", "loading", "collapse"].index)
    assert "collapse" in stages


def test_to_and_fro():
    """The loop of a block that slides on an elastic joint: friction takes 4 μ W (u − 2 μ W/k) per cycle between ±u."""
    kn, far, weight = 2e8, 0.002, 0.2 * 2000.0 * 9.81
    path = [far, -far, far]
    keys = {"kind": "cycle", "control": "displacement", "path": path, "step": 2e-4}
    joint = {"friction": 0.6, "kn": kn, "ks": kn, "points": 5}
    case = tables(BASE, block("b", rectangle(0, 0, 1, 0.2)), joints={"dry": joint}, analysis=keys)
    summary, records = solve(case)
    loads = [point["load"] for point in summary["turning_points"]]
    assert loads == pytest.approx([0.6, -0.6, 0.6], rel=2e-4)
    assert [point["controlled"] for point in summary["turning_points"]] == path
    elastic = 0.6 * weight / (kn / (1.0 + 3 * 0.1**2 / 0.5**2))
    ways = (far - elastic) + 2 * (2 * far - 2 * elastic)
    assert records.rows[-1].energy.friction == pytest.approx(0.6 * weight * ways, rel=1e-3)


def test_a_block_that_rocks_to_and_fro():
    """On joints of "auto" stiffness: tan(α − θ) to either side, as geometry moves without being told to."""
    keys = {"kind": "cycle", "control": "displacement", "path": [0.04, -0.04], "step": 0.02}
    case = tables(BASE, block("b", rectangle(0, 0, 0.5, 1.0)), joints={"dry": {"friction": 1.0}}, analysis=keys)
    summary, _ = solve(case)
    lean, radius = np.arctan2(0.5, 1.0), np.hypot(0.5, 1.0) / 2.0
    exact = np.tan(np.arcsin(np.sin(lean) - 0.04 / radius))
    assert [point["load"] for point in summary["turning_points"]] == pytest.approx([exact, -exact], rel=2e-3)
    assert summary["status"] == "ok"


def test_a_peak_beyond_the_end_is_said():
    summary, _ = solve(controlled(1e-6, block("b", rectangle(0, 0, 0.2, 1)), friction=2.0))
    assert any("still rises where it ends" in line for line in summary["warnings"])


def test_the_curve_of_a_rocking_block_is_idealised():
    """A curve that falls in a straight line from its peak: ultimate displacement at a fifth of the way down."""
    u = np.concatenate([np.linspace(0.0, 0.01, 50), np.linspace(0.01, 0.1, 50)[1:]])
    loads = np.where(u <= 0.01, 20.0 * u, 0.2 * (0.1 - u) / 0.09)
    system = bilinear(u, loads)
    assert system.softened
    assert system.ultimate_displacement == pytest.approx(0.01 + 0.2 * 0.09)
    assert system.stiffness == pytest.approx(20.0)
    area = 0.5 * 0.01 * 0.2 + 0.5 * (0.2 + 0.16) * 0.2 * 0.09
    taken = system.yield_load * (system.ultimate_displacement - system.yield_displacement / 2.0)
    assert taken == pytest.approx(area, rel=1e-9)
    assert not bilinear(u[:55], loads[:55]).softened
    assert bilinear(u, -loads) is None


def test_a_load_without_end_is_the_peak_and_has_no_idealised_system():
    """A tilting table that stands upright has all of the live load and nothing of the dead ones."""
    curve = CapacityCurve()
    curve.points = [CurvePoint(u, load, u, u) for u, load in ((0.0, 0.0), (1e-3, 2.0), (2e-3, np.inf))]
    curve.peak = 2
    assert curve.first_within(0.05).displacement == 2e-3
    assert bilinear(*curve.arrays()) is None


@pytest.mark.parametrize("kind", ["pushover", "cycle"])
def test_a_live_load_that_cancels_itself_moves_nothing(kind):
    pushes = [{"block": "b", "force": [force, 0.0], "kind": "live"} for force in (1e3, -1e3)]
    keys = {"pushover": {"follow": 0.01}, "cycle": {"path": [0.01], "step": 0.001}}[kind]
    keys = {"kind": kind, "control": "displacement", "pattern": "live"} | keys
    case = tables(BASE, block("b", rectangle(0, 0, 0.2, 1)), load=pushes, analysis=keys)
    summary, _ = solve(case)
    assert summary["status"] == "not converged"
    assert any("the live load moves nothing" in line for line in summary["warnings"])


@pytest.mark.parametrize(("tension", "holds"), [(None, True), (2e4, False)])
def test_a_peak_that_hangs_on_the_stiffness_says_so(tension, holds):
    """A joint that softens as it opens: stiff ones carry W b/2 + ft b²/2, on "auto" ones it has opened at the peak."""
    case = controlled(0.005, block("b", rectangle(0, 0, 0.7, 1.75)), friction=1.0)
    if tension is not None:
        energies = {"fracture_energy_tension": 20.0, "fracture_energy_shear": 100.0}
        case["joints"]["dry"] |= {"law": "fracture", "tension": tension, "cohesion": 3e4} | energies
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["softer_joints_hold"] is holds
    assert any("on joints 10 times as soft" in line for line in summary["warnings"]) is not holds


ROOF = {"name": "roof", "point": [0.0, 1.0], "component": "x"}


def test_control_of_a_monitor():
    """The corner over the heel of a block that rocks: b (1 − cos θ) + h sin θ, where the load is tan(α − θ)."""
    width, height = 0.2, 1.0
    case = controlled(0.06, block("b", rectangle(0, 0, width, height)), friction=2.0, of="roof")
    case["monitor"] = [ROOF]
    summary, records = solve(case)
    u, loads = curve_of(summary)
    lean, diagonal = np.arctan2(width, height), np.hypot(width, height)
    turned = np.arccos((width - u) / diagonal) - np.arctan2(height, width)
    rocks = u > 1e-3
    assert loads[rocks] == pytest.approx(np.tan(lean - turned[rocks]), abs=2e-4)
    assert u[-1] == pytest.approx(0.06, abs=0.0015)
    assert np.diff(u).max() < 1.3 * 0.06 / 40
    assert summary["capacity_curve"]["of"] == "roof"
    assert [row.monitors[0] for row in records.rows][-1] == pytest.approx(u[-1], abs=1e-5)


def test_a_monitor_that_the_load_does_not_move():
    base = {"name": "base", "point": [-1.0, 0.0], "component": "x"}
    case = controlled(0.01, block("b", rectangle(0, 0, 0.2, 1)), of="base")
    case["monitor"] = [base]
    summary, _ = solve(case)
    assert summary["status"] == "not converged"
    assert any("does not move monitor 'base'" in line for line in summary["warnings"])


def test_a_monitor_that_turns_back():
    """The corner over the heel rises until it is over the toe, by √(b² + h²) − h, and comes down."""
    width, height = 0.2, 1.0
    case = controlled(0.03, block("b", rectangle(0, 0, width, height)), friction=2.0, of="roof", loads_at=[0.01, 0.025])
    case["monitor"] = [ROOF | {"component": "y"}]
    summary, _ = solve(case)
    diagonal, lean = np.hypot(width, height), np.arctan2(width, height)
    turned = np.arccos((height + 0.01) / diagonal)  # left to go
    first, second = (one["load"] for one in summary["capacity_curve"]["loads_at"])
    assert first == pytest.approx(np.tan(turned), rel=0.02)  # between the points of the curve in proportion
    assert np.isnan(second) or second is None
    far = summary["capacity_curve"]["bilinear"]["ultimate_displacement"]
    assert 0.0 < far <= diagonal - height
    assert any("turns back at 0.019" in line for line in summary["warnings"]), summary["warnings"]
    assert lean > turned


def test_to_and_fro_of_a_monitor():
    """Turning points are those of the monitor: the corner that is pushed against x goes along with the block."""
    path = [0.001, -0.001]
    keys = {"kind": "cycle", "control": "displacement", "of": "roof", "path": path, "step": 2e-4}
    joint = {"friction": 0.6, "kn": 2e8, "ks": 2e8, "points": 5}
    keys["direction"] = [-1.0, 0.0]
    case = tables(BASE, block("b", rectangle(0, 0, 1, 0.2)), joints={"dry": joint}, analysis=keys)
    case["monitor"] = [ROOF | {"point": [1.0, 0.2]}]
    summary, records = solve(case)
    assert [point["load"] for point in summary["turning_points"]] == pytest.approx([-0.6, 0.6], rel=2e-4)
    moved = [row.monitors[0] for row in records.rows]
    assert moved[-1] == pytest.approx(-0.001, abs=0.02 * 2e-4 + 1e-6)
    assert max(moved) == pytest.approx(0.001, abs=0.02 * 2e-4 + 1e-6)


def test_a_curve_that_ends_with_the_budget_is_kept():
    summary, records = solve(controlled(0.09, block("b", rectangle(0, 0, 0.2, 1)), friction=2.0, max_steps=8000))
    u, loads = curve_of(summary)
    assert summary["status"] == "not converged"
    assert len(u) > 5
    assert not summary["capacity_curve"]["whole"]
    assert loads.max() <= 0.2
    assert any("where the run did: its points so far are kept" in line for line in summary["warnings"])
    assert len(records.rows) == len(u)


@pytest.mark.parametrize("dimension", [2, 3])
def test_implicit_increments(dimension):
    """A block that rocks on another one: the curve of ramps where these make little slip, without any ramp."""
    blocks = [block("a", rectangle(0, 0, 1, 0.4)), block("b", rectangle(0.2, 0.4, 0.5, 1.4))]
    case = controlled(0.01, *blocks, friction=0.5, kn=1e9, kinematics="large")
    made = scene(extruded_tables(case) if dimension == 3 else case)
    job = Job.start(made.request, made.model, Records())
    sim = job.moving_simulation()
    stand(sim, job.budget)
    saved, curves = sim.save(), []
    for kind in (DisplacementControl, ImplicitControl):
        sim.restore(saved)
        control, curve = kind(sim, job.budget, compliance(sim)[0]), CapacityCurve()
        trace(control, curve, 0.01, 1e-3)
        curves.append(curve)
        assert curve.whole
    assert isinstance(control, ImplicitControl)
    assert not control.ramped
    places = [5e-4, 1e-3, 2e-3, 3e-3, 4e-3]
    one, two = (np.interp(places, *curve.arrays()) for curve in curves)
    assert two == pytest.approx(one, rel=1e-3)
    assert curves[1].highest.load == pytest.approx(curves[0].highest.load, rel=1e-3)
    assert abs(measures.closure(sim)) < 1e-3


@pytest.mark.parametrize(("law", "increments"), [("coulomb", "implicit"), ("mohr-coulomb", "ramps")])
def test_a_peak_that_hangs_on_ramps_is_not_claimed(law, increments):
    """To so fine a resolution ramps of two lengths differ: implicit increments, or the load raised from gravity."""
    blocks = [block("a", rectangle(0, 0, 1, 0.4)), block("b", rectangle(0.2, 0.4, 0.5, 1.4))]
    case = controlled(0.004, *blocks, friction=0.3, kn=1e9, kinematics="large", resolution=1e-4, increments=10)
    case["joints"]["dry"] |= {"law": law} | ({} if law == "coulomb" else {"cohesion": 10.0})
    summary, records = solve(case)
    curve = summary["capacity_curve"]
    assert curve["increments"] == increments
    assert summary["start"]["kind"] == ("curve" if increments == "implicit" else "gravity")
    assert any("the peak hangs on the increments" in line for line in summary["warnings"])
    assert summary["failure_load"] == pytest.approx(0.2917, rel=2e-3)
    assert len(records.rows) == len(curve["loads"])
    assert ("peak_load_in_ramps" in curve) == (increments == "implicit")


def test_an_implicit_increment_knows_the_sliding_load():
    """The block of `test_a_block_that_slides`: μ after elastic shear, whose energies are known."""
    kn, weight, far = 2e8, 0.2 * 2000.0 * 9.81, 0.002
    made = scene(controlled(far, block("b", rectangle(0, 0, 1, 0.2)), kn=kn, kinematics="large"))
    sim = (job := Job.start(made.request, made.model, Records())).moving_simulation()
    stand(sim, job.budget)
    control, curve = ImplicitControl(sim, job.budget, compliance(sim)[0]), CapacityCurve()
    trace(control, curve, far, 1e-4)
    u, loads = curve.arrays()
    assert not control.ramped
    assert loads.max() * sim.live_scale == pytest.approx(0.6, rel=2e-4)
    elastic = 0.6 * weight / (kn / (1.0 + 3 * 0.1**2 / 0.5**2))
    assert measures.energy(sim).friction == pytest.approx(0.6 * weight * (u[-1] - elastic), rel=1e-2)


def test_to_and_fro_in_space():
    """The loop of a block that slides, as in the plane: prisms of depth one."""
    kn, far, weight = 2e8, 0.001, 0.2 * 2000.0 * 9.81
    keys = {"kind": "cycle", "control": "displacement", "path": [far, -far, far], "step": 2e-4}
    joint = {"friction": 0.6, "kn": kn, "ks": kn}
    case = tables(BASE, block("b", rectangle(0, 0, 1, 0.2)), joints={"dry": joint}, analysis=keys)
    summary, records = solve(extruded_tables(case))
    assert [point["load"] for point in summary["turning_points"]] == pytest.approx([0.6, -0.6, 0.6], rel=2e-4)
    (loop,) = summary["loops"]
    force = 0.6 * weight
    elastic = force / kn * (1.0 + 0.1**2 / 0.5**2)  # it turns on its four corners
    ways = (far - elastic) + 2 * (2 * far - 2 * elastic)
    assert records.rows[-1].energy.friction == pytest.approx(force * ways, rel=5e-3)
    assert loop["energy"] == pytest.approx(4.0 * force * (loop["displacement"] - elastic), rel=1e-3)
    assert abs(summary["energy_closure"]) < 1e-3
