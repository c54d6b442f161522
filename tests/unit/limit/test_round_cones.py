"""The associated load in space, by second-order cones: closed forms, planar twins, pyramids around and inside the cone.

Errors are those of the solver, 1e-6 at most: nothing is approximated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from casefiles import CASES
from engine import block, rectangle, running_wall, scene, tables
from engine.limits import on_a_base
from oracle.strong_joints import Points, toppling_load
from scipy.optimize import linprog
from synthetic.solids import Face, Solid, box, extruded, joints_of, model_of, panel, prism_on, turned, wedge

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.laws.envelope import Envelope, envelope, frictional
from dem_cli.core.limit.analysis import start_structure
from dem_cli.core.limit.associated import FALLS, LOCKED, OK, LimitLoad, associated_limit
from dem_cli.core.limit.cone import envelope_of
from dem_cli.core.limit.matrices import LimitStructure, structure_of
from dem_cli.core.limit.program import factorised_by, program_of
from dem_cli.core.limit.settings import DEFAULT_LIMIT

NEAR = 1e-6  # relative
WIDTH, DEPTH, HEIGHT = 0.3, 0.5, 1.0  # of a block that topples; of weight one
GROUND = Solid((0.0, 0.0, -1.0), fixed=True)
AZIMUTHS = [0.0, 20.0, 50.0, 75.0, 90.0, 130.0, 265.0]


def horizontal(azimuth_deg: float) -> np.ndarray:
    return np.array([np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg)), 0.0])


def structure(solids: Sequence[Solid], faces: Sequence[Face], push: Sequence[float], **more) -> LimitStructure:
    model = model_of(solids, push, **more)
    return structure_of(model, joints_of(model, faces))


def on_ground(corners: np.ndarray, height: float, push: Sequence[float]) -> LimitStructure:
    """One prism of weight one on these corners, pushed at half its height."""
    return structure(*prism_on(corners, height), push)


def flat_block(push: Sequence[float]) -> LimitStructure:
    return on_ground(box((-0.5, 0.5), 1.0, (0.0, 0.0)), 0.1, push)


def tall_block(push: Sequence[float]) -> LimitStructure:
    return on_ground(box((-0.5 * WIDTH, 0.5 * WIDTH), DEPTH, (0.0, 0.0)), HEIGHT, push)


def solved(made: LimitStructure, strength: float | Envelope) -> LimitLoad:
    n_points = len(made.joints.kn)
    return associated_limit(
        made, strength if isinstance(strength, Envelope) else frictional(np.full(n_points, strength))
    )


def load(made: LimitStructure, strength: float | Envelope) -> float:
    """The multiplier, with its claims checked: bounds, forces in balance and inside the cones."""
    found = solved(made, strength)
    assert found.status == OK
    assert found.lower * (1 - NEAR) - 1e-9 <= found.multiplier <= found.upper * (1 + NEAR) + 1e-9
    reactions = np.column_stack([found.normal, found.shear]).ravel()
    assert np.abs(made.imbalance(reactions, found.multiplier)).max() == found.residual < 1e-6
    if not isinstance(strength, Envelope):
        assert (np.linalg.norm(found.shear, axis=1) <= strength * found.normal * (1 + 1e-12)).all()
    assert made.live @ found.velocities.ravel()[made.free] == pytest.approx(1.0)
    return found.multiplier


@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_a_block_topples_about_the_edge_that_is_nearest(azimuth):
    push = horizontal(azimuth)
    with np.errstate(divide="ignore"):
        expected = np.min(np.array([WIDTH, DEPTH]) / HEIGHT / np.abs(push[:2]))
    assert load(tall_block(push), 2.0) == pytest.approx(expected, rel=NEAR)


@pytest.mark.parametrize("friction", [0.0, 1e-3, 0.7])
@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_a_flat_block_slides_at_its_friction_in_any_direction(azimuth, friction):
    assert load(flat_block(horizontal(azimuth)), friction) == pytest.approx(friction, rel=2e-5, abs=1e-9)


def test_a_triangular_prism_topples_about_its_oblique_edge():
    """Distance from the centroid to the edge over half the height."""
    corners = np.array([(0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (0.0, 0.4, 0.0)])
    outwards = np.array([0.4, 0.6, 0.0]) / np.hypot(0.4, 0.6)
    arm = (corners[1] - corners.mean(axis=0)) @ outwards
    assert load(on_ground(corners, 1.0, outwards), 2.0) == pytest.approx(arm / 0.5, rel=NEAR)


@pytest.mark.parametrize("across", [0.0, 22.5])
def test_an_octagonal_drum(across):
    """Apothem over half the height across a side, circumradius towards a corner."""
    angles = np.radians(45.0 * np.arange(8) + 22.5)
    corners = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    arm = np.cos(np.radians(22.5)) if across == 0.0 else 1.0
    assert load(on_ground(corners, 4.0, horizontal(across)), 2.0) == pytest.approx(arm / 2.0, rel=NEAR)


@pytest.mark.parametrize("direction", ["up", "down", "across"])
def test_a_block_on_a_slope(direction):
    """Pushed level: tan(φ ± α); across the dip √((μ cos α)² − sin² α)."""
    slope, friction = np.radians(15.0), 0.6
    dip, strike = np.array([np.cos(slope), 0.0, np.sin(slope)]), (0.0, 1.0, 0.0)  # the slope rises along x
    corners = np.array([x * dip + np.multiply(y, strike) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    push = {"up": (1.0, 0.0, 0.0), "down": (-1.0, 0.0, 0.0), "across": strike}[direction]
    made = structure([GROUND, Solid(0.05 * normal)], [Face(0, 1, normal, corners)], push)
    angle = np.arctan(friction)
    expected = {
        "up": np.tan(angle + slope),
        "down": np.tan(angle - slope),
        "across": np.sqrt((friction * np.cos(slope)) ** 2 - np.sin(slope) ** 2),
    }
    assert load(made, friction) == pytest.approx(expected[direction], rel=NEAR)


def test_a_wedge_along_its_groove_is_pressed_by_dilation():
    """Associated flow lifts the wedge, and friction holds it down: μ / √(sin² h − μ² cos² h), where real joints have
    μ / sin h (test_path_in_space)."""
    half, friction = np.radians(50.0), 0.25
    expected = friction / np.sqrt(np.sin(half) ** 2 - (friction * np.cos(half)) ** 2)
    assert expected == pytest.approx(0.33378, abs=5e-6)
    assert load(structure(*wedge(half), (1.0, 0.0, 0.0)), friction) == pytest.approx(expected, rel=NEAR)


@pytest.mark.parametrize("azimuth", [90.0, 60.0])
def test_a_panel_topples_as_one(azimuth):
    """t / H, over the sine of the azimuth."""
    made = structure(*panel(6, 4, (0.5, 0.25, 0.2)), horizontal(azimuth))
    expected = 0.25 / (6 * 0.2) / np.sin(np.radians(azimuth))
    assert load(made, 0.7) == pytest.approx(expected, rel=NEAR)


# -- twins, pyramids, points of view ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["wall_21_mu075", "arch_21", "wall_with_door", "portal"])
def test_planar_twins(name):
    """Prisms pushed in the plane of their 2D twin: the same load, no motion out of the plane."""
    made = scene(CASES / "verification" / f"{name}.toml")
    flat = start_structure(made.model, joint_properties(made.request, made.model))
    strength = envelope_of(flat.joints, law_of(made.request))
    spatial = structure_of(*extruded(flat.model, flat.joints))
    one, other = associated_limit(flat, strength), associated_limit(spatial, in_pairs(strength))
    assert other.multiplier == pytest.approx(one.multiplier, rel=1e-9)
    assert other.velocities[:, 1] == pytest.approx(0.0, abs=1e-9 * np.abs(one.velocities).max())


@pytest.mark.parametrize("strength", [{"cohesion": 4e3, "tension": 3e3}, {"cohesion": 6e3}, {"compression": 3e4}])
def test_planar_twins_of_strong_joints(strength):
    law = "crushing" if "compression" in strength else "mohr-coulomb"
    joint = {"law": law, "friction": 0.6, "points": 3} | strength
    made = scene(tables(*running_wall(3, 3), joints={"dry": joint}))
    flat = start_structure(made.model, joint_properties(made.request, made.model), law_of(made.request))
    limits = envelope_of(flat.joints, law_of(made.request))
    spatial = structure_of(*extruded(flat.model, flat.joints))
    assert load(spatial, in_pairs(limits)) == pytest.approx(associated_limit(flat, limits).multiplier, rel=NEAR)


def in_pairs(strength: Envelope) -> Envelope:
    """Of the two points that one of the plane becomes: half the forces each, the same slopes."""
    halves = {name: 0.5 * np.repeat(getattr(strength, name), 2) for name in ("cohesion", "tension", "compression")}
    return Envelope(np.repeat(strength.friction, 2), dilation=np.repeat(strength.dilation, 2), **halves)


def test_pyramids_inside_and_around_the_cone():
    """Linear programs of 48 sides, (1 − cos 3.75°) = 0.2 % apart, on either side of the load of a panel."""
    made = structure(*panel(4, 3, (0.5, 0.4, 0.3)), horizontal(35.0))
    friction, sides = 0.5, 48
    found = load(made, friction)
    inner = by_pyramid(made, friction, sides)
    outer = by_pyramid(made, friction / np.cos(np.pi / sides), sides)
    assert inner < outer < 1.005 * inner
    assert inner <= found * (1 + NEAR)
    assert found <= outer * (1 + NEAR)
    assert load(made, 5.0) > 1.05 * found  # friction takes part


def by_pyramid(made: LimitStructure, friction: float, sides: int) -> float:
    """The load with a pyramid of so many sides inside the cone."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    edges = np.column_stack([np.ones(sides), friction * np.cos(angles), friction * np.sin(angles)])
    n_points = len(made.joints.kn)
    forces = np.kron(np.eye(n_points), edges)  # (n_points·sides, n_points·3)
    balance = np.vstack([forces @ made.compatibility.toarray(), made.live]).T / made.scales[:, None]
    cost = np.append(np.zeros(len(forces)), -1.0)
    return -linprog(cost, A_eq=balance, b_eq=-made.dead / made.scales, method="highs").fun


