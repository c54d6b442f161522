"""The zero-dilation path: exact loads, the law at its states, folds, and what it says when it cannot finish."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engine import block, rectangle, scene
from engine.limits import mirrored_model, on_a_base, rotated, tower

from dem_cli.app.cli.words.limit_loads import limit_rows
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads, start_structure
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.elastic import Elastic
from dem_cli.core.limit.interior import Increment
from dem_cli.core.limit.path import FALLS, OK, UNFINISHED, at_rest, trace
from dem_cli.core.limit.path import Path as LoadPath
from dem_cli.core.limit.settings import DEFAULT_LIMIT
from dem_cli.core.limit.slips import apart

CASES = Path(__file__).resolve().parents[3] / "cases" / "verification"
EXACT = {  # closed forms and published exact loads
    "sliding_block": (0.4, 1e-6),
    "tilting_table": (0.25, 1e-6),
    "trilith": (0.2, 1e-6),
    "column_14": (8 / 49, 1e-6),  # (w/h)/14 of the data book
    "wall_21": (0.6, 1e-6),
    "arch_21": (0.1483, 4e-4),
    "arch_21_mu040": (0.0522, 1e-3),
    "portal": (0.3247, 1e-4),
}


def ingredients(case, *overrides):
    made = scene(case, *overrides)
    structure = start_structure(made.model, joint_properties(made.request, made.model))
    return structure, friction_of(structure.joints, law_of(made.request))


@pytest.mark.parametrize("name", EXACT)
def test_exact_loads(name):
    load, tolerance = EXACT[name]
    path = trace(*ingredients(CASES / f"{name}.toml"))
    assert path.status == OK
    assert path.load == pytest.approx(load, rel=tolerance)


def test_a_rest_on_the_way_is_no_plateau():
    """The load rests for ten increments below what `dem limit --lower` proves that the arch carries."""
    structure, friction = ingredients(CASES / "arch_segmental_mu050.toml")
    lower, upper = 1.2171, 1.21819
    path = trace(structure, friction)
    assert path.status == OK
    assert lower < path.load < upper
    blind = replace(DEFAULT_LIMIT, path=replace(DEFAULT_LIMIT.path, far_ahead=0.0))
    assert trace(structure, friction, settings=blind).load < lower


@pytest.mark.parametrize(("loads", "fall"), [([0.0, 0.4, 0.5], 0.0), ([0.0, 0.4, 0.3, 0.5], 0.2), ([0.5, 0.1], 0.0)])
def test_a_fall_of_the_load_counts_on_the_way_to_its_highest(loads, fall):
    assert LoadPath(OK, max(loads), loads=loads, highest=loads.index(max(loads))).fall == pytest.approx(fall)


@pytest.mark.parametrize("mu", [0.5, 0.6, 0.75, 1.0])
def test_frictional_heads_do_not_wedge(mu):
    """Thesis Table 5-3, where the associated load is up to 1.0."""
    path = trace(*ingredients(CASES / "wall_21.toml", f"joints.dry.friction={mu}"))
    assert path.load == pytest.approx(min(mu, 0.645963), rel=1e-5)


def test_its_state_obeys_the_law():
    """Balanced, inside the cones, no tension, closed where it presses."""
    structure, friction = ingredients(CASES / "wall_21_mu075.toml")
    path = trace(structure, friction)
    reactions = np.column_stack([path.normal, path.shear]).ravel()
    assert np.abs(structure.imbalance(reactions, path.load)).max() < 1e-5
    assert (path.normal >= 0.0).all()
    weight = structure.scales[0]
    assert (np.abs(path.shear[:, 0]) <= friction * path.normal + 1e-6 * weight).all()
    pressed = path.normal > 1e-3 * weight
    assert path.gaps[pressed] == pytest.approx(-path.normal[pressed] / structure.joints.kn[pressed])
    assert path.residual < 1e-3


def test_its_mechanism_slides_without_opening():
    """The associated mechanism of a sliding block would lift it by μ times the slip."""
    structure, friction = ingredients(on_a_base(block("b", rectangle(0.0, 0.0, 2.0, 0.5)), friction=0.3))
    path = trace(structure, friction)
    motion = path.mechanism[-1]
    assert motion[0] > 0.0
    assert abs(motion[1]) < 1e-6 * motion[0]
    assert float((structure.live * path.mechanism.ravel()[structure.free]).sum()) == pytest.approx(1.0)


def test_the_plateau_does_not_depend_on_stiffness():
    soft = trace(*ingredients(CASES / "wall_21_mu065.toml", "joints.dry.kn=1e9", "joints.dry.ks=2e8"))
    stiff = trace(*ingredients(CASES / "wall_21_mu065.toml"))
    assert soft.load == pytest.approx(stiff.load, rel=3e-3)


@pytest.mark.parametrize("change", ["mirrored", "rotated", "scaled"])
def test_it_does_not_depend_on_the_point_of_view(change):
    made = scene(CASES / "wall_21_mu075.toml")
    properties, law = joint_properties(made.request, made.model), law_of(made.request)
    model = made.model
    if change == "mirrored":
        model = mirrored_model(model)
    elif change == "rotated":
        model = rotated(model, 0.7)
    else:
        model = model._replace(dead_loads=1e3 * model.dead_loads, live_loads=1e3 * model.live_loads)
    loads = []
    for each in (made.model, model):
        structure = start_structure(each, properties)
        loads.append(trace(structure, friction_of(structure.joints, law)).load)
    assert loads[1] == pytest.approx(loads[0], rel=1e-6)


def test_what_does_not_stand():
    assert trace(*ingredients(CASES / "leaning_column.toml")).status == FALLS


def test_too_little_effort_leaves_a_state_in_equilibrium():
    structure, friction = ingredients(CASES / "wall_3.toml")
    path = trace(structure, friction, effort=100 * structure.joints.kn.size)
    assert path.status == UNFINISHED
    assert 0.1 < path.load < 0.4687
    assert path.residual < 1e-2


def test_folds_of_the_central_path_are_gone_round():
    """An increment of this wall stops at a fold; by arc length it arrives, at an equilibrium under the law."""
    structure, friction = ingredients(CASES.parent / "gallery" / "gatehouse.toml", "analysis.follow=0.0")
    problem = Elastic(structure, friction)
    rest = at_rest(problem)
    standing = Increment(problem, rest, None).solve(1.0, folds=6)
    elastic = float(problem.live @ problem.elastic().solve(problem.live))
    target = float(problem.live @ standing.displacements) + 0.25 * elastic
    ahead = {"tau": 0.1 * float(standing.normal.max()) ** 2}
    direct = Increment(problem, standing, target).solve(**ahead, folds=0)
    around = Increment(problem, standing, target).solve(**ahead, folds=6)
    assert around is not None
    assert problem.residual(around, standing) < 1e-2
    if direct is not None:  # where this machine's round-off meets no fold, both arrive at the same place
        assert direct.load == pytest.approx(around.load, rel=1e-2)


def test_rough_states_are_in_equilibrium_and_lead_on():
    """Where an iteration is stopped early; the law holds again at the next increment."""
    structure, friction = ingredients(CASES / "wall_21_mu075.toml")
    patient = DEFAULT_LIMIT.interior_point
    hasty = replace(DEFAULT_LIMIT, interior_point=replace(patient, slow=5))
    problem, stopped = Elastic(structure, friction), Elastic(structure, friction, hasty)
    standing = Increment(problem, at_rest(problem), None).solve(1.0)
    elastic = float(problem.live @ problem.elastic().solve(problem.live))
    origin, tau = float(problem.live @ standing.displacements), 0.01 * float(standing.normal.max()) ** 2
    assert Increment(stopped, standing, origin + 0.3 * elastic).solve(tau) is None
    rough = Increment(stopped, standing, origin + 0.3 * elastic).solve(tau, rough=tau)
    assert 0.0 < rough.left < tau
    assert np.abs(problem.imbalance(rough.normal, rough.shear, rough.load)).max() < 1e-4
    assert (rough.normal > 0.0).all()
    assert (np.abs(rough.shear) < problem.friction * rough.normal).all()
    assert problem.residual(rough, standing) > 1e-2  # N p and c ∘ a are not zero yet
    loads = []
    for before in (standing, rough):
        increment = Increment(problem, before, origin + 0.4 * elastic, end=1e-5)
        found = increment.solve(tau)
        polished = increment.polished()
        assert found.left == polished.left == 0.0
        assert problem.residual(polished, before) < min(1e-3, problem.residual(found, before))
        loads.append(polished.load)
    assert loads[1] == pytest.approx(loads[0], rel=5e-3)


def test_increments_grow_again_after_one_that_failed(monkeypatch):
    structure, friction = ingredients(CASES / "wall_21_mu075.toml")
    solve, tries = Increment.solve, []

    def failing(self, *given):
        tries.append(self.displacement)
        return None if len(tries) in (5, 6) else solve(self, *given)

    monkeypatch.setattr(Increment, "solve", failing)
    path = trace(structure, friction)
    reached = np.array(path.reached[1:])
    growth = reached[1:] / reached[:-1] - 1.0
    assert growth[:2] == pytest.approx([0.3, 0.3])
    assert growth[2:6] == pytest.approx([0.16 * 0.3, 0.16 * 0.3, 0.32 * 0.3, 0.64 * 0.3])
    assert path.status == OK
    assert path.load == pytest.approx(0.645963, rel=1e-4)


RUBBLE = """
[materials.stone]
density = 2140.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "voronoi-wall"
cells = 70
relax = 6
size = [2.6, 2.9]
seed = 8
[analysis]
kind = "pushover"
"""


def test_no_leap_over_a_failure_while_shorter_increments_lead_on(tmp_path):
    """Rubble fails at 0.055; the first increment is hard, one of 2.2 times leads to a branch up to 0.09."""
    (tmp_path / "rubble.toml").write_text(RUBBLE)
    path = trace(*ingredients(tmp_path / "rubble.toml"))
    assert path.status == OK
    assert path.load == pytest.approx(0.05497, rel=1e-3)


def test_light_blocks_on_heavy_ones():
    """Each of two towers tilts at w/h of itself, the weights of which differ by 1e6."""
    heavy, light = tower(2), tower(2)
    for b in heavy:
        b["material"] = "stone"
    for i, b in enumerate(light):
        b |= {"id": f"l{i}", "material": "light", "vertices": [[x + 2.0, y] for x, y in b["vertices"]]}
    case = on_a_base(*heavy, *light, friction=5.0)
    case["block"][0]["material"] = "stone"
    case["materials"] = {**case["materials"], "light": {"density": 2e-3}}
    path = trace(*ingredients(case))
    assert path.load == pytest.approx(0.4, rel=1e-3)


def testapart():
    one, two = apart(np.array([-3.0, 0.0, 1e8, -1e8]), 0.25)
    assert one - two == pytest.approx([-3.0, 0.0, 1e8, -1e8])
    assert one * two == pytest.approx(0.25)


def test_a_smoothed_path_ends_near_the_load_of_the_exact_one():
    structure, friction = ingredients(CASES / "wall_3.toml")
    exact, smoothed = trace(structure, friction), trace(structure, friction, settings=DEFAULT_LIMIT.smoothed())
    assert exact.smoothing == 0.0 < smoothed.smoothing == smoothed.summary()["smoothing"]
    assert "smoothing" not in exact.summary()
    assert smoothed.finished
    assert smoothed.load == pytest.approx(exact.load, rel=2e-3)
    reactions = np.column_stack([smoothed.normal, smoothed.shear]).ravel()
    assert np.abs(structure.imbalance(reactions, smoothed.load)).max() < 1e-6
    assert (np.abs(smoothed.shear[:, 0]) <= friction * smoothed.normal * (1.0 + 1e-6)).all()


@pytest.mark.parametrize("large", [20, 21])
def test_limit_analysis_smooths_the_paths_that_a_run_does(large):
    made = scene(CASES / "wall_21_mu075.toml")
    settings = replace(DEFAULT_LIMIT, path=replace(DEFAULT_LIMIT.path, large=large))
    found = limit_loads(
        made.model,
        joint_properties(made.request, made.model),
        law_of(made.request),
        settings=settings,
    )
    assert (found.non_associated.smoothing > 0.0) == (large < 21)
    assert found.non_associated.load == pytest.approx(0.645963, rel=2e-3)
    assert ("smoothed path: an estimate" in dict(limit_rows(found.summary()))["non-associated"]) == (large < 21)
