"""One contact point driven along displacement paths through the contact loop, plain and compiled.

Asserted: the closed form, the uncompiled law bit by bit, and external work = elastic + friction.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
import pytest

from dem_cli.contact.assemble import empty_contacts
from dem_cli.kernels.contact_forces import make_contact_forces
from dem_cli.kernels.records import Joints
from dem_cli.laws.registry import LAWS

KN, KS, MU = 2.0e6, 1.0e6, 0.5
CLOSED = -(2.0**-16)  # gap [m]
LIMIT = MU * KN * -CLOSED  # of the shear force [N]
YIELD = LIMIT / KS  # slide at which a point starts to slip [m]
LAW = LAWS["coulomb"]
PLAIN = make_contact_forces(LAW.function, integrates_gap=True)
COMPILED = numba.njit(error_model="numpy")(PLAIN)
LIKE = {2: ((0.0, 0.0), (0.0,)), 3: ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))}


class Driven(NamedTuple):
    """What came out, one row a step."""

    normal: np.ndarray
    shear: np.ndarray  # (n, d - 1)
    slip: float
    friction: float
    external: float  # work of whoever moves block b
    elastic: float


def drive(path, loop=COMPILED, gap=0.0, dt=0.125) -> Driven:
    """Move block b along rows of (gap, slide...) while a stands still; the point starts at `gap`."""
    path = np.asarray(path, float)
    d = path.shape[1]
    like, like_rotation = LIKE[d]
    joints = Joints(
        blocks=np.array([[0, 1]]), starts=np.array([0, 1]), frames=np.eye(d).reshape(1, -1),
        levers=np.zeros((1, 2 * d * len(like_rotation))), points=np.zeros((1, d)),
        edges=np.zeros((1, 4), int), scales=np.ones((1, 4)),
        kn=np.array([KN]), ks=np.array([KS]), law=np.array([[MU]]),
    )  # fmt: skip
    contacts = empty_contacts(1, 1, d, 0)
    contacts.gaps[0] = gap
    normals, shears, friction, external = [], [], 0.0, 0.0
    before, old = np.zeros(d), np.array([gap, *np.zeros(d - 1)])
    for row in path:
        velocities, forces = np.zeros((2, d + len(like_rotation))), np.zeros((2, d + len(like_rotation)))
        velocities[1, :d] = (row - old) / dt
        friction += loop(joints, contacts, velocities, forces, dt, like, like_rotation)
        assert np.array_equal(forces[0], -forces[1])
        external -= 0.5 * (before + forces[1, :d]) @ (row - old)
        before, old = forces[1, :d].copy(), row
        normals.append(contacts.normal[0])
        shears.append(contacts.shear[0].copy())
    elastic = 0.5 * (contacts.normal[0] ** 2 / KN + (contacts.shear[0] ** 2).sum() / KS)
    return Driven(np.array(normals), np.array(shears), contacts.slip[0], friction, external, elastic)


def alone(path) -> tuple[np.ndarray, np.ndarray]:
    """Normal and shear forces of the uncompiled law."""
    table, memory, normals, shears = np.array([[MU]]), np.zeros((1, 0)), [], []
    path = np.asarray(path, float)
    shear, old = (0.0,) * (path.shape[1] - 1), np.zeros(path.shape[1] - 1)
    for gap, *total in path:
        slide = tuple(np.array(total) - old)
        normal, shear, _ = LAW.function(gap, slide, shear, KN, KS, table, 0, memory, 0)
        old = np.array(total)
        normals.append(normal)
        shears.append(shear)
    return np.array(normals), np.array(shears)


def ramp(*targets, n=64):
    """Straight from target to target, n steps each; all steps are exact in binary."""
    targets = [np.zeros(len(targets[0])), *map(np.asarray, targets)]
    shares = np.arange(1, n + 1)[:, None] / n
    return np.concatenate([a + (b - a) * shares for a, b in zip(targets, targets[1:])])


U = 2.0**-15
PATHS = {
    "closing": ramp((CLOSED, 0.0)),
    "sliding": ramp((CLOSED, 0.0), (CLOSED, 4 * U)),
    "unloading": ramp((CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, 3.75 * U)),
    "to and fro": ramp((CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, -4 * U), (CLOSED, 4 * U)),
    "opening": ramp((CLOSED, 0.0), (CLOSED, U / 8), (0.0, U / 8), (-CLOSED, U), (0.0, U), (CLOSED, U)),
    "pressing while sliding": ramp((CLOSED, 0.0), (8 * CLOSED, 4 * U), (CLOSED, 8 * U)),
    "around a corner": ramp((CLOSED, 0.0, 0.0), (CLOSED, 4 * U, 0.0), (CLOSED, 4 * U, 4 * U)),
    "opening in space": ramp((CLOSED, 0.0, 0.0), (CLOSED, U / 8, U / 4), (0.0, U, U), (-CLOSED, U, U)),
}
each_path = pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)


@each_path
def test_loop_law_and_compiled_loop_agree(path):
    compiled, plain, law = drive(path), drive(path, PLAIN), alone(path)
    assert np.array_equal(compiled.normal, plain.normal)
    assert np.array_equal(compiled.shear, plain.shear)
    assert (compiled.slip, compiled.friction) == (plain.slip, plain.friction)
    assert np.array_equal(compiled.normal, law[0])
    assert np.array_equal(compiled.shear, law[1])


@each_path
def test_work_is_elastic_energy_and_friction(path):
    """To round-off: the loop books the mean of the forces really applied."""
    done = drive(path)
    assert done.external == pytest.approx(done.elastic + done.friction, rel=1e-12)
    assert done.friction >= 0.0


@each_path
def test_never_beyond_the_limit_and_never_in_tension(path):
    done = drive(path)
    assert np.all(done.normal >= 0.0)
    assert np.all(np.linalg.norm(done.shear, axis=1) <= MU * done.normal * (1 + 1e-14))


def test_slides_and_comes_back():
    """Slide u, back until it slips the other way at u − 2 μN/ks; the loop's area is the friction work."""
    there, back = 2 * U, -2 * U
    done = drive(ramp((CLOSED, 0.0), (CLOSED, there), (CLOSED, back), (CLOSED, there), n=256))
    steps = np.arange(1, 257) / 256
    first = -np.minimum(KS * there * steps, LIMIT)
    second = np.minimum(-LIMIT + KS * 4 * U * steps, LIMIT)
    np.testing.assert_allclose(done.shear[256:, 0], [*first, *second, *-second], rtol=0, atol=1e-12 * LIMIT)
    slipped = (there - YIELD) + 2 * (4 * U - 2 * YIELD)
    assert done.slip == pytest.approx(slipped, rel=1e-12)
    assert done.friction == pytest.approx(LIMIT * slipped, rel=1e-12)


