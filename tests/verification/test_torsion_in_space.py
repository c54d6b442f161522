"""Torsion of rigid joints in space: μ N times the mean distance of the face from its centre, as of spread pressure."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from engine import scene, simulation, solve
from scipy.optimize import brentq, minimize_scalar
from studies.space.structures import box, prism, tables

from dem_cli.core.contact.corner_forces import at_corners
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.overlap import mean_distance
from dem_cli.core.limit.analysis import LimitLoads, limit_loads

MU, H = 0.6, 0.2
RATIOS = [1.0, 2.0, 3.0, 5.0]
BASE = box("base", (-4.0, -4.0, -0.5), (7.0, 7.0, 0.0), fixed=True)


def mean_radius(a: float, b: float) -> float:
    """Mean distance of a rectangle a × b from its centre: ∫ √(x² + y²) dx dy / (a b)."""
    return math.hypot(a, b) / 6.0 + a * a / (12.0 * b) * math.asinh(b / a) + b * b / (12.0 * a) * math.asinh(a / b)


def weight(a: float, b: float) -> float:
    return 2000.0 * 9.81 * a * b * H


def live(force, at) -> dict:
    return {"block": "b", "kind": "live", "force": list(map(float, force)), "at": list(map(float, at))}


def on_ground(*loads: dict, a: float = 1.0, b: float = 1.0, analysis: dict | None = None, **more) -> dict:
    """A slab a × b on the ground under loads at its points."""
    analysis = {"kind": "pushover", "pattern": "live", "max_load": 1e6} | (analysis or {})
    return tables(BASE, box("b", (0.0, 0.0, 0.0), (a, b, H)), friction=MU, load=list(loads), analysis=analysis, **more)


def turned_by_a_couple(a: float, b: float, **more) -> dict:
    """Live forces of 1 N at both ends, level with the joint: a moment of a [N m] about the vertical."""
    return on_ground(live((0, 1, 0), (a, b / 2, 0)), live((0, -1, 0), (0, b / 2, 0)), a=a, b=b, **more)


def bounds(case: dict) -> LimitLoads:
    made = scene(case)
    return limit_loads(made.model, joint_properties(made.request, made.model), law_of(made.request))


def middle(summary: dict) -> float:
    assert summary["status"] == "ok", summary["warnings"]
    return float(np.mean(summary["failure_load_bracket"]))


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_slab_turns_at_the_moment_of_a_spread_pressure(ratio):
    """Loop and path; forces at the corners in their cones, as the associated load has them, remain an upper bound."""
    case = turned_by_a_couple(ratio, 1.0)
    exact = MU * weight(ratio, 1.0) * mean_radius(ratio, 1.0) / ratio
    assert middle(solve(case)[0]) == pytest.approx(exact, rel=2e-3)
    found = bounds(case)
    assert found.non_associated.load == pytest.approx(exact, rel=1e-5)
    corners = MU * weight(ratio, 1.0) * 0.5 * math.hypot(ratio, 1.0) / ratio
    assert found.associated.multiplier == pytest.approx(corners, rel=1e-5)


@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_geometry_that_moves_knows_the_same_torsion(ratio):
    case = turned_by_a_couple(ratio, 1.0, analysis={"kinematics": "large"})
    summary, _ = solve(case)
    assert middle(summary) == pytest.approx(MU * weight(ratio, 1.0) * mean_radius(ratio, 1.0) / ratio, rel=3e-3)
    assert abs(summary["energy_closure"]) < 1e-3


def test_points_that_a_case_asks_for_stay_where_they_are():
    """points = "vertices": friction at the corners."""
    case = turned_by_a_couple(1.0, 1.0)
    case["joints"]["dry"]["points"] = "vertices"
    corners = MU * weight(1.0, 1.0) * math.sqrt(0.5)
    assert middle(solve(case)[0]) == pytest.approx(corners, rel=2e-3)
    assert bounds(case).non_associated.load == pytest.approx(corners, rel=1e-5)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_joints_of_a_given_stiffness_twist_as_rigid_ones(ratio, kinematics):
    """With points over their area in geometry of the start, integrated where it moves: a spread pressure both times."""
    case = turned_by_a_couple(ratio, 1.0, analysis={"kinematics": kinematics})
    case["joints"]["dry"] |= {"kn": 1e9, "ks": 4e8}
    exact = MU * weight(ratio, 1.0) * mean_radius(ratio, 1.0) / ratio
    assert middle(solve(case)[0]) == pytest.approx(exact, rel=3e-3)
    assert bounds(case).non_associated.load == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 120.0])
def test_translation_is_exact(azimuth):
    push = (math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0.0)
    case = on_ground(live(push, (1.0, 0.5, 0.0)), a=2.0)
    assert middle(solve(case)[0]) == pytest.approx(MU * weight(2.0, 1.0), rel=2e-3)
    assert bounds(case).non_associated.load == pytest.approx(MU * weight(2.0, 1.0), rel=1e-6)


def slides_about(x: np.ndarray, y: np.ndarray, shares: np.ndarray, at: float) -> tuple[float, float]:
    """Force along y and moment about the origin of friction of 1 N, of places that turn about (at, 0)."""
    reach = np.hypot(x - at, y)
    return float((shares * (x - at) / reach).sum()), float((shares * (x * (x - at) + y * y) / reach).sum())


def pushed_beside(x: np.ndarray, y: np.ndarray, shares: np.ndarray, arm: float) -> float:
    """Largest force along y at this arm, by the centre about which all turns."""

    def off(at: float) -> float:
        force, turning = slides_about(x, y, shares, at)
        return turning - arm * force

    return slides_about(x, y, shares, brentq(off, -100.0, -1e-6))[0]


@pytest.mark.parametrize("arm", [0.1, 0.3, 1.0])
def test_a_push_beside_the_centre_turns_and_shifts_a_square(arm):
    """Against four forces that turn about one centre, exactly; and within 2 % against all places of the face."""
    case = on_ground(live((0, 1, 0), (0.5 + arm, 0.5, 0.0)))
    if arm > 0.5:  # beside the block: by forces at both of its sides
        case["load"] = [
            live((0, 1, 0), (1.0, 0.5, 0.0)),
            live((0, 0.5, 0), (1, 0.5, 0)),
            live((0, -0.5, 0), (0, 0.5, 0)),
        ]
        arm = 1.0
    drawn = mean_radius(1.0, 1.0) / math.sqrt(0.5) * 0.5
    four = pushed_beside(drawn * np.array([-1, 1, 1, -1]), drawn * np.array([-1, -1, 1, 1]), np.full(4, 0.25), arm)
    x, y = (each.ravel() for each in np.meshgrid(*2 * [(np.arange(300) + 0.5) / 300 - 0.5]))
    spread = pushed_beside(x, y, np.full(x.size, 1.0 / x.size), arm)
    found = bounds(case).non_associated.load / (MU * weight(1.0, 1.0))
    assert found == pytest.approx(four, rel=2e-4)
    assert found == pytest.approx(spread, rel=0.02)
    assert middle(solve(case)[0]) / (MU * weight(1.0, 1.0)) == pytest.approx(four, rel=3e-3)


def least(of: Callable[[float], float]) -> float:
    """The least value of a function of a place along x within the slab."""
    return float(minimize_scalar(of, bounds=(-0.5, 0.5), method="bounded", options={"xatol": 1e-9}).fun)


@pytest.mark.parametrize(("kinematics", "rel"), [("fixed", 3e-3), ("large", 4e-3)])
def test_friction_follows_the_centre_of_pressure(kinematics, rel):
    """Half as much again on a point a/8 from the middle: a/24 off it, corner forces linear in x.

    Without a resultant the slab turns about the place of the least moment; a pressure that is linear has that, too.
    """
    a, more = 1.0, 0.5 * weight(1.0, 1.0)
    dead = {"block": "b", "kind": "dead", "force": [0.0, 0.0, -more], "at": [a / 2 + a / 8, a / 2, H]}
    case = turned_by_a_couple(a, 1.0, analysis={"kinematics": kinematics})
    case["load"].append(dead)
    total, e = weight(a, 1.0) + more, a / 24.0
    beta, x = mean_radius(a, 1.0) / math.sqrt(0.5), np.array([-0.5, 0.5])
    forces = 0.5 * (1.0 + 4.0 * e * x)  # of the two corners at each end
    arm = beta * least(lambda p: float((forces * np.hypot(x - p, 0.5)).sum()))
    torque = MU * total * arm
    assert middle(solve(case)[0]) == pytest.approx(torque / a, rel=rel)
    if kinematics == "fixed":
        assert bounds(case).non_associated.load == pytest.approx(torque / a, rel=1e-4)
    s, t = (each.ravel() for each in np.meshgrid(*2 * [(np.arange(300) + 0.5) / 300 - 0.5]))
    assert arm == pytest.approx(least(lambda p: float(((1.0 + 12.0 * e * s) * np.hypot(s - p, t)).mean())), rel=0.02)


def heap(mirror: float = 1.0, order=(0, 1, 2, 3)) -> dict:
    """Oblong slabs that lie on each other off centre, pushed beside; mirror −1: the same seen in a mirror at y = 0."""

    def y(*values: float) -> list[float]:
        return sorted(mirror * value for value in values)

    slabs = [
        box("ground", (-1.0, -2.0, -0.5), (3.0, 2.0, 0.0), fixed=True),
        box("low", (0.0, y(-0.2, 0.6)[0], 0.0), (1.3, y(-0.2, 0.6)[1], 0.3)),
        box("middle", (0.4, y(-0.5, 0.3)[0], 0.3), (1.1, y(-0.5, 0.3)[1], 0.55)),
        box("b", (0.2, y(-0.3, 0.2)[0], 0.55), (1.2, y(-0.3, 0.2)[1], 0.8)),
    ]
    push = live((0.3, mirror, 0.0), (1.1, 0.1 * mirror, 0.6))
    analysis = {"kind": "pushover", "pattern": "live", "max_load": 1e6}
    return tables(*(slabs[i] for i in order), friction=0.4, load=[push], analysis=analysis)


def forces_on(case: dict, kinematics: str, kicks: np.ndarray) -> np.ndarray:
    """Forces on the blocks in the order of their names after each of some steps at given speeds, (n, n_blocks, 6)."""
    sim = simulation(case, kinematics)
    order, found = np.argsort(sim.model.block_ids), []
    for kick in kicks:
        sim.bodies.velocities[order] = kick
        sim.advance(1, slot.HOLD_LOAD)
        found.append(sim.bodies.forces[order])
    assert (sim.joints.torsion < 1.0).all()
    assert (sim.contacts.slip > 0.0).any()
    return np.array(found)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_mirror_images_have_mirrored_forces_whatever_their_numbers(kinematics):
    rng, mirror = np.random.default_rng(5), np.array([1, -1, 1, -1, 1, -1])
    kicks = 5e-8 * rng.normal(size=(8, 4, 6))
    kicks[:, 1] = 0.0  # the ground; by name b, ground, low, middle
    kicks[:, :, 2] -= np.array([3.0, 0.0, 1.0, 2.0]) * 2e-7
    forces = forces_on(heap(), kinematics, kicks)
    allowed = 1e-9 * np.abs(forces).max()
    assert forces_on(heap(-1.0), kinematics, mirror * kicks) * mirror == pytest.approx(forces, abs=allowed)
    assert forces_on(heap(order=(2, 0, 3, 1)), kinematics, kicks) == pytest.approx(forces, abs=allowed)


def test_the_path_is_that_of_the_mirror_image():
    loads = [bounds(heap(*how)).non_associated.load for how in ((1.0,), (-1.0,), (1.0, (2, 0, 3, 1)))]
    assert loads == pytest.approx([loads[0]] * 3, rel=1e-5)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_forces_in_the_results_are_in_equilibrium_and_in_their_cones(kinematics):
    """Of a slab under its weight that is held by friction: about its centroid nothing is left."""
    case = turned_by_a_couple(2.0, 1.0, analysis={"kinematics": kinematics})
    case["load"].append({"block": "b", "kind": "dead", "force": [0.0, 0.0, -1000.0], "at": [1.3, 0.6, H]})
    sim = simulation(case, kinematics)
    sim.set_load(1200.0 / sim.live_scale)
    for _ in range(40):
        sim.advance(500, slot.HOLD_LOAD)
        sim.bodies.velocities[:] *= 0.5
    joints, contacts = sim.joints, sim.contacts
    used = joints.kn > 0.0
    shear = at_corners(joints, contacts.normal, contacts.shear)
    assert not np.allclose(shear, contacts.shear)
    assert (np.linalg.norm(shear, axis=1) <= MU * contacts.normal * (1.0 + 1e-9)).all()
    frames = joints.frames.reshape(-1, 3, 3)[used]
    forces = np.einsum("pk,pkd->pd", np.column_stack([contacts.normal, shear])[used], frames)
    number = sim.model.block_ids.index("b")
    sign = np.where(joints.blocks[joints.owners[used], 1] == number, 1.0, -1.0)[:, None]
    arms = joints.points[used] - sim.bodies.positions[number]
    given = np.append((sign * forces).sum(axis=0), np.cross(arms, sign * forces).sum(axis=0))
    assert given == pytest.approx(sim.bodies.forces[number], abs=1e-6 * weight(2.0, 1.0))


OUTLINES = {
    "triangle": np.array([(0.0, 0.0), (1.2, 0.1), (0.3, 0.9)]),
    "rectangle": np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)]),
    "pentagon": np.array([(0.0, 0.0), (1.0, -0.3), (1.8, 0.4), (1.1, 1.2), (-0.2, 0.8)]),
}


@pytest.mark.parametrize("name", OUTLINES)
def test_mean_distance_of_polygons(name):
    """The closed form against the mean over a fine grid, from a place within."""
    outline = OUTLINES[name]
    work, place = np.zeros((3, len(outline), 3)), outline.mean(axis=0)
    work[2, :, :2] = outline
    low, high = outline.min(axis=0), outline.max(axis=0)
    x, y = (each.ravel() for each in np.meshgrid(*(np.linspace(*ends, 1501) for ends in zip(low, high, strict=True))))
    inside = np.ones(len(x), bool)
    for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        inside &= (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) >= 0.0
    expected = np.hypot(x[inside] - place[0], y[inside] - place[1]).mean()
    assert mean_distance(work, len(outline), *place) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("name", OUTLINES)
def test_moving_geometry_has_the_share_of_the_start(name):
    """Of prisms on the ground; a rectangle has the closed form."""
    case = tables(BASE, prism("b", OUTLINES[name] + 1.0, 0.0, H))
    start, moving = (simulation(case, kinematics).joints.torsion for kinematics in ("fixed", "large"))
    assert moving == pytest.approx(start, rel=1e-9)
    assert 0.45 < start[0] < 0.75
    if name == "rectangle":
        assert start[0] == pytest.approx(mean_radius(3.0, 1.0) / (0.5 * math.hypot(3.0, 1.0)), rel=1e-12)


def test_a_slab_that_spins_is_braked_by_what_a_spread_pressure_takes():
    """Thrown to spin with 3 rad/s about the vertical: it stops after I ω²/2 over μ W r̄."""
    case = on_ground()
    case |= {"analysis": {"kind": "time-history", "duration": 0.3}, "damping": {"none": True}}
    case["initial"] = [{"block": "b", "velocity": [0.0, 0.0, 0.0, 0.0, 0.0, 3.0]}]
    case["monitor"] = [{"block": "b", "quantity": "rotation", "component": "z"}]
    del case["load"]
    summary, seen = solve(case)
    inertia = weight(1.0, 1.0) / 9.81 / 6.0
    turned = 0.5 * inertia * 3.0**2 / (MU * weight(1.0, 1.0) * mean_radius(1.0, 1.0))
    assert seen.history.monitors[-1, 0] == pytest.approx(turned, rel=5e-3)
    assert abs(summary["energy_closure"]) < 2e-3
