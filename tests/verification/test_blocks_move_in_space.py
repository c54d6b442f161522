"""Blocks that move in space: exact motions, and the books of energy; gates that guard, in a second or two each."""

from __future__ import annotations

import math

import pytest
from studies.motion_in_space import single, structures
from studies.motion_in_space.study import error

DASHPOTS = {"contact_fraction": 0.35}


@pytest.mark.parametrize("name", single.FEET)
def test_a_prism_lands_as_a_rigid_body_about_its_edge(name):
    """Straight or oblique: joints of X = 1e5 and the step leave 1e-4; energy closes as impacts allow at this step."""
    found = single.rocking(name)
    assert error(found) == pytest.approx(0.0, abs=1e-4)
    assert found["book"] < 1.5e-2
    assert found["moved"] < 1e-4


def test_stiffer_joints_land_nearer_to_the_exact_time():
    """The error falls with the penetration of the edge."""
    errors = [abs(error(single.rocking("box", stiffness))) for stiffness in (1e4, 1e6)]
    assert errors[1] < 0.2 * errors[0]


def test_a_box_on_its_corner():
    found = single.box_on_corner()
    assert error(found) == pytest.approx(0.0, abs=1e-4)
    assert found["moved"] < 1e-4


@pytest.mark.parametrize("azimuth", [0.0, 30.0])
def test_sliding_in_any_direction(azimuth):
    distance, direction = single.sliding(azimuth)
    assert error(distance) == pytest.approx(0.0, abs=1e-4)
    assert direction["found"] == pytest.approx(azimuth, abs=2e-4)


def test_four_corners_brake_a_spin():
    assert error(single.spinning()) == pytest.approx(0.0, abs=1e-4)


def test_sliding_with_spin_is_the_differential_equation_of_four_corners():
    x, y, angle = single.sliding_and_spinning()
    assert error(x) == pytest.approx(0.0, abs=2e-4)
    assert error(y) == pytest.approx(0.0, abs=2e-4)
    assert error(angle) == pytest.approx(0.0, abs=1e-3)


def test_a_bounce_takes_as_much_spin_as_its_impulse():
    height, spin = single.bouncing(0.1)
    assert error(height) == pytest.approx(0.0, abs=2e-4)
    assert error(spin) == pytest.approx(0.0, abs=1e-5)


def test_a_beam_rolls_on_a_ridge_without_making_energy():
    coarse, fine = (single.beam_on_ridge(margin) for margin in (0.1, 0.025))
    assert max(coarse["moved"], fine["moved"]) < 1e-12
    assert fine["book"] < 0.2 * coarse["book"]


def test_a_wall_collapses_and_its_books_close():
    found = structures.wall_collapses(DASHPOTS)
    assert found["kinetic"] > 5e3  # it falls
    assert found["book"] < 5e-3
    assert abs(found["net"]) < 1e-3
    assert found["found"] < 10.0  # mm of 200


def test_column_of_drums_under_three_components():
    found = structures.column_of_drums(duration=4.0)
    assert 0.05 < found["found"] < 1.0
    assert found["book"] < 1e-2
    assert found["moved"] < 2e-2


def test_blocks_that_meet_along_an_edge_make_no_energy():
    """Edges that are nearly parallel cross anywhere: blocks that meet along one are held by their faces alone."""
    found = structures.corner_opens()
    assert found["found"] > 0.05  # it opens
    assert found["book"] < 5e-3
    assert found["moved"] < 5e-2


def test_a_prism_rocks_under_two_components():
    found = structures.rocks_two_ways()
    assert 0.05 < found["found"] < 0.5
    assert found["book"] < 5e-3


def test_rows_of_a_barrel_sink_as_the_arch_of_the_plane():
    found = structures.arch_spreads()
    assert error(found) == pytest.approx(0.0, abs=1e-3)
    assert found["book"] < 1e-4


def test_a_small_block_lands_on_its_corner():
    """On a base whose faces are a hundred times its own."""
    found = single.cube_on_corner(DASHPOTS)
    assert error(found) == pytest.approx(0.0, abs=1e-3)
    assert found["book"] < 5e-3
    assert found["moved"] < 1e-3


def test_oracle_of_the_spin():
    """Half of the spin of a pad is gone at 1 − √½ of the way: a check of the oracle, not of dem."""
    whole, half = (single.PAD.stops((0.0, 0.0), spin) for spin in (3.0, 3.0 * math.sqrt(0.5)))
    assert half.angle == pytest.approx(0.5 * whole.angle, rel=1e-4)
