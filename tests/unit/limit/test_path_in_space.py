"""The zero-dilation path in space: closed forms, planar twins, the law at its states, equations of slips that turn."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES
from engine import scene
from studies.space.structures import box as block
from studies.space.structures import prism, tables
from synthetic.solids import Face, Solid, box, extruded, joints_of, model_of, panel, prism_on, turned, wedge

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.geometry.polygon import properties
from dem_cli.core.limit.analysis import limit_loads, start_structure
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.elastic import Elastic, cones_of
from dem_cli.core.limit.matrices import LimitStructure, structure_of
from dem_cli.core.limit.path import OK, Path, _advance, at_rest, compliance, trace
from dem_cli.core.limit.settings import PathSettings
from dem_cli.core.limit.slip_cones import SlipCones
from dem_cli.masonry.assembly.solver_request import solver_request

NEAR = 1e-6  # relative, of loads: the path ends where they grow no more


def horizontal(azimuth_deg: float) -> np.ndarray:
    return np.array([np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg)), 0.0])


def structure(solids, faces, push, **more) -> LimitStructure:
    model = model_of(solids, push, **more)
    return structure_of(model, joints_of(model, faces))


def followed(made: LimitStructure, friction: float, **more) -> Path:
    path = trace(made, np.full(len(made.joints.kn), friction), **more)
    assert path.status == OK
    return path


@pytest.mark.parametrize("azimuth", [0.0, 20.0, 75.0, 130.0])
def test_a_block_topples_about_the_edge_that_is_nearest(azimuth):
    push = horizontal(azimuth)
    made = structure(*prism_on(box((-0.15, 0.15), 0.5, (0.0, 0.0)), 1.0), push)
    expected = np.min(np.array([0.3, 0.5]) / np.maximum(np.abs(push[:2]), 1e-9))
    assert followed(made, 2.0).load == pytest.approx(expected, rel=NEAR)


@pytest.mark.parametrize("azimuth", [0.0, 50.0])
def test_a_flat_block_slides_along_its_push_without_opening(azimuth):
    push = horizontal(azimuth)
    path = followed(structure(*prism_on(box((-0.5, 0.5), 1.0, (0.0, 0.0)), 0.1), push), 0.3)
    assert path.load == pytest.approx(0.3, rel=NEAR)
    motion = path.mechanism[1, :3]
    assert motion / np.linalg.norm(motion) == pytest.approx(push, abs=1e-5)


def test_a_triangular_prism_topples_about_its_oblique_edge():
    corners = np.array([(0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (0.0, 0.4, 0.0)])
    outwards = np.array([0.4, 0.6, 0.0]) / np.hypot(0.4, 0.6)
    arm = (corners[1] - corners.mean(axis=0)) @ outwards
    path = followed(structure(*prism_on(corners, 1.0), outwards), 2.0)
    assert path.load == pytest.approx(arm / 0.5, rel=NEAR)


def test_across_the_dip_of_a_slope():
    """√((μ cos α)² − sin² α): friction turns from up the slope to against the push."""
    slope, friction = np.radians(15.0), 0.6
    dip, strike = np.array([np.cos(slope), 0.0, np.sin(slope)]), np.array([0.0, 1.0, 0.0])
    corners = [x * dip + y * strike for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    solids = [Solid((0.0, 0.0, -1.0), fixed=True), Solid(0.05 * normal)]
    path = followed(structure(solids, [Face(0, 1, normal, corners)], strike), friction)
    assert path.load == pytest.approx(np.sqrt((friction * np.cos(slope)) ** 2 - np.sin(slope) ** 2), rel=NEAR)


def test_a_wedge_along_its_groove_is_not_pressed():
    """μ / sin h, 2.2 % below the load of joints that dilate (test_round_cones)."""
    path = followed(structure(*wedge(np.radians(50.0)), (1.0, 0.0, 0.0)), 0.25, plateau=1e-5)
    assert path.load == pytest.approx(0.25 / np.sin(np.radians(50.0)), rel=NEAR)
    assert path.load == pytest.approx(0.32635, abs=5e-6)


@pytest.mark.parametrize("azimuth", [90.0, 60.0])
def test_a_panel_topples_as_one(azimuth):
    """t / H, over the sine of the azimuth."""
    made = structure(*panel(5, 3, (0.5, 0.25, 0.2)), horizontal(azimuth))
    assert followed(made, 0.7).load == pytest.approx(0.25 / np.sin(np.radians(azimuth)), rel=1e-5)


@pytest.mark.parametrize("name", ["wall_21", "wall_21_mu075", "arch_21", "portal", "wall_with_door"])
def test_planar_twins(name):
    made = scene(CASES / "verification" / f"{name}.toml")
    flat = start_structure(made.model, joint_properties(made.request, made.model))
    friction = friction_of(flat.joints, law_of(made.request))
    one = trace(flat, friction)
    other = trace(structure_of(*extruded(flat.model, flat.joints)), np.repeat(friction, 2))
    assert other.status == OK
    assert other.load == pytest.approx(one.load, rel=1e-7)
    assert np.abs(other.displacements[:, 1]).max() < 1e-6 * np.abs(other.displacements).max()
    assert other.normal.reshape(-1, 2).sum(axis=1) == pytest.approx(one.normal, abs=1e-4 * one.normal.max())


def held_panel(azimuth: float = 70.0) -> LimitStructure:
    """Rough, frictional, pushed out of its plane and along it."""
    return structure(*panel(4, 3, (0.5, 0.4, 0.25)), horizontal(azimuth))


def test_its_state_obeys_the_law():
    """Balanced, inside the cones, no tension, closed where it presses."""
    made, friction = held_panel(), 0.35
    path = followed(made, friction)
    reactions = np.column_stack([path.normal, path.shear]).ravel()
    assert np.abs(made.imbalance(reactions, path.load)).max() < 1e-5
    assert (path.normal >= 0.0).all()
    assert (np.linalg.norm(path.shear, axis=1) <= friction * path.normal + 1e-6).all()
    pressed = path.normal > 1e-3
    assert path.gaps[pressed] == pytest.approx(-path.normal[pressed] / made.joints.kn[pressed])
    assert path.residual < 1e-3
    assert float((made.live * path.mechanism.ravel()[made.free]).sum()) == pytest.approx(1.0)


def test_the_load_does_not_depend_on_the_point_of_view():
    rng = np.random.default_rng(1)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    push, (solids, faces) = horizontal(70.0), panel(3, 3, (0.5, 0.3, 0.3))
    straight = followed(structure(solids, faces, push), 0.5).load
    oblique = structure(*turned(solids, faces, rotation), rotation @ push, down=-rotation[:, 2])
    assert followed(oblique, 0.5).load == pytest.approx(straight, rel=1e-5)


def test_a_fold_of_the_central_path_is_gone_round():
    """Columns side by side that lean on posts behind the first and the last: friction between them holds 0.106, and an
    increment from there ends where they topple alone, t / H = 0.08, or nowhere."""
    solids, faces = panel(10, 10, (2.0, 0.8, 1.0), 0.0, held=0.8)
    made = structure(solids, faces, horizontal(90.0))
    problem = Elastic(made, np.full(len(made.joints.kn), 0.7))
    standing = _advance(problem, at_rest(problem), None, lambda: False)
    origin, elastic = float(problem.live @ standing.displacements), compliance(problem, standing)
    held = _advance(problem, standing, origin + 0.25 * elastic, lambda: False)
    assert held.load * problem.live_scale == pytest.approx(0.106, rel=0.01)
    direct, around = (_advance(problem, held, origin + 0.275 * elastic, lambda: False, folds=folds) for folds in (0, 4))
    assert problem.residual(around, held) < 1e-3
    assert around.load * problem.live_scale == pytest.approx(0.08, rel=1e-3)
    if direct is not None:  # where this machine's round-off meets no fold
        assert problem.residual(direct, held) < 1e-2


# -- slips ------------------------------------------------------------------------------------------------------------


def points(n: int = 200, tau: float = 1e-3) -> tuple[SlipCones, np.ndarray, float]:
    """Reserves and slips all over the cone, on the central path."""
    rng = np.random.default_rng(5)
    slips = SlipCones(n)
    shear, slip = rng.normal(size=2 * n), np.concatenate([rng.uniform(0.0, 0.1, n), np.zeros(2 * n)])
    limit, shear, slip = slips.started(rng.uniform(0.1, 2.0, n), shear, slip, tau)
    return slips, slips.joined(np.full(n, tau), np.ones(n), limit, shear, slip), tau


def test_a_start_is_on_the_central_path():
    slips, x, tau = points()
    assert slips.products(x) == pytest.approx(tau, rel=1e-9)
    c, a = reserves(slips, x), slips.slip(x).reshape(3, -1)
    assert (c * a).sum(axis=0) == pytest.approx(tau, rel=1e-6)  # c ∘ a = τ e
    assert c[0] * a[1:] + a[0] * c[1:] == pytest.approx(0.0, abs=1e-9)


def reserves(slips: SlipCones, x: np.ndarray) -> np.ndarray:
    n = slips.n_points
    return -slips.lacks(np.zeros(n), np.zeros(2 * n), x).reshape(3, -1)


@pytest.mark.parametrize("share", [1e-2, 1e-3])
def test_a_small_step_leaves_an_error_of_second_order(share):
    """Newton's step for other forces: products become τ, T and γ stay opposite, and follow the change."""
    slips, x, tau = points()
    n, rng = slips.n_points, np.random.default_rng(2)
    ks, mu = np.full(n, 2.0), np.full(n, 0.5)
    stiffness = slips.linear(x, mu, ks, np.ones(n))
    c = reserves(slips, x)
    smallest = slips.products(x)[n:].reshape(2, -1).min(axis=0) / slips.slip(x).reshape(3, -1)[0]
    change = share * rng.uniform(-1.0, 1.0, (3, n)) * np.minimum(smallest, c[0])
    d_slip = stiffness.slipped(stiffness.towards(np.full(2 * n, tau), np.zeros(3 * n)), change.ravel())
    moved = slips.moved(x, np.concatenate([np.zeros(n), change.ravel(), np.zeros(n), d_slip]))
    assert slips.products(moved) == pytest.approx(tau, rel=20.0 * share**2)
    assert np.abs(reserves(slips, moved) - c - change).max() < 20.0 * share**2 * smallest.max()
    slid = slips.slides(moved) - slips.slides(x) - d_slip[n:]
    assert np.abs(slid).max() < 20.0 * share**2 * np.abs(slips.slides(x)).max()


