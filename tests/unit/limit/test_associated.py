"""The associated load: closed forms, duality, the same answer in other clothes, refusals with their proof."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from engine import MU, block, mirrored, moved, rectangle, running_wall, scene, tables, turned
from engine.limits import on_a_base, renumbered, rotated, solved, tower
from oracle.limit_lp import limit_load as oracle_load

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.laws.coulomb import COULOMB
from dem_cli.core.laws.envelope import envelope
from dem_cli.core.limit import associated
from dem_cli.core.limit.analysis import limit_loads, start_structure
from dem_cli.core.limit.associated import FALLS, GIVEN_UP, LOCKED, OK
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.settings import DEFAULT_LIMIT
from dem_cli.errors import UsageError

ACCEPTED = DEFAULT_LIMIT.associated

NEAR = 1e-6  # relative; the bounds are accepted up to ACCEPTED.gap, and lie closer in all of these


def load(case, **options) -> float:
    """The multiplier, with its claims checked."""
    found = solved(case, **options).associated
    assert found.status == OK
    assert found.residual <= ACCEPTED.residual
    assert found.lower <= found.multiplier * (1 + NEAR) + 1e-12
    assert found.multiplier <= found.upper * (1 + NEAR) + 1e-12
    return found.multiplier


def wall(**more) -> dict:
    return tables(*running_wall(6, 3), **more)


@pytest.mark.parametrize("friction", [0.0, 1e-3, 0.3, 0.7])
def test_a_flat_block_slides_at_its_friction(friction):
    flat = on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), friction=friction)
    assert load(flat) == pytest.approx(friction, rel=2e-5, abs=1e-9)


def test_a_slender_block_rocks_at_width_over_height():
    assert load(on_a_base(block("b", rectangle(0.0, 0.0, 0.3, 1.0)))) == pytest.approx(0.3, rel=NEAR)


def test_a_block_on_a_slope():
    """Sliding down a slope of angle α: λ = tan(φ − α) for a push along x."""
    slope = math.radians(10.0)
    base = block("base", turned(rectangle(-3.0, -1.0, 3.0, 0.0), -slope), fixed=True)
    case = tables(base, block("b", turned(rectangle(-0.5, 0.0, 0.5, 0.2), -slope)))
    assert load(case) == pytest.approx(math.tan(math.atan(MU) - slope), rel=NEAR)


def test_two_blocks_the_upper_one_slides_on_a_smoother_joint():
    case = on_a_base(*tower(2, 1.0, 0.2), materials={"stone": {"density": 1e3}, "marble": {"density": 2e3}})
    for table, material in zip(case["block"], ("stone", "stone", "marble")):
        table["material"] = material
    case["joints"]["smooth"] = {"friction": 0.2}
    case["interface"] = [{"between": ["stone", "marble"], "joint": "smooth"}]
    assert load(case) == pytest.approx(0.2, rel=NEAR)


def test_two_blocks_tied_by_gravity_rock_as_one():
    assert load(on_a_base(*tower(2))) == pytest.approx(0.4, rel=NEAR)


def test_a_live_load_at_the_top_of_a_block():
    """Turning about the toe: F h = W b/2."""
    tall = block("b", rectangle(0.0, 0.0, 0.3, 1.0))
    push = {"block": "b", "force": [2.0, 0.0], "at": [0.0, 1.0], "kind": "live"}
    weight = 0.3 * 2000.0 * 9.81
    case = on_a_base(tall, load=[push], analysis={"pattern": "live"})
    assert load(case) == pytest.approx(weight * 0.15 / 2.0, rel=NEAR)


def test_a_live_load_that_only_turns():
    tall = block("b", rectangle(0.0, 0.0, 0.3, 1.0))
    couple = [
        {"block": "b", "force": [0.0, 1.0], "at": [0.0, 0.5], "kind": "live"},
        {"block": "b", "force": [0.0, -1.0], "at": [0.3, 0.5], "kind": "live"},
    ]
    case = on_a_base(tall, load=couple, analysis={"pattern": "live"})
    assert load(case) == pytest.approx(0.3 * 2000.0 * 9.81 * 0.15 / 0.3, rel=NEAR)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_the_unit_of_the_live_load_drops_out(scale):
    push = {"block": "b", "force": [scale, 0.0], "kind": "live"}
    case = on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), load=[push], analysis={"pattern": "live"})
    assert load(case) * scale == pytest.approx(MU * 0.2 * 2000.0 * 9.81, rel=NEAR)


def test_a_tilting_table_fails_where_a_push_in_proportion_does():
    """tan θ = λ: dead loads turn as a whole, and cones do not know how large forces are."""
    assert load(wall(analysis={"pattern": "tilt"})) == pytest.approx(load(wall()), rel=NEAR)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_the_unit_of_length_drops_out(factor):
    assert load(moved(wall(), factor)) == pytest.approx(load(wall()), rel=NEAR)


@pytest.mark.parametrize("density", [2e-6, 2e12])
def test_the_unit_of_weight_drops_out(density):
    assert load(wall(density=density)) == pytest.approx(load(wall()), rel=NEAR)


def test_place_and_mirror_image_drop_out():
    leaning = on_a_base(
        block("b", turned(rectangle(0.0, 0.0, 0.3, 1.0), 0.0)), block("t", rectangle(0.1, 1.0, 0.4, 1.5)), friction=0.9
    )
    assert load(mirrored(leaning)) == pytest.approx(load(leaning), rel=NEAR)
    assert load(moved(leaning, shift=(300.0, -70.0))) == pytest.approx(load(leaning), rel=NEAR)


@pytest.mark.parametrize("angle", [0.3, 2.0])
def test_structure_and_loads_turned_together(angle):
    model = scene(wall()).model
    assert load(wall(), model=rotated(model, angle)) == pytest.approx(load(wall()), rel=NEAR)


def test_numbering_drops_out():
    model = scene(wall()).model
    order = np.random.default_rng(3).permutation(model.n_blocks)
    assert load(wall(), model=renumbered(model, order)) == pytest.approx(load(wall()), rel=NEAR)


@pytest.mark.parametrize("decades", [3, 6, -6])
@pytest.mark.parametrize("seed", range(3))
def test_weights_that_differ_by_a_million(decades, seed):
    """Against the oracle; densities are drawn block by block."""
    drawn = np.random.default_rng(seed)
    case = tables(*running_wall(8, 4))
    case["materials"] = {f"m{k}": {"density": 2000.0 * 10.0 ** (decades * k / 6)} for k in range(7)}
    for table in case["block"]:
        table["material"] = f"m{drawn.integers(7)}"
    model = scene(case).model
    place = [model.block_ids.index(table["id"]) for table in case["block"]]
    polygons = [np.array(table["vertices"]) for table in case["block"]]
    expected = oracle_load(polygons, model.fixed[place], MU, weights=-model.dead_loads[place, 1])
    assert load(case) == pytest.approx(expected.multiplier, rel=2e-6)


def test_forces_balance_and_lie_in_the_cones():
    found = solved(wall())
    s, answer = found.structure, found.associated
    reactions = np.column_stack([answer.normal, answer.shear]).ravel()
    assert np.abs(s.imbalance(reactions, answer.multiplier)).max() == answer.residual <= ACCEPTED.residual
    assert (answer.normal >= 0.0).all()
    assert (np.abs(answer.shear[:, 0]) <= found.friction * answer.normal * (1 + 1e-12)).all()


def test_the_mechanism_is_admissible_and_its_work_is_that_of_the_loads():
    """Joints open by μ times their slip or more, live loads have unit power, dead ones −λ."""
    found = solved(tables(*running_wall(6, 3), friction=0.75))
    s, answer = found.structure, found.associated
    velocities = answer.velocities.ravel()[s.free]
    opening, slide = (s.compatibility @ velocities).reshape(-1, 2).T
    largest = np.abs(s.compatibility @ velocities).max()
    assert (opening - found.friction * np.abs(slide)).min() > -1e-6 * largest
    assert s.live @ velocities == pytest.approx(1.0)
    assert -s.dead @ velocities == pytest.approx(answer.multiplier, rel=1e-5)
    assert (answer.velocities[s.model.fixed] == 0.0).all()


def test_a_structure_that_does_not_stand():
    overhang = on_a_base(block("b", rectangle(-0.2, 0.0, 0.2, 1.0)), block("t", rectangle(0.1, 1.0, 1.1, 1.2)))
    found = solved(overhang).associated
    assert found.status == FALLS
    assert found.multiplier is found.lower is found.upper is None


def test_a_structure_that_stands_only_under_some_live_load():
    """A block on a slope steeper than friction stands while it is pushed up, and fails when pushed harder."""
    slope = math.radians(40.0)
    base = block("base", turned(rectangle(-3.0, -1.0, 3.0, 0.0), slope), fixed=True)
    case = tables(base, block("b", turned(rectangle(-0.5, 0.0, 0.5, 0.1), slope)), friction=0.5)
    assert math.tan(slope) > 0.5
    assert solved(case).associated.status == FALLS


def test_a_block_without_support_falls():
    assert solved(on_a_base(*tower(1), block("far", rectangle(3.0, 3.0, 4.0, 4.0)))).associated.status == FALLS


def test_a_push_into_the_ground_never_makes_it_fail():
    push = {"block": "b", "force": [0.1, -1.0], "kind": "live"}
    case = on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), load=[push], analysis={"pattern": "live"})
    found = solved(case).associated
    assert found.status == LOCKED
    assert found.multiplier is None


def test_locked_but_falling_is_falling():
    push = {"block": "b", "force": [0.0, -1.0], "kind": "live"}
    far = block("far", rectangle(3.0, 3.0, 4.0, 4.0))
    case = on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), far, load=[push], analysis={"pattern": "live"})
    assert solved(case).associated.status == FALLS


def test_weightless_blocks_fail_at_no_load():
    push = {"block": "b", "force": [1.0, 0.0], "kind": "live"}
    case = on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), load=[push], analysis={"pattern": "live"}, gravity=0.0)
    assert load(case) == pytest.approx(0.0, abs=1e-9)


def test_a_solver_that_stops_early_is_not_believed(monkeypatch):
    monkeypatch.setattr(associated, "TRIES", ({"max_iter": 3},))
    found = solved(wall()).associated
    assert found.status.startswith(GIVEN_UP)
    assert "residual" in found.status


def test_a_false_proof_is_not_believed(monkeypatch):
    """A solver that says 'infeasible' of a wall that stands is not repeated."""
    from dem_cli.core.limit.program import IMPOSSIBLE

    honest = associated.largest_load
    monkeypatch.setattr(
        associated, "largest_load", lambda program, settings: honest(program, settings)._replace(kind=IMPOSSIBLE)
    )
    assert solved(wall()).associated.status.startswith(GIVEN_UP)


def test_without_live_loads_there_is_nothing_to_find():
    made = scene(wall())
    model = made.model._replace(live_loads=np.zeros_like(made.model.live_loads))
    with pytest.raises(UsageError, match="live loads"):
        solved(wall(), model=model)


def test_a_law_without_straight_lines_is_refused():
    made = scene(wall())
    glue = dataclasses.replace(COULOMB, name="glue", envelope=None)
    with pytest.raises(UsageError, match="law 'glue' is curved"):
        limit_loads(made.model, joint_properties(made.request, made.model), glue)


def test_a_law_that_is_not_friction_alone_has_no_path():
    made = scene(wall())
    structure = start_structure(made.model, joint_properties(made.request, made.model))
    glued = {"envelope": lambda parameters, kn: envelope(len(kn), friction=0.6, cohesion=1e3)}
    for change in ({"envelope": None}, {"scalars": 1}, {"bonded": True}, glued):
        with pytest.raises(UsageError, match="law 'glue'"):
            friction_of(structure.joints, dataclasses.replace(COULOMB, name="glue", **change))


def test_head_joints_without_friction():
    made = scene(wall())
    structure = start_structure(made.model, joint_properties(made.request, made.model))
    friction = friction_of(structure.joints, law_of(made.request), heads_frictionless=True)
    heads = np.abs(structure.joints.frames[:, 0]) > 0.9
    assert heads.any()
    np.testing.assert_array_equal(friction, np.where(heads, 0.0, MU))
    rough = tables(*running_wall(6, 3), friction=0.75)
    assert load(rough, heads_frictionless=True) < load(rough)
