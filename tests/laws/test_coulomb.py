"""The Coulomb law along displacement paths, uncompiled; what comes out is known everywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dem_cli.core.laws.displacement_path import drive
from dem_cli.core.laws.registry import LAWS

KN, KS, MU = 2.0e6, 1.0e6, 0.6
COULOMB = LAWS["coulomb"]
TABLE = COULOMB.parameters(friction=MU)


def along(path):
    """Drive one point along rows of gap and total tangential displacement(s); rows of N, T…"""
    done = drive(COULOMB, TABLE, path, kn=KN, ks=KS)
    return np.column_stack([done.normal, done.shear]), done.slip


def test_sticks_then_slides():
    """T = −ks u up to μN, constant beyond; unloading follows the same stiffness."""
    limit = MU * KN * 1e-5
    there = np.linspace(0.0, 5e-5, 51)
    back = np.linspace(5e-5, 0.0, 51)[1:]
    rows, slip = along([(-1e-5, u) for u in [*there, *back]])
    assert np.all(rows[:, 0] == KN * 1e-5)
    np.testing.assert_allclose(rows[:51, 1], -np.minimum(KS * there, limit), rtol=1e-12, atol=1e-12)
    expected = np.minimum(-limit + KS * (5e-5 - back), limit)
    np.testing.assert_allclose(rows[51:, 1], expected, rtol=1e-12, atol=1e-9)
    assert not slip[: int(limit / KS / 1e-6)].any()
    assert slip[50] == pytest.approx(5e-5 - limit / KS)


def test_open_joint_carries_nothing_and_forgets():
    rows, _ = along([(-1e-5, 0.0), (-1e-5, 1e-6), (1e-6, 1e-6), (-1e-5, 1e-6)])
    assert rows[1, 1] == pytest.approx(-KS * 1e-6)
    assert rows[2].tolist() == [0.0, 0.0]
    assert rows[3].tolist() == [KN * 1e-5, 0.0]


def test_true_stick_does_not_creep():
    """Ten thousand small steps to and fro below the limit leave the force where it was."""
    table, memory = np.array([[MU]]), np.zeros((1, 0))
    shear = (0.95 * MU * KN * 1e-5,)
    for sign in (1.0, -1.0) * 5000:
        _, shear, slipped = COULOMB.function(-1e-5, (sign * 1e-8,), shear, KN, KS, table, 0, memory, 0)
        assert not slipped
    assert shear[0] == pytest.approx(0.95 * MU * KN * 1e-5, rel=1e-9)


def test_limit_falls_with_the_normal_force():
    rows, _ = along([(-1e-5, 2e-5), (-0.5e-5, 2e-5)])
    assert rows[:, 1] == pytest.approx([-MU * KN * 1e-5, -MU * KN * 0.5e-5])


def test_slides_in_the_direction_of_motion_in_3d():
    """Two tangents: μN against the slip; planar data gives planar forces."""
    rows, _ = along([(-1e-5, 3e-3 * t, 4e-3 * t) for t in np.linspace(0.0, 1.0, 11)])
    limit = MU * KN * 1e-5
    np.testing.assert_allclose(rows[-1, 1:], [-0.6 * limit, -0.8 * limit], rtol=1e-12)
    path = [(-1e-5, 1e-6 * t) for t in range(20)]
    planar, spatial = along(path)[0], along([(*row, 0.0) for row in path])[0]
    assert np.array_equal(planar, spatial[:, :2])


def test_angle_and_coefficient_say_the_same():
    parameters = COULOMB.parameters(friction_angle_deg=31.0)
    assert COULOMB.columns(parameters, KN)[0] == pytest.approx(math.tan(math.radians(31.0)))


def test_shear_limit_by_point():
    limit = COULOMB.shear_limit(np.array([[MU], [0.3]]), np.array([10.0, 20.0]), np.zeros((2, 0)), np.ones(2))
    np.testing.assert_allclose(limit, [0.6 * 10.0, 0.3 * 20.0])
