"""Settings that only benchmarks change: they reach the solver, and the summary names them."""

from __future__ import annotations

import numpy as np
import pytest
from bench import precision
from bench.cases import KNOWN_STRUCTURES, solve
from bench.points import points_per_joint, refined, shares

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.masonry.assembly.solver_request import solver_request


def test_settings_of_a_run_are_named_in_its_summary():
    case, model = KNOWN_STRUCTURES["COL14"].build()
    assert "settings" not in solve(case, model)
    changed = solve(case, model, settings=precision.tolerance(1e-3))["settings"]
    assert changed == {"relaxation.tolerance": 1e-3, "relaxation.gravity_tolerance": 1e-3}


def test_a_loose_tolerance_overrates_a_column():
    """A claimed equilibrium that is none: the higher the unbalanced force, the higher the load, up to the bound."""
    known = KNOWN_STRUCTURES["COL14"]
    case, model = known.build('analysis.kinematics="large"')  # no bound by limit analysis there
    loose = solve(case, model, settings=precision.tolerance(1e-2))["failure_load"]
    assert known.error(loose) > 0.01
    case, model = known.build()
    assert known.error(solve(case, model, settings=precision.tolerance(1e-2))["failure_load"]) < 1e-4
    assert abs(known.error(solve(case, model)["failure_load"])) < 0.003


def test_shorter_time_steps_need_more_of_them():
    case, model = KNOWN_STRUCTURES["T21 μ 0.5"].build()
    usual = solve(case, model)["steps"]
    assert solve(case, model, settings=precision.time_step(0.5))["steps"] > 1.3 * usual


@pytest.mark.parametrize(
    ("layout", "places"), [("2", [0, 1]), ("3", [0, 0.5, 1]), ("2 inside", [0.25, 0.75]), ("4 inside", [1, 3, 5, 7])]
)
def test_places_of_points(layout, places):
    assert shares(layout) == pytest.approx(np.array(places) / (8 if max(places) > 1 else 1))


def test_refined_joints_have_the_same_stiffness_and_ends():
    case, model = KNOWN_STRUCTURES["T21 μ 0.6"].build()
    sim = Simulation(model, law_of(solver_request(case)), joint_properties(solver_request(case), model))
    joints, contacts = refined(sim.joints, sim.contacts, shares("5"))
    n = len(sim.joints.blocks)
    assert len(joints.kn) == len(contacts.gaps) == 5 * n == joints.starts[-1]
    assert joints.kn.reshape(n, 5).sum(axis=1) == pytest.approx(sim.joints.kn.reshape(n, 2).sum(axis=1))
    for name in ("points", "levers", "frames"):
        fine, ends = getattr(joints, name), getattr(sim.joints, name)
        assert fine[0::5] == pytest.approx(ends[0::2], abs=1e-15)
        assert fine[4::5] == pytest.approx(ends[1::2], abs=1e-15)
        assert fine[2::5] == pytest.approx(0.5 * (ends[0::2] + ends[1::2]), abs=1e-15)


def test_points_at_the_ends_are_exact_and_points_inside_are_not():
    """A wall that rocks about the ends of its joints; two points in the quarters halve its width."""
    known = KNOWN_STRUCTURES["T21 μ 1"]
    case, model = known.build("analysis.resolution=0.01")
    with points_per_joint("3"):
        assert abs(known.error(solve(case, model)["failure_load"])) < 0.01
    with points_per_joint("2 inside"):
        assert known.error(solve(case, model)["failure_load"]) < -0.15
    assert abs(known.error(solve(case, model)["failure_load"])) < 0.01