def test_many_points_are_worked_out_in_compiled_code_to_the_same_digits():
    """All that an iteration asks for, at points that turn and points that hardly slide."""
    plain, x, tau = points()
    compiled, n, rng = (
        cones_of(plain.n_points, PathSettings(cones_compiled=0)),
        plain.n_points,
        np.random.default_rng(3),
    )
    assert type(compiled) is not SlipCones
    assert type(cones_of(n, PathSettings(cones_compiled=n + 1))) is SlipCones
    change = rng.normal(size=8 * n) * 10.0 ** rng.uniform(-6.0, 0.0, 8 * n)
    ks, mu, stiff_n = rng.uniform(0.5, 2.0, (3, n))
    forced, off, slide = rng.normal(size=3 * n), rng.normal(size=3 * n), rng.normal(size=2 * n)

    def asked(slips: SlipCones) -> list:
        stiffness = slips.linear(x, mu, ks, stiff_n)
        numbers = [slips.moved(x, change), slips.moved(x, change, 0.3), stiffness.towards(np.full(2 * n, tau), off),
                   stiffness.towards(np.broadcast_to(tau, 2 * n), off), stiffness.rubbed(forced, slide, ks),
                   stiffness.sheared(slide, off[:2 * n], mu), stiffness.slipped(forced, off)]  # fmt: skip
        return [slips.fastest(x, change), *(values.tolist() for values in numbers)]

    assert asked(compiled) == asked(plain)


