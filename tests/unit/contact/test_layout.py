"""Where contact points of joints are: profiles drawn reproducibly, and rules of integration."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from dem_cli.case.tables.declared import table_of
from dem_cli.core.contact.area_rules import AT_CENTRE, ON_DIAGONALS, REACH
from dem_cli.core.contact.layout import PointLayout, draw, lobatto, steepest
from dem_cli.core.geometry.profile import angles
from dem_cli.core.laws.coulomb import CoulombJoint
from dem_cli.core.laws.profile import Profile

keys = st.tuples(st.integers(0, 10**6), st.integers(0, 10**6))


def layout(seed=1, **table) -> PointLayout:
    return PointLayout(**table_of(Profile)(**table).ranges, seed=seed)


def test_shape_c_of_the_thesis():
    """Table 7-2: three sides, the central one a fifth of 40 mm, d = 0.57 % of 17.5 mm."""
    places, gaps, shares = draw(layout(sides=3, central=0.2, aperture=1e-4), (0, 0), 0.04)
    assert places == pytest.approx([0.0, 0.016, 0.024, 0.04])
    assert gaps == pytest.approx([1e-4, 0.0, 0.0, 1e-4], abs=1e-18)
    assert shares.tolist() == [0.5] * 4


def test_lengths_are_the_same_shape_as_their_shares():
    shares = draw(layout(sides=3, central=0.2, aperture=1e-4), (0, 0), 0.04)
    lengths = draw(layout(lengths=[0.016, 0.008, 0.016], aperture=1e-4), (0, 0), 0.04)
    for one, other in zip(shares, lengths, strict=True):
        assert one == pytest.approx(other, abs=1e-15)


@pytest.mark.parametrize(("keep", "aperture", "angle"), [("aperture", 1e-4, 0.0125), ("angle", 5e-5, 0.00625)])
def test_what_stays_on_half_a_block(keep, aperture, angle):
    table = {"sides": 3, "lengths": [0.016, 0.008, 0.016], "aperture": 1e-4, "keep": keep}
    places, gaps, _ = draw(layout(**table), (0, 0), 0.02)
    assert gaps[-1] == pytest.approx(aperture)
    assert angles(places, gaps) == pytest.approx([angle, angle])


RANGES = [
    {"sides": [2, 7], "aperture": [5e-5, 2e-4]},
    {"sides": [3, 7], "central": [0.1, 0.3], "aperture": [5e-5, 2e-4]},
    {"sides": [3, 5], "lengths": [[0.5, 1.5]], "aperture": [5e-5, 2e-4]},
    {"lengths": [[0.01, 0.02], 0.008, [0.01, 0.02]], "aperture": [5e-5, 2e-4]},
]


@pytest.mark.parametrize("table", RANGES)
@given(key=keys, seed=st.integers(0, 1000), length=st.floats(0.01, 10.0))
def test_the_same_key_draws_the_same_profile(table, key, seed, length):
    one = draw(layout(seed=seed, **table), key, length)
    draw(layout(seed=seed, **table), (7, 7), length)
    again = draw(layout(seed=seed, **table), key, length)
    for a, b in zip(one, again, strict=True):
        assert a.tolist() == b.tolist()
    places, gaps, shares = one
    assert places[0] == 0.0
    assert places[-1] == length
    assert (np.diff(places) > 0.0).all()
    assert (gaps >= 0.0).all()
    assert (gaps == 0.0).sum() == 2
    assert len(shares) == len(places) == len(gaps)


@pytest.mark.parametrize("table", RANGES)
def test_joints_differ_and_so_do_seeds(table):
    gaps = [draw(layout(seed=s, **table), (i, 0), 0.04)[1].max() for s in (1, 2) for i in range(20)]
    assert len(set(gaps)) == 40


def test_draws_are_uniform_in_their_ranges():
    """Means and limits of 4,000 draws; standard errors are 0.005 of the ranges."""
    table = {"sides": [2, 6], "lengths": [[0.5, 1.5]], "aperture": [1e-4, 2e-4]}
    drawn = [draw(layout(**table), (i, i % 3), 1.0) for i in range(4000)]
    sides = np.array([len(places) - 1 for places, _, _ in drawn])
    assert np.bincount(sides)[2:] / 4000 == pytest.approx([0.2] * 5, abs=0.03)
    # Aperture: largest distance from the chord through the ends.
    found = np.array([(gaps[0] + (gaps[-1] - gaps[0]) * places - gaps).max() for places, gaps, _ in drawn])
    assert found.mean() == pytest.approx(1.5e-4, rel=0.02)
    assert found.min() >= 1e-4 * (1 - 1e-9)
    assert found.max() <= 2e-4 * (1 + 1e-9)
    odd = [draw(layout(sides=[3, 7], central=0.2, aperture=1e-4), (i, 0), 1.0)[0] for i in range(600)]
    assert {len(places) - 1 for places in odd} == {3, 5, 7}


@pytest.mark.parametrize("n", range(2, 10))
def test_lobatto_rule_is_exact_for_polynomials(n):
    places, weights = lobatto(n)
    assert places[[0, -1]].tolist() == [0.0, 1.0]
    assert (weights > 0.0).all()
    for power in range(2 * n - 2):
        assert (weights * places**power).sum() == pytest.approx(1.0 / (power + 1), rel=1e-12)


def test_three_points_are_simpsons_rule():
    """A plane joint of width b: section modulus b²/6 and moment of inertia b³/12 per depth."""
    b = 0.3
    places, gaps, shares = draw(PointLayout(points=3), (0, 0), b)
    assert shares == pytest.approx([1 / 6, 2 / 3, 1 / 6])
    assert gaps.tolist() == [0.0] * 3
    inertia = (shares * b * (places - b / 2) ** 2).sum()
    assert inertia == pytest.approx(b**3 / 12)
    assert inertia / (b / 2) == pytest.approx(b**2 / 6)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"aperture": 1e-4}, "missing 'sides'"),
        ({"sides": 3, "lengths": [1.0, 2.0], "aperture": 1e-4}, "2 lengths for 3 sides"),
        ({"sides": [3, 4], "lengths": [1.0, 2.0, 1.0], "aperture": 1e-4}, "3 lengths for 3 to 4 sides"),
        ({"sides": 4, "central": 0.2, "aperture": 1e-4}, "4 sides have none in the middle"),
        ({"sides": [3, 4], "central": 0.2, "aperture": 1e-4}, "4 sides have none in the middle"),
        ({"sides": 3, "central": 0.2, "lengths": [1.0, 2.0, 1.0], "aperture": 1e-4}, "has one of them"),
        ({"sides": 3, "aperture": [2e-4, 1e-4]}, "give \\[lowest, highest\\]"),
        ({"sides": [5, 3], "aperture": 1e-4}, "give \\[lowest, highest\\]"),
        ({"sides": 3, "aperture": -1e-4}, "greater than 0"),
        ({"sides": 1, "aperture": 1e-4}, "greater than or equal to 2"),
        ({"sides": 3, "aperture": 1e-4, "keep": "angle"}, "no length to keep it from"),
    ],
)
def test_profiles_that_make_no_sense(table, message):
    with pytest.raises(ValidationError, match=message):
        table_of(Profile)(**table)


def test_points_and_profile_exclude_each_other():
    assert CoulombJoint(friction=0.6).contact_points(2) == 2
    assert CoulombJoint(friction=0.6, points=5).contact_points(2) == 5
    with pytest.raises(ValidationError, match="not allowed with 'profile'"):
        table_of(CoulombJoint)(friction=0.6, points=3, profile={"sides": 3, "aperture": 1e-4})
    with pytest.raises(ValidationError):
        table_of(CoulombJoint)(friction=0.6, points=1)


def test_how_steep_a_profile_may_be():
    """Three sides: φ = d / l1; five equal ones: the outer sides turn by 2 φ, d = 3 φ l."""
    assert steepest(layout(sides=3, central=0.2, aperture=1e-4), 0.04) == pytest.approx(0.00625)
    assert steepest(layout(sides=5, aperture=0.01), 1.0) == pytest.approx(1 / 30)
    assert steepest(PointLayout(points=5), 1.0) == 0.0
    drawn = steepest(layout(sides=3, aperture=[0.0, 0.01]), 1.0)
    assert 0.029 < drawn <= 0.03


def strongest(places: np.ndarray, shares: np.ndarray, pressed: float) -> float:
    """Largest moment of a brittle joint whose points crack one after the other, over that of a continuous one.

    places: from −1 to 1; pressed: normal force over tensile strength times area.
    """
    alive, found = np.ones(len(places), bool), pressed
    while alive.sum() > 1:
        area = shares[alive].sum()
        arms = places - (shares * places)[alive].sum() / area
        last, middle = np.flatnonzero(alive)[-1], places[0] - arms[0]
        inertia = (shares * arms**2)[alive].sum()
        found = max(found, (1.0 + pressed / area) * inertia / arms[last] - pressed * middle)
        alive[last] = False
    left = np.linspace(1e-3, 2.0, 2000)  # uncracked length of a continuous one, of 2
    exact = 0.5 * pressed * (2.0 - left) + left**2 / 12.0 + pressed * left / 6.0
    return found / max(exact.max(), pressed)


@pytest.mark.parametrize(
    ("rule", "alone", "pressed"),
    [(lobatto(2), 3.0, 3.0), (lobatto(5), 1.191, 1.264), (lobatto(9), 1.048, 1.075), (None, 1.0, 1.349)],
    ids=["ends", "five", "nine", "corners, diagonals, centre"],
)
def test_how_long_brittle_joints_hold_on_after_their_first_crack(rule, alone, pressed):
    """Nothing pressed, and pressed by half of the tensile strength; the last are the rows of nine points in space."""
    if rule is None:
        row = 4.0 / 30.0, 2.0 * ON_DIAGONALS, AT_CENTRE
        places, shares = np.array([-1.0, -REACH, 0.0, REACH, 1.0]), np.array([*row, *row[1::-1]])
    else:
        places, shares = 2.0 * rule[0] - 1.0, rule[1]
    assert shares.sum() == pytest.approx(1.0)
    assert strongest(places, shares, 0.0) == pytest.approx(alone, abs=1e-3)
    assert strongest(places, shares, 0.5) == pytest.approx(pressed, abs=1e-3)
