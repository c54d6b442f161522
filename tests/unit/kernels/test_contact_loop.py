"""The contact loop: planar data in its spatial form, against point-by-point sums, action and reaction."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables
from synthetic.twins import LIKE, LIKE_ROTATION, PLANAR, in_space, twin

from dem_cli.core.contact.joints import empty_contacts
from dem_cli.core.engine.loops import compiled_advance
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.contact_forces import make_contact_forces
from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.laws.registry import LAWS

DEPTH = 0.08  # of prisms [m]


def pushed_wall(n_steps: int, kinematics: str = "fixed") -> Simulation:
    """A wall on its way to failure: sticking, sliding and open joints."""
    sim = simulation(tables(*running_wall(4, 3)), kinematics)
    sim.set_load(0.7)
    sim.advance(n_steps, slot.HOLD_LOAD)
    return sim


def coulomb_loop():
    return kernel(make_contact_forces(LAWS["coulomb"].function))


def test_planar_twin_of_the_loop():
    """Planar data in space: bit by bit the same forces, gaps, shear, slip and friction work."""
    sim = pushed_wall(1500)
    other = twin(sim)
    states = sim.contacts.normal > 0
    assert states.any()
    assert not states.all()
    loop, rng, work = coulomb_loop(), np.random.default_rng(3), []
    for _ in range(5):
        kick = rng.normal(size=sim.bodies.velocities.shape) * 1e-6
        sim.bodies.velocities[:] += kick
        other.bodies.velocities[:] = in_space(sim.bodies.velocities)
        sim.bodies.forces[:], other.bodies.forces[:] = 0.0, 0.0
        flat = loop(sim.joints, sim.geometry, sim.contacts, sim.bodies, 1.0, LIKE[2], LIKE_ROTATION[2])
        high = loop(other.joints, sim.geometry, other.contacts, other.bodies, 1.0, LIKE[3], LIKE_ROTATION[3])
        assert flat == high
        work.append(flat)
        assert np.array_equal(other.bodies.forces[:, PLANAR], sim.bodies.forces)
        assert not other.bodies.forces[:, 2:5].any()
        for name in ("gaps", "normal", "slip"):
            assert np.array_equal(getattr(other.contacts, name), getattr(sim.contacts, name)), name
        assert np.array_equal(other.contacts.shear[:, 0], sim.contacts.shear[:, 0])
        assert not other.contacts.shear[:, 1].any()
    assert any(work)


def test_layers_share_what_a_planar_point_carries():
    """Prisms with points at both ends of their depth move as in the plane, to round-off, and stay in it."""
    sim = pushed_wall(300)
    other, control, ledger = twin(sim, (-0.5 * DEPTH, 0.5 * DEPTH)), sim.control.copy(), sim.ledger.copy()
    run(200, slot.HOLD_LOAD, other, sim, control, ledger)
    start = sim.bodies.positions.copy()
    sim.advance(200, slot.HOLD_LOAD)
    moved = np.abs(sim.bodies.positions - start).max()
    assert moved > 0.0
    assert np.abs(other.bodies.positions[:, :2] - sim.bodies.positions).max() < 1e-9 * moved
    assert np.abs(other.bodies.velocities[:, [2, 3, 4]]).max() < 1e-9 * np.abs(sim.bodies.velocities).max()
    assert ledger == pytest.approx(sim.ledger, rel=1e-9)
    assert other.contacts.normal.reshape(-1, 2).sum(axis=1) == pytest.approx(sim.contacts.normal, rel=1e-9, abs=1e-12)
    assert other.bodies.orientations[:, 2] == pytest.approx(sim.bodies.orientations[:, 0], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("d", [2, 3])
def test_forces_are_those_of_the_points_one_by_one(d):
    """Random joints against each point's own velocity and the moment of its force, in numpy; in space friction acts
    nearer to the centre of pressure of the step before."""
    rng, r, n_blocks, n = np.random.default_rng(d), d * (d - 1) // 2, 5, 12
    starts = np.concatenate([[0], np.cumsum(rng.integers(1, 6, n))])
    directions = np.linalg.qr(rng.normal(size=(n, d, d)))[0]
    directions[:, -1] *= np.linalg.det(directions)[:, None]
    centroids = rng.normal(size=(n_blocks, d))
    anchors, blocks = rng.normal(size=(n, d)), np.array([rng.choice(n_blocks, 2, replace=False) for _ in range(n)])
    joints = FixedJoints(
        blocks=blocks, starts=starts,
        axes=np.ascontiguousarray(directions.reshape(n, -1)[:, : 2 if d == 2 else 9]), anchors=anchors,
        arms=np.ascontiguousarray((anchors[:, None] - centroids[blocks]).reshape(n, -1)),
        places=rng.normal(size=(starts[-1], d - 1)), kn=rng.uniform(1.0, 2.0, starts[-1]),
        ks=rng.uniform(0.5, 1.0, starts[-1]), law=np.full((n, 1), 0.4),
        torsion=rng.uniform(0.4, 1.0, n if d == 3 else 0),
    )  # fmt: skip
    contacts = empty_contacts(n, int(starts[-1]), d, 0)
    contacts.gaps[:] = rng.uniform(-1.0, 0.2, starts[-1])
    contacts.normal[:] = before = rng.uniform(0.0, 1.0, starts[-1]) if d == 3 else np.zeros(starts[-1])
    before = before.copy()
    gaps, owners, dt = contacts.gaps.copy(), joints.owners, 0.1
    sim = simulation(tables(block("base", rectangle(0, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))))
    velocities, forces = rng.normal(size=(n_blocks, d + r)), np.zeros((n_blocks, d + r))
    bodies = sim.bodies._replace(velocities=velocities, forces=forces)
    lost = coulomb_loop()(joints, sim.geometry, contacts, bodies, dt, LIKE[d], LIKE_ROTATION[d])

    expected, work = np.zeros_like(forces), 0.0
    for p, j in enumerate(owners):
        frame, point = directions[j], anchors[j] + joints.places[p] @ directions[j, 1:]
        gap = gaps[p] + frame[0] @ apart(point, centroids, velocities, blocks[j], dt)
        own = slice(starts[j], starts[j + 1])
        rubs = point
        if d == 3:
            centre = anchors[j] + np.average(joints.places[own], axis=0, weights=before[own]) @ directions[j, 1:]
            rubs = centre + joints.torsion[j] * (point - centre)
        moved = apart(rubs, centroids, velocities, blocks[j], dt)
        assert contacts.gaps[p] == pytest.approx(gap, abs=1e-14)
        normal, trial = joints.kn[p] * max(-gap, 0.0), -joints.ks[p] * frame[1:] @ moved
        shear = trial * min(1.0, 0.4 * normal / np.linalg.norm(trial))
        if gap < 0.0:
            work -= 0.5 * shear @ (frame[1:] @ moved + shear / joints.ks[p])
        for i, sign in zip(blocks[j], (-1.0, 1.0)):
            for force, at in ((normal * frame[0], point), (shear @ frame[1:], rubs)):
                expected[i] += sign * np.append(force, moment(at - centroids[i], force))
        assert np.append(contacts.normal[p], contacts.shear[p]) == pytest.approx(np.append(normal, shear), abs=1e-13)
    assert 0 < (contacts.slip > 0).sum() < (contacts.normal > 0).sum() < len(owners)
    assert forces == pytest.approx(expected, abs=1e-12)
    assert lost == pytest.approx(work, rel=1e-12)


def apart(point: np.ndarray, centroids: np.ndarray, velocities: np.ndarray, pair: np.ndarray, dt: float) -> np.ndarray:
    """How far the second of two blocks moves against the first at a point in a step."""
    return dt * np.diff([velocity(point - centroids[i], velocities[i]) for i in pair], axis=0)[0]


def velocity(arm: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """Of a point of a block, from the motion of its centroid."""
    if len(arm) == 2:
        return motion[:2] + motion[2] * np.array([-arm[1], arm[0]])
    return motion[:3] + np.cross(motion[3:], arm)


def moment(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.cross(arm, force) if len(arm) == 3 else np.array([arm[0] * force[1] - arm[1] * force[0]])


def run(n_steps: int, mode: int, other, sim: Simulation, control: np.ndarray, ledger: np.ndarray) -> None:
    """Steps of a twin in space."""
    compiled_advance("fixed", sim.law)(
        n_steps, mode, 1.0, other.bodies, sim.shape, other.joints, sim.geometry, other.contacts, sim.links, other.loads,
        control, ledger, LIKE[3], LIKE_ROTATION[3],
    )  # fmt: skip


@pytest.mark.parametrize("mode", [slot.HOLD_LOAD, slot.CREEP, slot.FIRE], ids=["load", "creep", "fire"])
def test_planar_twin_of_a_run(mode):
    """A thousand steps of load, creep or FIRE in space: the same positions, ledger and control."""
    sim = pushed_wall(300)
    sim.control[slot.RATE] = 1e-6
    other, control, ledger = twin(sim), sim.control.copy(), sim.ledger.copy()
    run(1000, mode, other, sim, control, ledger)
    sim.advance(1000, mode)
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
