"""Barton's law against equation 5-2 written out once more, and against the tests of thesis Table 5-1."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError

from dem_cli.core.laws.displacement_path import drive

KG_PER_CM2 = 9.80665e4  # [Pa]
PEPERINO = {"jrc": 1.96, "jcs": 281.53 * KG_PER_CM2, "residual_angle_deg": 23.14}  # equation 5-5
BARTON = joint("barton", **PEPERINO)
KN, KS, AREA = 4.0e9, 1.0e9, 0.04 * 0.08
TABLE_5_1 = {0.005: (0.61, 0.00694), 0.088: (0.551, 0.00225), 0.192: (0.579, 0.006), 0.441: (0.534, 0.003)}


def tan_phi(stress):
    """Equation 5-5, with the stress in kg/cm²."""
    return np.tan(np.radians(1.96 * np.log10(281.53 / np.asarray(stress)) + 23.14))


def along(path, law=BARTON):
    return drive(law.law, law.table, path, kn=KN, ks=KS, area=AREA)


def sliding_friction(stress, law=BARTON):
    """T/N of a point that slides under a normal stress [Pa]."""
    gap = -stress / KN
    done = along(ramp((gap, 0.0), (gap, 4 * stress / KS + 1e-9), n=8), law)
    return -done.shear[-1, 0] / done.normal[-1]


@pytest.mark.parametrize("stress", [0.001, 0.005, 0.088, 0.192, 0.441, 10.0, 281.0])
def test_friction_is_that_of_the_stress(stress):
    assert sliding_friction(stress * KG_PER_CM2) == pytest.approx(tan_phi(stress), rel=1e-12)


def test_the_tests_of_the_thesis():
    """Table 5-1: the fitted law is within 5 % of each mean, 3.6 % on average; much more than they scatter."""
    errors = [float(tan_phi(stress)) / mean - 1.0 for stress, (mean, _) in TABLE_5_1.items()]
    found = [sliding_friction(stress * KG_PER_CM2) / mean - 1.0 for stress, (mean, _) in TABLE_5_1.items()]
    np.testing.assert_allclose(found, errors, rtol=1e-9)
    np.testing.assert_allclose(100 * np.array(errors), [4.3, 4.8, -2.9, 2.3], atol=0.06)
    assert np.mean(np.abs(errors)) == pytest.approx(0.036, abs=5e-4)


def test_low_stress_is_safe():
    """The angle ends at 70°, down to stresses that no number holds; at rest nothing is carried."""
    for stress in (1e-20, 1e-200, 1e-290):
        assert 0.0 <= sliding_friction(stress) <= np.tan(np.radians(70.0)) * (1 + 1e-12)
    low = BARTON.table.low_stress
    assert tan_phi(low / KG_PER_CM2) == pytest.approx(np.tan(np.radians(70.0)))
    assert sliding_friction(0.5 * low) == pytest.approx(np.tan(np.radians(70.0)), rel=1e-12)
    assert along([(0.0, 1e-3)]).shear[-1, 0] == 0.0


def test_above_jcs_the_angle_is_the_residual_one():
    assert sliding_friction(3.0 * PEPERINO["jcs"]) == pytest.approx(np.tan(np.radians(23.14)), rel=1e-12)


def test_limits_of_the_angle():
    steep = joint("barton", jrc=20.0, jcs=100.0e6, residual_angle_deg=30.0, largest_angle_deg=60.0)
    for stress, angle in ((1.0, 60.0), (100.0e6 * 10**-1.5, 60.0), (100.0e6 / 10, 50.0), (200e6, 30.0)):
        assert sliding_friction(stress, steep) == pytest.approx(np.tan(np.radians(angle)), rel=1e-9)
    smooth = joint("barton", jrc=0.0, jcs=100.0e6, residual_angle_deg=30.0)
    assert sliding_friction(1e3, smooth) == pytest.approx(np.tan(np.radians(30.0)), rel=1e-12)


def test_the_limit_changes_with_the_normal_force_on_the_way():
    """Pressed four times as hard while sliding the friction falls; unloaded and reversed it is that of the stress."""
    gap = -0.2 * KG_PER_CM2 / KN
    path = ramp((gap, 0.0), (gap, 2e-4), (4 * gap, 4e-4), (4 * gap, -4e-4), (gap / 4, -8e-4), n=200)
    done = along(path)
    stress = np.maximum(-done.path[:, 0], 0.0) * KN
    limit = tan_phi(stress / KG_PER_CM2) * stress * AREA
    assert np.all(np.abs(done.shear[:, 0]) <= limit * (1 + 1e-12))
    sliding = np.diff(done.slip) > 0.0
    np.testing.assert_allclose(np.abs(done.shear[1:, 0])[sliding], limit[1:][sliding], rtol=1e-10)
    assert sliding.sum() > 500
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)
    space = along(np.column_stack([path[:, 0], 0.6 * path[:, 1], 0.8 * path[:, 1]]))
    np.testing.assert_allclose(space.shear, done.shear * [0.6, 0.8], rtol=1e-9, atol=1e-9 * limit.max())


def test_shear_limit_is_the_law():
    columns = np.tile(BARTON.law.columns(BARTON.table, KN), (5, 1))
    stress = np.array([0.0, 0.5 * BARTON.table.low_stress, 1e4, 1e6, 1e8])
    limit = BARTON.law.shear_limit(columns, stress * AREA, np.zeros((5, 0)), np.full(5, KN * AREA))
    expected = [0.0, *(sliding_friction(s) * s * AREA for s in stress[1:])]
    np.testing.assert_allclose(limit, expected, rtol=1e-9)


@pytest.mark.parametrize(
    "bad", [{"largest_angle_deg": 20.0}, {"jrc": -1.0}, {"jcs": 0.0}, {"residual_angle_deg": 95.0}]
)
def test_wrong_values(bad):
    with pytest.raises(ValidationError):
        joint("barton", **PEPERINO | bad)
