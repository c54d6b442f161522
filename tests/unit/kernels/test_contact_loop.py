"""The contact loop: planar data in its spatial form, action and reaction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables

from dem_cli.engine.loops import compiled_advance
from dem_cli.engine.simulation import Simulation
from dem_cli.kernels import records as slot
from dem_cli.kernels.contact_forces import make_contact_forces
from dem_cli.kernels.jit import kernel
from dem_cli.kernels.records import Bodies, Contacts, Joints, Loads
from dem_cli.laws.registry import LAWS

LIKE = {2: (0.0,) * 2, 3: (0.0,) * 3}
LIKE_ROTATION = {2: (0.0,), 3: (0.0,) * 3}
PLANAR = [0, 1, 5]  # where x, y and the angle stand in space


class Twin(NamedTuple):
    """The arrays of a planar scene as a scene in space."""

    bodies: Bodies
    joints: Joints
    contacts: Contacts
    loads: Loads


def in_space(rows: np.ndarray) -> np.ndarray:
    """(n, 3) planar degrees of freedom as (n, 6)."""
    wide = np.zeros((len(rows), 6))
    wide[:, PLANAR] = rows
    return wide


def twin(sim: Simulation) -> Twin:
    """Frames with ez as second tangent, levers about all three axes."""
    joints, contacts, n = sim.joints, sim.contacts, len(sim.joints.kn)
    normals = joints.frames[:, :2]
    frames, levers = np.zeros((n, 9)), np.zeros((n, 2, 3, 3))
    frames[:, :2] = normals
    frames[:, 3], frames[:, 4], frames[:, 8] = -normals[:, 1], normals[:, 0], 1.0
    owners = joints.blocks.repeat(2, axis=0)
    for side in (0, 1):
        arms = joints.points - sim.bodies.positions[owners[:, side]]
        levers[:, side, 0, 2] = joints.levers[:, 2 * side]
        levers[:, side, 1, 2] = joints.levers[:, 2 * side + 1]
        levers[:, side, 2, :2] = np.column_stack([arms[:, 1], -arms[:, 0]])
    bodies = Bodies(
        positions=np.column_stack([sim.bodies.positions, np.zeros(len(sim.bodies.positions))]),
        orientations=sim.bodies.orientations.copy(),
        velocities=in_space(sim.bodies.velocities),
        forces=in_space(sim.bodies.forces),
        unbalanced=in_space(sim.bodies.unbalanced),
        corners=sim.bodies.corners.copy(),
        turns=sim.bodies.turns.copy(),
        means=np.zeros(6 * len(sim.bodies.positions)),
        drags=np.zeros(6 * len(sim.bodies.positions)),
        pulled=np.zeros(6 * len(sim.bodies.positions)),
        travel=sim.bodies.travel.copy(),
    )
    loads = Loads(*(in_space(field) for field in sim.loads))
    free = ~sim.model.fixed
    loads.inverse_masses[np.ix_(free, [2, 3, 4])] = 1.0
    loads.force_scales[:, 2:5] = 1.0
    shear = np.column_stack([contacts.shear, np.zeros(n)])
    same = {name: getattr(contacts, name).copy() for name in ("gaps", "normal", "slip")}
    copied = contacts._replace(shear=shear, **same)
    return Twin(bodies, joints._replace(frames=frames, levers=levers.reshape(n, 18)), copied, loads)


def pushed_wall(n_steps: int, kinematics: str = "fixed") -> Simulation:
    """A wall on its way to failure: sticking, sliding and open joints."""
    sim = simulation(tables(*running_wall(4, 3)), kinematics)
    sim.set_load(0.7)
    sim.advance(n_steps, slot.HOLD_LOAD)
    return sim


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_planar_twin_of_the_loop(kinematics):
    """Planar data in space: bit by bit the same forces, gaps, shear, slip and friction work."""
    sim = pushed_wall(1500, kinematics)
    other = twin(sim)
    states = sim.contacts.normal > 0
    assert states.any()
    assert not states.all()
    loop = kernel(make_contact_forces(LAWS["coulomb"].function, kinematics == "fixed"))
    rng, work = np.random.default_rng(3), []
    for _ in range(5):
        kick = rng.normal(size=sim.bodies.velocities.shape) * 1e-6
        sim.bodies.velocities[:] += kick
        other.bodies.velocities[:] = in_space(sim.bodies.velocities)
        sim.bodies.forces[:], other.bodies.forces[:] = 0.0, 0.0
        moving, lifted = sim.bodies, other.bodies
        flat = loop(sim.joints, sim.contacts, moving.velocities, moving.forces, 1.0, LIKE[2], LIKE_ROTATION[2])
        high = loop(
            other.joints, other.contacts, lifted.velocities, lifted.forces, 1.0, LIKE[3], LIKE_ROTATION[3]
        )  # fmt: skip
        assert flat == high
        work.append(flat)
        assert np.array_equal(other.bodies.forces[:, PLANAR], sim.bodies.forces)
        assert not other.bodies.forces[:, 2:5].any()
        for name in ("gaps", "normal", "slip"):
            assert np.array_equal(getattr(other.contacts, name), getattr(sim.contacts, name)), name
        assert np.array_equal(other.contacts.shear[:, 0], sim.contacts.shear[:, 0])
        assert not other.contacts.shear[:, 1].any()
    assert any(work)


@pytest.mark.parametrize("mode", [slot.HOLD_LOAD, slot.CREEP, slot.FIRE], ids=["load", "creep", "fire"])
def test_planar_twin_of_a_run(mode):
    """A thousand steps of load, creep or FIRE in space: the same positions, ledger and control."""
    sim = pushed_wall(300)
    sim.control[slot.RATE] = 1e-6
    other, control, ledger = twin(sim), sim.control.copy(), sim.ledger.copy()
    run = compiled_advance("fixed", sim.law)
    run(
        1000, mode, 1.0, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.loads,
        sim.control, sim.ledger, LIKE[2], LIKE_ROTATION[2],
    )  # fmt: skip
    run(
        1000, mode, 1.0, other.bodies, sim.shape, other.joints, sim.geometry, other.contacts, other.loads,
        control, ledger, LIKE[3], LIKE_ROTATION[3],
    )  # fmt: skip
    assert np.array_equal(other.bodies.velocities[:, PLANAR], sim.bodies.velocities)
    assert np.array_equal(other.bodies.positions[:, :2], sim.bodies.positions)
    assert np.array_equal(ledger, sim.ledger)
    assert np.array_equal(control, sim.control)
    assert not other.bodies.velocities[:, 2:5].any()


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_action_is_reaction(kinematics):
    """Contact forces and their moments about one point add up to nothing."""
    sim = pushed_wall(1500, kinematics)
    forces = sim.bodies.forces
    places = sim.model.centroids if kinematics == "fixed" else sim.bodies.positions - sim.bodies.velocities[:, :2]
    scale = np.abs(forces[:, :2]).sum()
    moments = forces[:, 2] + places[:, 0] * forces[:, 1] - places[:, 1] * forces[:, 0]
    assert np.all(np.abs(forces[:, :2].sum(axis=0)) < 1e-14 * scale)
    assert abs(moments.sum()) < 1e-13 * scale


def test_base_carries_the_weight():
    """At rest the contact force on the fixed block is the weight of everything above."""
    sim = simulation(tables(*running_wall(4, 3)))
    sim.advance(20_000, slot.HOLD_LOAD)
    weight = sim.model.masses[~sim.model.fixed].sum() * 9.81
    base = sim.bodies.forces[sim.model.fixed][0]
    assert base[1] == pytest.approx(-weight, rel=1e-8)
    assert abs(base[0]) < 1e-8 * weight


def test_open_points_carry_nothing():
    sim = simulation(tables(block("base", rectangle(0, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))))
    sim.bodies.velocities[1, 1] = 1.0
    sim.loads.dead[:] = 0.0
    sim.advance(5, slot.HOLD_LOAD)
    assert not sim.bodies.forces.any()
    assert not sim.contacts.normal.any()
    assert sim.contacts.gaps == pytest.approx([5.0, 5.0])