def test_structure_and_loads_turned_together():
    rng = np.random.default_rng(1)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    push, solids, faces = horizontal(50.0), *panel(4, 3, (0.5, 0.3, 0.3))
    straight = load(structure(solids, faces, push), 0.6)
    oblique = structure(*turned(solids, faces, rotation), rotation @ push, down=-rotation[:, 2])
    assert load(oblique, 0.6) == pytest.approx(straight, rel=NEAR)


# -- joints that are stronger, and refusals ---------------------------------------------------------------------------


def of_points(made: LimitStructure, **values: float) -> Envelope:
    return envelope(len(made.joints.kn), **values)


@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_cohesion_holds_a_block_that_slides(azimuth):
    """λ = μ + c A / W in every direction; with tension at the tip of the cone, c = μ ft, as well."""
    made = flat_block(horizontal(azimuth))
    assert load(made, of_points(made, friction=0.3, cohesion=0.05)) == pytest.approx(0.3 + 4 * 0.05, rel=NEAR)
    assert load(made, of_points(made, friction=0.4, cohesion=0.1, tension=0.25)) == pytest.approx(0.8, rel=NEAR)
    assert load(made, of_points(made, cohesion=0.05)) == pytest.approx(4 * 0.05, rel=NEAR)


def test_tension_holds_a_block_that_topples():
    made = tall_block(horizontal(0.0))
    strong = of_points(made, friction=0.9, cohesion=1.0, tension=0.05)
    assert load(made, strong) == pytest.approx(WIDTH / HEIGHT * (1.0 + 4 * 0.05), rel=NEAR)


