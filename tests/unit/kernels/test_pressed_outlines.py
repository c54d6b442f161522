"""Pressure on outlines that have corners at which they hardly turn: it is all there, and so is the friction of it."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, simulation, steps
from engine import tables as plane
from scipy.spatial.transform import Rotation
from studies.space.structures import box, tables

from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.geometry.rotation import quaternions

KN, DEEP, MU = 1e9, 1e-5, 0.6


def turned_pair(yaw: float, tilt: float = 0.0, shift: float = 0.0) -> Simulation:
    """A cube of 1 m that is pressed into a fixed one below it by DEEP, turned about the vertical."""
    case = tables(box("low", (0, 0, -1), (1, 1, 0), fixed=True), box("top", (0, 0, 0), (1, 1, 1)), friction=MU)
    case |= {"joints": {"dry": {"friction": MU, "kn": KN, "ks": KN}}, "analysis": {"kind": "gravity"}}
    sim = simulation(case, "large")
    sim.bodies.positions[1] += [shift, 0.0, -DEEP]
    sim.bodies.orientations[1] = quaternions(Rotation.from_rotvec([0.0, tilt, yaw]).as_rotvec()[None])[0]
    moves.find_faces(sim)
    stay(sim)
    return sim


def stay(sim: Simulation) -> None:
    """A step in which no block moves."""
    sim.loads.inverse_masses[:], sim.bodies.velocities[:] = 0.0, 0.0
    steps(sim, 1)


@pytest.mark.parametrize("yaw", [0.0, 1e-4, 1e-3, 0.02, 0.04, 0.2])
@pytest.mark.parametrize("tilt", [0.0, 2e-5, 1e-4])
def test_corners_that_hardly_turn_hand_their_pressure_on(yaw, tilt):
    """Corners where two edges cross at the angle of the yaw have next to no stiffness, and no more force than it."""
    sim = turned_pair(yaw, tilt)
    used = sim.joints.kn > 0.0
    area = sim.joints.kn[used].sum() / KN
    assert area == pytest.approx(2.0 / (1.0 + np.sin(yaw) + np.cos(yaw)), rel=1e-4)  # of two squares about one centre
    closed = sim.contacts.normal[used] / sim.joints.kn[used]
    deepest = DEEP + 0.5 * np.tan(tilt)
    assert closed.max() < 1.5 * deepest
    if tilt == 0.0:
        assert sim.contacts.normal.sum() == pytest.approx(KN * area * DEEP, rel=1e-9)


@pytest.mark.parametrize("yaw", [0.0, 1e-3, 0.02])
def test_the_same_faces_found_anew_make_no_energy(yaw):
    sim = turned_pair(yaw, 1e-4)
    before, force, made = sim.elastic_energy(), sim.contacts.normal.sum(), sim.contacts.exchanged.copy()
    for _ in range(3):
        moves.find_faces(sim)
        assert sim.elastic_energy() == pytest.approx(before, rel=1e-9)
        assert sim.contacts.normal.sum() == pytest.approx(force, rel=1e-9)
        stay(sim)
        assert sim.elastic_energy() == pytest.approx(before, rel=1e-9)
    assert abs(sim.contacts.exchanged - made).max() < 1e-9 * before


@pytest.mark.parametrize("dimension", [2, 3])
def test_faces_found_on_the_way_go_on_from_the_step_before(dimension):
    """Forces belong to gaps of before the last motion: with those of after it the books would lose that way."""
    if dimension == 3:
        sim = turned_pair(0.0, 2e-5)
    else:
        blocks = [block("low", rectangle(0, -1, 1, 0), fixed=True), block("top", rectangle(0, 0, 1, 1))]
        joints, gravity = {"dry": {"friction": MU, "kn": KN, "ks": KN}}, {"kind": "gravity"}
        sim = simulation(plane(*blocks, joints=joints, analysis=gravity), "large")
        sim.bodies.positions[1, 1] -= DEEP
        moves.find_faces(sim)
        stay(sim)
    sim.loads.inverse_masses[:] = 0.0
    sim.bodies.velocities[1, dimension - 1] = -0.3 * DEEP
    steps(sim, 1)  # blocks move behind the forces
    before, made = sim.elastic_energy(), sim.contacts.exchanged.copy()
    moves.find_faces(sim)
    assert sim.elastic_energy() == pytest.approx(before, rel=1e-9)
    assert abs(sim.contacts.exchanged - made).max() < 1e-9 * before
    stay(sim)
    assert sim.contacts.normal.sum() == pytest.approx(KN * 1.3 * DEEP, rel=1e-4)


def lean(sim: Simulation, angle: float, sunk: float) -> None:
    """The cube stands on its edge at this angle, `sunk` deep, away from all rims of the face below."""
    turned = Rotation.from_rotvec([0.0, angle, 0.0])
    lowest = turned.apply(np.array(list(np.ndindex(2, 2, 2))) - 0.5)[:, 2].min()
    sim.bodies.positions[1] = [0.5, 0.5, -sunk - lowest]
    sim.bodies.orientations[1] = quaternions(turned.as_rotvec()[None])[0]
    moves.find_faces(sim)
    stay(sim)


def test_an_edge_goes_on_as_soft_as_the_strip_that_was_pressed():
    """From 30° on the two faces look at each other no more; the overlap of the strip is not that of a stiff edge."""
    sim = turned_pair(0.0)
    lean(sim, np.radians(29.9), DEEP)
    before, force = sim.elastic_energy(), sim.contacts.normal.sum()
    assert force == pytest.approx(KN * DEEP**2 / (2.0 * np.tan(np.radians(29.9))), rel=0.15)
    for angle in (30.1, 31.0, 30.5):
        lean(sim, np.radians(angle), DEEP)
        assert sim.contacts.normal.sum() == pytest.approx(force, rel=1e-3)
        assert sim.elastic_energy() < 1.6 * before  # a spring that is a line has a half of it where a strip has a third


@pytest.mark.parametrize("yaw", [0.0, 1e-3, 0.02])
def test_all_of_the_pressure_rubs(yaw):
    """Slid by twenty times the slip that friction needs: μ N, whatever corners the outline has."""
    sim = turned_pair(yaw)
    for _ in range(20):
        sim.bodies.velocities[1, 0] = MU * DEEP
        steps(sim, 1)
    rubs = np.hypot(*sim.contacts.shear.T).sum()
    assert rubs == pytest.approx(MU * sim.contacts.normal.sum(), rel=1e-6)