def test_elastic_below_the_limit():
    """No work is lost in a thousand cycles, and the force comes back to zero."""
    cycle = ramp((CLOSED, 0.9 * YIELD), (CLOSED, -0.9 * YIELD), n=8)
    done = drive(np.concatenate([ramp((CLOSED, 0.0)), *[cycle] * 1000, [(CLOSED, 0.0)]]))
    assert done.friction == 0.0
    assert done.slip == 0.0
    assert abs(done.shear[-1, 0]) < 1e-9 * LIMIT


def test_opening_gives_the_stored_shear_to_friction():
    done = drive(ramp((CLOSED, 0.0), (CLOSED, 0.5 * YIELD), (0.0, 0.5 * YIELD), (-CLOSED, 0.5 * YIELD)))
    assert done.normal[-1] == 0.0
    assert done.elastic == 0.0
    assert done.friction == pytest.approx(0.5 * KS * (0.5 * YIELD) ** 2, rel=1e-12)
    # While it unloads the limit falls below the shear force; the path of the slip is the lost stretch
    # of the spring but for the last step, in which the point opens.
    assert 0.45 * YIELD < done.slip <= 0.5 * YIELD


def test_a_point_that_closes_again_starts_from_nothing():
    path = ramp((CLOSED, U / 8), (-CLOSED, U / 8), (-CLOSED, U), (CLOSED, U), (CLOSED, U + U / 16))
    done = drive(path)
    assert done.shear[-1, 0] == pytest.approx(-KS * U / 16, rel=1e-9)
    assert done.normal[-1] == pytest.approx(-KN * CLOSED, rel=1e-12)


def test_starts_open():
    """A point with a gap carries nothing until the gap is used up."""
    done = drive([(-CLOSED * (1 - t), 0.0) for t in np.arange(1, 17) / 8], gap=-CLOSED)
    assert not done.normal[:8].any()
    assert np.all(np.diff(done.normal[7:]) > 0.0)
    assert done.normal[-1] == pytest.approx(-KN * CLOSED, rel=1e-12)


def test_lag_behind_a_turning_slide():
    """Slide along a circle of radius R: the force trails the motion by asin(μN/(ks R)), of size μN."""
    radius, n = 5 * YIELD, 4000
    angles = np.linspace(0.0, 6 * np.pi, 3 * n + 1)[1:]
    circle = [(CLOSED, radius * np.sin(t), radius * (1 - np.cos(t))) for t in angles]
    done = drive(np.concatenate([ramp((CLOSED, 0.0, 0.0)), circle]))
    force = -done.shear[-1]
    lag = angles[-1] - np.arctan2(force[1], force[0])
    lag = (lag + np.pi) % (2 * np.pi) - np.pi
    assert np.hypot(*force) == pytest.approx(LIMIT, rel=1e-14)
    assert lag == pytest.approx(np.arcsin(YIELD / radius), abs=1.5 * np.pi / n)
    last_turn = done.friction - drive(np.concatenate([ramp((CLOSED, 0.0, 0.0)), circle[: 2 * n]])).friction
    expected = LIMIT * np.sqrt(1 - (YIELD / radius) ** 2) * 2 * np.pi * radius
    assert last_turn == pytest.approx(expected, rel=1e-3)
