"""Dashpots of contact points against dense linear algebra: one block a point, sweeps, bounds; 2D and 3D."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dem_cli.core.kernels.dashpots import OPEN, SLIPS, STARTS, STICKS
from dem_cli.core.kernels.spatial_dashpots import LEAST, WIDTH, given_up, meet, put_gains, resist

RANDOM = np.random.default_rng(5)


def turned(rng) -> np.ndarray:
    """Any rotation matrix."""
    matrix, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


def scene(n_points: int = 4, viscosity: float = 1.0, seed: int = 5):
    """Three blocks, the first a support, on two joints in space with points, frames and inertia of any kind."""
    rng = np.random.default_rng(seed)
    moments = [np.zeros((3, 3))]
    for _ in range(2):
        axes = turned(rng)
        moments.append(axes @ np.diag(1.0 / rng.uniform(0.5, 2.0, 3)) @ axes.T)
    inverse = np.zeros((3, 6))
    inverse[1:, :3] = 1.0 / np.array([[2.0], [3.0]])
    n = 2 * n_points
    joints = SimpleNamespace(
        blocks=np.array([[0, 1], [1, 2]]), starts=np.array([0, n_points, n]), kn=rng.uniform(1e3, 4e3, n),
        ks=rng.uniform(1e3, 4e3, n), frames=np.array([turned(rng).ravel() for _ in range(n)]),
        levers=np.zeros((n, 18)), points=rng.uniform(-1.0, 1.0, (n, 3)), held=np.full(2, -1 - n_points),
    )  # fmt: skip
    bodies = SimpleNamespace(
        positions=rng.uniform(-1.0, 1.0, (3, 3)), velocities=rng.uniform(-1.0, 1.0, (3, 6)), forces=np.zeros((3, 6)),
        mobilities=np.array(moments).reshape(3, 9),
    )  # fmt: skip
    bodies.velocities[0] = 0.0
    contacts = SimpleNamespace(
        normal=np.full(n, 1e9), memory=np.zeros((n, 3)), slip=np.zeros(n), gaps=np.zeros(n)
    )  # fmt: skip
    dampers = SimpleNamespace(
        first=0, viscosity=np.full(2, viscosity), elements=np.zeros((0, 2)), rates=np.zeros((n, 3)),
        gains=np.ones((n, WIDTH)), packed=np.zeros(3, int), holders=np.zeros(n, int), lasts=np.zeros(2, int),
        rooms=np.zeros(2, int),
        active=np.zeros(3, int), awake=np.zeros(2, int), met=np.zeros(2, np.int8), stirred=np.zeros(3, np.int8),
        trifles=np.zeros(3), slips=np.zeros(n), states=np.full(n, STICKS, np.int8), pushes=np.zeros((3, 6)),
        motions=np.zeros(0), lifts=np.zeros(0), strained=None,
    )  # fmt: skip
    return joints, bodies, contacts, inverse, dampers


def rows_of(joints, bodies) -> np.ndarray:
    """Rates at all points from the velocities of all blocks, (n_points·3, 18)."""
    found = np.zeros((len(joints.kn), 3, 3, 6))
    for point, owner in enumerate(np.repeat([0, 1], np.diff(joints.starts))):
        frame = joints.frames[point].reshape(3, 3)
        for block, sign in zip(joints.blocks[owner], (-1.0, 1.0), strict=True):
            found[point, :, block, :3] = sign * frame
            found[point, :, block, 3:] = sign * np.cross(joints.points[point] - bodies.positions[block], frame)
    return found.reshape(-1, 18)


def inverse_masses(bodies, inverse) -> np.ndarray:
    """Of all blocks, (18, 18)."""
    found = np.zeros((18, 18))
    for block in range(3):
        found[6 * block : 6 * block + 3, 6 * block : 6 * block + 3] = np.diag(inverse[block, :3])
        moving = slice(6 * block + 3, 6 * block + 6)
        found[moving, moving] = bodies.mobilities[block].reshape(3, 3)
    return found


LIKE = (0.0, 0.0, 0.0)


def step(joints, bodies, contacts, inverse, dampers, turns: int, kick: np.ndarray, dt: float = 1e-2) -> None:
    """What a step does: rates before, velocities after the kick, dashpots; so often, from impulses found before."""
    before, slips = bodies.velocities.copy(), dampers.slips.copy()
    for _ in range(turns):
        bodies.velocities[:], dampers.slips[:] = before, slips
        meet(joints, contacts, bodies, inverse, dampers, dt, LIKE, LIKE)
        bodies.means = bodies.velocities.ravel().copy()
        bodies.velocities += kick
        resist(joints, contacts, bodies, inverse, dampers, dt, 1, LIKE, LIKE)


def exact(joints, bodies, inverse, before: np.ndarray, kicked: np.ndarray, viscosity: float = 1.0):
    """Impulses J = −C (rates before + after) and velocities after them, all at once."""
    rows, masses = rows_of(joints, bodies), inverse_masses(bodies, inverse)
    half = 0.5e-2 * viscosity * np.column_stack([joints.kn, joints.ks, joints.ks]).ravel()
    around = rows @ masses @ rows.T
    right = -half * (rows @ (before + kicked).ravel())
    found = np.linalg.solve(np.eye(len(half)) + half[:, None] * around, right)
    return found, kicked + (masses @ rows.T @ found).reshape(3, 6)


def test_one_point_is_solved_at_once():
    """A block on one point: one sweep gives the impulse of the implicit dashpot exactly."""
    joints, bodies, contacts, inverse, dampers = scene(1)
    joints.kn[1] = joints.ks[1] = 0.0
    contacts.normal[1] = 0.0
    dampers.elements, contacts.memory = np.array([[1.0, 0.0]]), np.zeros((2, 6))  # asks for rates, and gains nothing
    before, kick = bodies.velocities.copy(), np.zeros((3, 6))
    kick[1:] = 0.3
    rows = rows_of(joints, bodies)
    impulses, after = exact(joints, bodies, inverse, before, before + kick)
    step(joints, bodies, contacts, inverse, dampers, 1, kick)
    assert contacts.memory[0, :3] == pytest.approx(impulses[:3], rel=1e-12)
    assert bodies.velocities == pytest.approx(after, abs=1e-12)
    assert dampers.rates[0] == pytest.approx((rows @ before.ravel())[:3], rel=1e-12)


def test_sweeps_find_the_impulses_of_all_points():
    joints, bodies, contacts, inverse, dampers = scene(viscosity=0.05)
    before, kick = bodies.velocities.copy(), RANDOM.uniform(-1.0, 1.0, (3, 6))
    kick[0] = 0.0
    impulses, after = exact(joints, bodies, inverse, before, before + kick, 0.05)
    step(joints, bodies, contacts, inverse, dampers, 200, kick)
    assert bodies.velocities == pytest.approx(after, abs=1e-9)
    assert contacts.memory.ravel() == pytest.approx(impulses, abs=1e-6 * np.abs(impulses).max())
    contacts.memory[:] = impulses.reshape(-1, 3)  # a perfect guess: one pair of sweeps changes nothing
    bodies.velocities[:] = before
    step(joints, bodies, contacts, inverse, dampers, 1, kick)
    assert bodies.velocities == pytest.approx(after, abs=1e-10)


def test_spring_and_dashpot_do_not_pull():
    """Impulses across joints are at least −N dt, and what is left satisfies all other equations."""
    viscosity, dt = 0.05, 1e-2
    joints, bodies, contacts, inverse, dampers = scene(viscosity=viscosity)
    contacts.normal[:] = 20.0
    before, kick = bodies.velocities.copy(), np.zeros((3, 6))
    step(joints, bodies, contacts, inverse, dampers, 200, kick, dt)
    rows, impulses = rows_of(joints, bodies), contacts.memory
    half = 0.5 * viscosity * dt * np.column_stack([joints.kn, joints.ks, joints.ks])
    left = impulses + half * (rows @ (before + bodies.velocities).ravel()).reshape(-1, 3)
    bound = impulses[:, 0] <= -contacts.normal * dt * (1.0 - 1e-12)
    assert bound.any()
    assert not bound.all()
    assert (impulses[:, 0] >= -contacts.normal * dt).all()
    assert np.abs(left[:, 1:]).max() < 1e-8
    assert np.abs(left[~bound, 0]).max() < 1e-8
    assert (left[bound, 0] >= 0.0).all()  # they would pull more


def test_points_that_slip_have_no_dashpot_along_the_joint():
    joints, bodies, contacts, inverse, dampers = scene()
    contacts.memory[:] = 1.0
    contacts.slip[::2] = 1.0
    step(joints, bodies, contacts, inverse, dampers, 2, np.zeros((3, 6)))
    assert (dampers.states[::2] == SLIPS).all()
    assert (contacts.memory[::2, 1:] == 0.0).all()
    assert (np.abs(contacts.memory[1::2, 1:]) > 0.0).all()


def test_turns_go_on_where_points_have_met():
    """From no impulse at all: six turns are those over all joints; nothing is stirred where trifles are large."""
    found = []
    for trifle in (0.0, np.inf):
        joints, bodies, contacts, inverse, dampers = scene(viscosity=0.05)
        contacts.gaps[:] = -1.0
        dampers.states[:] = OPEN
        dampers.trifles[:] = np.inf, trifle, trifle
        meet(joints, contacts, bodies, inverse, dampers, 1e-2, LIKE, LIKE)
        assert dampers.met.all()
        bodies.means = bodies.velocities.ravel().copy()
        resist(joints, contacts, bodies, inverse, dampers, 1e-2, 6, LIKE, LIKE)
        found.append((contacts.memory.copy(), dampers.stirred.tolist()))
    joints, bodies, contacts, inverse, dampers = scene(viscosity=0.05)
    contacts.gaps[:] = -1.0
    before = bodies.velocities.copy()
    for turn in range(6):
        dampers.states[:] = OPEN
        bodies.velocities[:] = before
        meet(joints, contacts, bodies, inverse, dampers, 1e-2, LIKE, LIKE)
        bodies.means = before.ravel().copy()
        resist(joints, contacts, bodies, inverse, dampers, 1e-2, 1, LIKE, LIKE)
        if turn == 0:
            assert (found[1][0] == contacts.memory).all()
    assert found[0][1][1:] == [6, 6]
    assert found[1][1] == [0, 0, 0]
    assert found[0][0] == pytest.approx(contacts.memory, rel=1e-9, abs=1e-9)


def test_open_slots_hold_nothing():
    """A slot that no point uses, without stiffness and force, forgets and gives nothing."""
    joints, bodies, contacts, inverse, dampers = scene()
    contacts.memory[:] = 1.0
    contacts.normal[:] = joints.kn[:] = joints.ks[:] = 0.0
    before = bodies.velocities.copy()
    step(joints, bodies, contacts, inverse, dampers, 2, np.zeros((3, 6)))
    assert (bodies.velocities == before).all()
    assert (contacts.memory == 0.0).all()


def test_rows_that_move_to_and_fro_change_nothing():
    """Points come and go, so that joints need more room than they have, until all begin with the first row again."""
    rng = np.random.default_rng(2)
    old = scene(viscosity=0.05)
    starts = []
    for _ in range(12):
        joints, bodies, contacts, _, dampers = old
        touching = rng.random(len(joints.kn)) < 0.6
        contacts.normal[:] = np.where(touching, 1e9, 0.0)
        joints.held[:] = -1 - touching.reshape(2, -1).sum(axis=1)
        new = scene(viscosity=0.05)
        new[1].velocities[:], new[2].normal[:], new[2].memory[:] = bodies.velocities, contacts.normal, contacts.memory
        new[4].states[:], new[0].held[:] = dampers.states, joints.held
        for each in (old, new):
            step(*each, 1, np.full((3, 6), 0.1))
        assert (new[1].velocities == bodies.velocities).all()
        assert (new[2].memory == contacts.memory).all()
        starts.append(dampers.packed[0])
    assert starts[-1] < max(starts) > 0


def test_impulses_take_energy_whatever_the_stiffness():
    """Energy only falls, from soft to next to rigid dashpots, after one pair of sweeps."""
    for viscosity in (1e-3, 1.0, 1e3, 1e6):
        joints, bodies, contacts, inverse, dampers = scene(viscosity=viscosity, seed=8)
        dampers.states[:] = STARTS
        masses = np.linalg.pinv(inverse_masses(bodies, inverse))
        before = bodies.velocities.ravel() @ masses @ bodies.velocities.ravel()
        step(joints, bodies, contacts, inverse, dampers, 1, np.zeros((3, 6)))
        assert bodies.velocities.ravel() @ masses @ bodies.velocities.ravel() < before


@pytest.mark.parametrize("slips", [False, True])
def test_block_of_a_point_is_the_inverse(slips):
    joints, bodies, _, inverse, _ = scene(1)
    reaches = tuple(tuple(joints.points[1] - bodies.positions[block]) for block in (1, 2))
    mobilities = tuple(tuple(map(tuple, bodies.mobilities[block].reshape(3, 3))) for block in (1, 2))
    frame, rows = joints.frames[1].reshape(3, 3), np.zeros((1, WIDTH))
    normal = tuple(frame[0])
    put_gains(rows, 0, normal, reaches, inverse[1, 0] + inverse[2, 0], mobilities, (7.0, 3.0), slips)
    motion = rows_of(joints, bodies)[3:]
    matrix = np.eye(3) + np.diag([7.0, 3.0, 3.0]) @ motion @ inverse_masses(bodies, inverse) @ motion.T
    expected = np.linalg.inv(matrix)
    if slips:
        expected = np.zeros((3, 3))
        expected[0, 0] = 1.0 / matrix[0, 0]
    before = np.array([0.6, 0.0, 0.0] if slips else [0.6, -0.4, 0.9])
    rates = np.array([1.0, 2.0, -3.0])
    wanted = before - expected @ (before + np.array([7.0, 3.0, 3.0]) * rates)
    rows[0, LEAST] = -np.inf
    new = frame @ given_up(rows, 0, normal, tuple(before @ frame), tuple(rates @ frame))
    assert new == pytest.approx(wanted, rel=1e-12, abs=1e-14)
    rows[0, LEAST] = wanted[0] + 0.25  # what the bound gives back goes on to the others
    new = frame @ given_up(rows, 0, normal, tuple(before @ frame), tuple(rates @ frame))
    assert new == pytest.approx(wanted + 0.25 / expected[0, 0] * expected[:, 0], rel=1e-12, abs=1e-14)
