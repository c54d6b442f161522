"""Joints with less strength stay joints of their law."""

from __future__ import annotations

import math

import pytest

from dem_cli.core.laws.barton import BartonJoint
from dem_cli.core.laws.coulomb import CoulombJoint
from dem_cli.core.laws.fracture import FractureJoint
from dem_cli.core.laws.mohr_coulomb import MohrCoulombJoint
from dem_cli.core.laws.rate import RateJoint
from dem_cli.core.laws.registry import LAWS
from dem_cli.core.laws.strength import KEYS, reduced, strengths

ALL = tuple(KEYS)
MORTAR = MohrCoulombJoint(
    friction=0.6, cohesion=6e4, tension=5e4, cohesion_residual=1e4, friction_residual=0.4, dilation_deg=15.0
)


def test_friction_as_coefficient_and_as_angle():
    assert reduced(CoulombJoint(friction=0.6), 2.0, ALL).coefficient == pytest.approx(0.3)
    angle = reduced(CoulombJoint(friction_angle_deg=45.0), 4.0, ALL)
    assert angle.coefficient == pytest.approx(0.25)
    assert angle.friction_angle_deg is None


def test_all_strengths_of_a_bond():
    weak = reduced(MORTAR, 2.0, ALL)
    assert strengths(weak) == pytest.approx({"friction": 0.3, "cohesion": 3e4, "tension": 2.5e4})
    assert (weak.residual, weak.cohesion_residual) == pytest.approx((0.2, 5e3))
    assert weak.dilation_deg == pytest.approx(math.degrees(math.atan(0.2)))  # else it would dilate more than it rubs
    assert reduced(MORTAR, 1.0, ALL) == MORTAR


def test_tension_ends_at_the_tip_of_the_cone():
    assert reduced(MORTAR, 2.0, ["cohesion"]).tension == pytest.approx(3e4 / 0.6)
    assert reduced(MORTAR, 0.5, ["friction"]).tension == pytest.approx(6e4 / 1.2)
    assert reduced(MORTAR, 2.0, ["friction"]).tension == 5e4


def test_what_else_a_law_has_stays():
    joint = FractureJoint(
        friction=0.7, cohesion=3e5, tension=2e5, fracture_energy_tension=20.0, fracture_energy_shear=100.0
    )
    weak = reduced(joint, 3.0, ALL)
    assert (weak.fracture_energy_tension, weak.fracture_energy_shear) == (20.0, 100.0)
    assert weak.tension == pytest.approx(2e5 / 3.0)
    assert reduced(RateJoint(friction=0.6, friction_dynamic=0.5, velocity=0.1), 2.0, ALL).friction_dynamic == 0.25


def test_every_law_but_two_has_strengths():
    without = {name for name, law in LAWS.items() if not {"friction", "cohesion"} & set(law.parameters.declared)}
    assert without == {"barton", "elastic"}
    assert strengths(BartonJoint(jrc=5.0, jcs=1e8, residual_angle_deg=30.0)) == {}
