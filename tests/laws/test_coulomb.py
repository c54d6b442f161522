"""The Coulomb law along displacement paths, uncompiled; what comes out is known everywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dem_cli.laws.registry import LAWS

KN, KS, MU = 2.0e6, 1.0e6, 0.6
COULOMB = LAWS["coulomb"]


def along(path, directions=1, parameters=(MU,)):
    """Drive one point along rows of gap and total tangential displacement(s); rows of N, T…, slipped."""
    table, memory = np.array([parameters]), np.zeros((1, COULOMB.n_memory))
    shear, old, rows = (0.0,) * directions, (0.0,) * directions, []
    for gap, *total in path:
        slide = tuple(new - before for new, before in zip(total, old, strict=True))
        normal, shear, slipped = COULOMB.function(gap, slide, shear, KN, KS, table, 0, memory, 0)
        rows.append((normal, *shear, slipped))
        old = tuple(total)
    return np.array(rows, dtype=float)


def test_sticks_then_slides():
    """T = −ks u up to μN, constant beyond; unloading follows the same stiffness."""
    limit = MU * KN * 1e-5
    there = np.linspace(0.0, 5e-5, 51)
    back = np.linspace(5e-5, 0.0, 51)[1:]
    rows = along([(-1e-5, u) for u in [*there, *back]])
    assert np.all(rows[:, 0] == KN * 1e-5)
    np.testing.assert_allclose(rows[:51, 1], -np.minimum(KS * there, limit), rtol=1e-12, atol=1e-12)
    expected = np.minimum(-limit + KS * (5e-5 - back), limit)
    np.testing.assert_allclose(rows[51:, 1], expected, rtol=1e-12, atol=1e-9)
    assert not rows[: int(limit / KS / 1e-6), 2].any()
    assert rows[50, 2]


def test_open_joint_carries_nothing_and_forgets():
    rows = along([(-1e-5, 0.0), (-1e-5, 1e-6), (1e-6, 1e-6), (-1e-5, 1e-6)])
    assert rows[1, 1] == pytest.approx(-KS * 1e-6)
    assert rows[2, :2].tolist() == [0.0, 0.0]
    assert rows[3, :2].tolist() == [KN * 1e-5, 0.0]


def test_true_stick_does_not_creep():
    """Ten thousand small steps to and fro below the limit leave the force where it was."""
    table, memory = np.array([[MU]]), np.zeros((1, 0))
    shear = (0.95 * MU * KN * 1e-5,)
    for sign in (1.0, -1.0) * 5000:
        _, shear, slipped = COULOMB.function(-1e-5, (sign * 1e-8,), shear, KN, KS, table, 0, memory, 0)
        assert not slipped
    assert shear[0] == pytest.approx(0.95 * MU * KN * 1e-5, rel=1e-9)


def test_limit_falls_with_the_normal_force():
    rows = along([(-1e-5, 2e-5), (-0.5e-5, 2e-5)])
    assert rows[:, 1] == pytest.approx([-MU * KN * 1e-5, -MU * KN * 0.5e-5])


def test_slides_in_the_direction_of_motion_in_3d():
    """Two tangents: μN against the slip; planar data gives planar forces."""
    rows = along([(-1e-5, 3e-3 * t, 4e-3 * t) for t in np.linspace(0.0, 1.0, 11)], directions=2)
    limit = MU * KN * 1e-5
    np.testing.assert_allclose(rows[-1, 1:3], [-0.6 * limit, -0.8 * limit], rtol=1e-12)
    path = [(-1e-5, 1e-6 * t) for t in range(20)]
    planar, spatial = along(path), along([(*row, 0.0) for row in path], directions=2)
    assert np.array_equal(planar[:, :2], spatial[:, :2])


def test_angle_and_coefficient_say_the_same():
    parameters = COULOMB.parameters.model_validate({"law": "coulomb", "friction_angle_deg": 31.0})
    assert COULOMB.columns(parameters)[0] == pytest.approx(math.tan(math.radians(31.0)))