@pytest.mark.parametrize("pressed", [0.6, 0.8, 0.95])
def test_crushing_of_the_toe(pressed):
    """Against the greedy choice of forces of two lines of points."""
    made = tall_block(horizontal(0.0))
    points = Points(np.array([0.0, 1.0]), np.array([0.5, 0.5]), 0.9, compression=1.0 / (WIDTH * pressed))
    weak = of_points(made, friction=0.9, compression=0.25 / pressed)
    assert load(made, weak) == pytest.approx(toppling_load(points, WIDTH, HEIGHT, 1.0), rel=5e-6)


def test_joints_without_end_never_fail():
    made = tall_block(horizontal(40.0))
    held = of_points(made, cohesion=np.inf, tension=np.inf)
    assert solved(made, held).status == LOCKED


def test_a_push_into_the_ground_never_makes_it_fail():
    assert solved(flat_block((0.1, 0.1, -1.0)), 0.6).status == LOCKED
    made = flat_block((0.0, 0.0, -1.0))
    assert load(made, of_points(made, friction=0.6, compression=3.0)) == pytest.approx(4 * 3.0 - 1.0, rel=NEAR)


def test_a_slope_steeper_than_friction():
    slope = np.radians(40.0)
    corners = np.array([(x * np.cos(slope), y, x * np.sin(slope)) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    made = structure([GROUND, Solid(0.05 * normal)], [Face(0, 1, normal, corners)], (1.0, 0.0, 0.0))
    assert solved(made, 0.5).status == FALLS


def test_a_flat_twin_on_a_base_slides_either_way():
    """A prism that is pushed in its plane or across it: the same friction."""
    made = scene(on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), friction=0.4))
    flat = start_structure(made.model, joint_properties(made.request, made.model))
    model, joints = extruded(flat.model, flat.joints, depth=1.0)
    across = model._replace(live_loads=np.roll(model.live_loads, 1, axis=1))
    vars(across)["shapes"] = model.shapes
    for each in (model, across):
        assert load(structure_of(each, joints), 0.4) == pytest.approx(0.4, rel=NEAR)


def test_size_chooses_the_factorisation_and_either_finds_the_same_load():
    made = structure(*panel(4, 3, (0.5, 0.4, 0.3)), horizontal(35.0))
    strength, size, found = frictional(np.full(len(made.joints.kn), 0.6)), len(made.free), {}
    for by_columns in (size - 1, size):
        settings = replace(DEFAULT_LIMIT.associated, by_columns=by_columns)
        found[factorised_by(program_of(made, strength, settings))] = associated_limit(
            made, strength, settings
        ).multiplier
    assert sorted(found) == ["faer", "qdldl"]
    assert found["faer"] == pytest.approx(found["qdldl"], rel=1e-8)