def test_a_slip_turns_far_and_stays_in_its_cone():
    """Next to the boundary a straight step would leave the cone after 1 % of |T|."""
    slips = SlipCones(1)
    x = slips.joined(*np.ones((2, 1)), np.array([1.0]), np.array([0.9999, 0.0]), np.array([2.0, 1e-4, 1.0, 0.0]))
    moved = slips.moved(x, np.array([0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, -0.5]))
    c, a = reserves(slips, moved).ravel(), slips.slip(moved)
    assert c[1:] == pytest.approx([0.9999, 0.5], abs=1e-3)
    assert a[1:] == pytest.approx([-0.99995, -0.5], abs=1e-3)
    assert c[0] - np.hypot(*c[1:]) == pytest.approx(1e-4)  # as before
    assert a[0] - np.hypot(*a[1:]) == pytest.approx(1e-4)


def test_nothing_slips_in_an_elastic_structure():
    """The increment of the stiffness matrix is that of Bᵀ k B."""
    made = held_panel()
    problem = Elastic(made, np.full(len(made.joints.kn), 0.5))
    k = np.column_stack([made.joints.kn, made.joints.ks, made.joints.ks]).ravel()
    u = np.linalg.solve((made.compatibility.T.multiply(k) @ made.compatibility).toarray(), made.live)
    found = problem.displacements(problem.elastic().solve(problem.live)) / problem.live_scale
    assert found * problem.weight / problem.unit / problem.stiffness == pytest.approx(u, rel=1e-6, abs=1e-12)


def test_a_rest_on_the_way_is_no_failure_where_nothing_slides():
    """A foot whose next edge is almost in line: the load rests 1.6 % below that of toppling over the edge in front."""
    outline = np.array([(-0.4, -0.2), (0.3, -0.25), (0.45, -0.25), (0.1, 0.4)])
    direction, (left, right) = np.array([0.05, -1.0]) / np.hypot(0.05, 1.0), outline[:2]
    ground = block("ground", (-2.0, -2.0, -0.3), (2.0, 2.0, 0.0), fixed=True)
    case, model = scene(tables(ground, prism("block", outline, 0.0, 1.0), friction=0.8, direction=(*direction, 0.0)))
    outwards = np.array([left[1] - right[1], right[0] - left[0]]) * (-1.0, -1.0) / np.linalg.norm(right - left)
    expected = (left - properties(outline).centroid) @ outwards / (0.5 * outwards @ direction)
    found = limit_loads(model, joint_properties(solver_request(case), model), law_of(solver_request(case))).summary()
    assert found["non_associated_status"] == OK
    assert found["non_associated"] == pytest.approx(expected, rel=NEAR)
    assert found["associated"] == pytest.approx(expected, rel=NEAR)
