"""Ends of joints: they lie in the overlap, and nothing jumps or is lost where a corner passes another one."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, real_masses, rectangle, simulation, steps, tables
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.engine import simulation as engine
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels.planar_geometry import BLEND, FLAT, STEEPER

KN, SIDE, WEIGHT = 1e9, 1.0, 2000.0 * 9.81
DEPTH = WEIGHT / KN  # of a corner that carries the block


def on_a_rim(friction: float = 0.0, chained: bool = False) -> Simulation:
    """A cube on a table that ends below its right corner; chained: its joint has two points by a layout."""
    case = tables(
        block("table", rectangle(-3.0, -1.0, 1.0, 0.0), fixed=True),
        block("cube", rectangle(0.0, 0.0, SIDE, SIDE)),
        joints={
            "dry": {"friction": friction, "kn": 2.0 * KN, "ks": 2.0 * KN, "points": 2}
        },  # a point has half the joint
    )
    made = simulation(case, "large")
    if not chained:
        return made
    properties = made.properties._replace(layouts=(PointLayout(points=2),))
    return engine.Simulation(made.model, made.law, properties, "large")


def put(sim: Simulation, x: float, y: float, angle: float) -> None:
    """The cube turned by an angle, its corner at [1 + x, y]: the rim is at [1, 0]."""
    c, s = np.cos(angle), np.sin(angle)
    sim.bodies.positions[1] = np.array([1.0 + x, y]) - np.array([[c, -s], [s, c]]) @ [0.5 * SIDE, -0.5 * SIDE]
    sim.bodies.orientations[1] = angle
    own = sim.shape.corner_blocks == 1
    sim.bodies.corners[own] = sim.bodies.positions[1] + sim.shape.corner_arms[own] @ np.array([[c, s], [-s, c]])


def pressed(sim: Simulation, x: float, y: float, angle: float, sheared: float = 0.0) -> tuple[np.ndarray, float]:
    """Force and moment on the cube there [N, N m], with so much shear in its springs, and what these store [J]."""
    put(sim, x, y, angle)
    sim.loads.inverse_masses[:] = 0.0  # stays where it is
    sim.contacts.shear[:], sim.contacts.normal[:] = sheared, 0.0
    steps(sim, 1)
    return sim.bodies.forces[1].copy(), float(0.5 * (sim.joints.kn * np.minimum(sim.contacts.gaps, 0.0) ** 2).sum())


def turning_width(angle: float) -> float:
    """Share of the shorter edge over which the normal turns between edges under an angle [rad]."""
    return BLEND / (1.0 + STEEPER * max(abs(np.sin(angle)) - FLAT, 0.0))


@settings(max_examples=100, deadline=None)
@given(x=st.floats(-0.05, 0.05), y=st.floats(-1e-3, 1e-3), angle=st.floats(-1e-3, 1e-3))
def test_both_ends_lie_in_the_overlap(x, y, angle):
    """Within 2 % of an edge too: from the left corner of the cube to its right one or the rim, whichever is nearer."""
    sim = on_a_rim()
    put(sim, x, y, angle)
    sim.measured()
    right, left = sorted(sim.joints.points[:, 0], reverse=True)
    own = sim.bodies.corners[sim.shape.corner_blocks == 1]
    ends = sorted(own[own[:, 1].argsort()[:2], 0])
    reach = 3.0 * abs(angle) * max(abs(y), abs(x * angle)) + 1e-12  # across the joint, seen under an angle
    assert left == pytest.approx(ends[0], abs=reach)
    assert right == pytest.approx(min(ends[1], 1.0), abs=reach)


@pytest.mark.parametrize("chained", [False, True], ids=["plane", "chain"])
@pytest.mark.parametrize("angle", [-0.01, -0.1, -0.5])
def test_force_and_moment_go_on_where_a_corner_passes_the_rim(angle, chained):
    """With shear as well. The normal of the table and that of the cube are an angle apart: unblended, so much jumps."""
    sim, tiny, depth = on_a_rim(friction=2.0, chained=chained), 1e-9, 1e-3
    way = np.array([np.cos(angle / 2), np.sin(angle / 2)])  # along the bisector of both edges
    across = np.array([-way[1], way[0]])
    before, after = (
        pressed(sim, *(s * tiny * way - depth * across), angle, sheared=0.5 * KN * depth)[0] for s in (-1.0, 1.0)
    )
    force = np.hypot(*before[:2])
    assert force > 0.9 * KN * depth
    assert np.abs(after - before).max() < 10.0 * abs(angle) * tiny / turning_width(angle) * force
    reach = 1.1 * BLEND
    far = [pressed(sim, *at, angle)[0] for at in ((-reach, -depth), (reach, reach * np.tan(angle) - 2.0 * depth))]
    turned = [np.arctan2(-f[0], f[1]) for f in far]
    assert turned == pytest.approx([0.0, angle], abs=1e-12)  # beyond the blend: normal to the edge


@pytest.mark.parametrize("angle", [-0.01, -0.1])
def test_a_corner_that_passes_the_rim_at_one_depth_costs_nothing(angle):
    """Up to the rim the normal leans forward, beyond it back: what is borrowed is N angle BLEND / 4 and given back."""
    sim, depth = on_a_rim(), 1e-4
    xs = np.linspace(-0.05, 0.05, 4001)
    path = np.column_stack([xs, np.where(xs < 0.0, -depth, xs * np.tan(angle) - depth / np.cos(angle))])
    found = [pressed(sim, *place, angle) for place in path]
    forces, stored = np.array([force[:2] for force, _ in found]), np.array([energy for _, energy in found])
    work = np.concatenate([[0.0], (0.5 * (forces[1:] + forces[:-1]) * np.diff(path, axis=0)).sum(axis=1).cumsum()])
    missing = work + stored - stored[0]
    borrowed = KN * depth * abs(angle) * BLEND / 4
    assert np.abs(missing).max() == pytest.approx(borrowed, rel=0.05)
    assert abs(missing[-1]) < 0.02 * borrowed


@pytest.mark.parametrize("speed", [0.05, 0.3])
@pytest.mark.parametrize("angle", [-0.02, -0.1])
def test_a_cube_that_slides_over_the_rim_keeps_its_energy(angle, speed):
    """Tilted, without friction and without turning; 8 cm over the rim and down. What is missing does not add up."""
    sim = on_a_rim()
    mass = float(sim.model.masses[1])
    put(sim, -0.04, -DEPTH, angle)
    real_masses(sim)
    sim.loads.inverse_masses[1, 2] = 0.0
    step = 0.1 / np.sqrt(KN / mass)
    sim.bodies.velocities[1] = (speed, 0.0, 0.0)
    energies = []
    while sim.bodies.corners[sim.shape.corner_blocks == 1, 1].min() > -1.0 and sim.bodies.positions[1, 0] < 0.57:
        sim.bodies.travel[:] = 0.0  # the same two faces all the way
        steps(sim, 10, dt=step)
        height, (vx, vy) = sim.bodies.positions[1, 1], sim.bodies.velocities[1, :2]
        energies.append(0.5 * mass * (vx**2 + vy**2) + WEIGHT * height + 0.5 * sim.contacts.normal.max() ** 2 / KN)
    borrowed = abs(angle) * BLEND / 4 * SIDE * WEIGHT
    missing = np.abs(np.array(energies) - energies[0])
    assert sim.bodies.velocities[1, 0] > 1.5 * speed if speed < 0.1 else sim.bodies.velocities[1, 0] > speed
    assert missing.max() < 1.1 * borrowed
    assert missing[-20:].mean() < 0.25 * borrowed


@pytest.mark.parametrize("chained", [False, True], ids=["plane", "chain"])
@pytest.mark.parametrize("angle", [-0.5, -np.pi / 4])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_corner_of_a_stone_aslant_has_the_normal_of_the_face_that_it_has_entered(angle, side, chained):
    """A thousandth of an edge before the rim that of the table, behind it that of the cube; no bisector."""
    sim, depth = on_a_rim(chained=chained), 1e-6
    along = np.array([1.0, 0.0]) if side < 0.0 else np.array([np.cos(angle), np.sin(angle)])
    normal = np.array([-along[1], along[0]])
    force, _ = pressed(sim, *(side * 1e-3 * SIDE * along - depth * normal), angle)
    assert force[:2] == pytest.approx(KN * depth * normal, rel=1e-6, abs=1e-6 * KN * depth)
