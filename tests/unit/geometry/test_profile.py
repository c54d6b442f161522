"""Profiles of joints: the angles of the thesis, and what is true of every convex polygon on a flat surface."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracle.rolling_column import fall, foot

from dem_cli.core.geometry.profile import angles, polygon, regular, slopes

lengths = st.lists(st.floats(0.01, 1.0), min_size=2, max_size=12)
apertures = st.floats(1e-7, 1e-2)


def test_three_sides_of_the_thesis():
    """16, 8 and 16 mm with d = 0.1 mm: 0.00625 rad between the sides (7.4.1)."""
    places, rises = polygon([0.016, 0.008, 0.016], 1e-4)
    assert places == pytest.approx([0.0, 0.016, 0.024, 0.04])
    assert rises == pytest.approx([1e-4, 0.0, 0.0, 1e-4], abs=1e-18)
    assert angles(places, rises) == pytest.approx([0.00625, 0.00625], rel=1e-12)


def test_five_sides_of_the_thesis():
    """5 × 0.2 m with d = 10 mm: 1/60 rad between the sides, and 3 φ at the end of the joint (7.3.3)."""
    places, rises = polygon([0.2] * 5, 0.01)
    assert angles(places, rises) == pytest.approx([1 / 60] * 4, rel=1e-12)
    assert rises == pytest.approx([0.01, 0.2 / 60, 0.0, 0.0, 0.2 / 60, 0.01], abs=1e-17)


def test_an_even_number_of_sides_starts_on_the_one_before_the_middle():
    places, rises = polygon([0.25] * 4, 0.01)
    assert np.flatnonzero(rises == 0.0).tolist() == [1, 2]
    assert places[2] == 0.5


@pytest.mark.parametrize("sides", range(2, 30))
def test_the_middle_is_over_the_side_at_rest(sides):
    """Also where rounding puts the vertex in the middle a digit beside it."""
    for total in (1.0, 0.04, 7.3):
        _, rises = polygon(np.full(sides, total / sides), 1e-4)
        assert np.flatnonzero(rises == 0.0).tolist() == [(sides - 1) // 2, (sides - 1) // 2 + 1]


@given(lengths, apertures)
def test_convex_and_resting_on_one_side(sides, aperture):
    places, rises = polygon(sides, aperture)
    assert np.diff(places) == pytest.approx(sides)
    assert (rises >= 0.0).all()
    assert (rises == 0.0).sum() == 2
    turns = angles(places, rises)
    assert (turns > 0.0).all()
    touching = np.flatnonzero(rises == 0.0)
    assert places[touching[0]] <= 0.5 * places[-1] * (1 + 1e-9) <= places[touching[1]] * (1 + 1e-8)


@given(lengths, apertures)
def test_aperture_is_the_distance_of_the_parallel_tangent(sides, aperture):
    """Footnote 10 of 7.3.1: chord through the ends, and the line parallel to it through the lowest vertex."""
    places, rises = polygon(sides, aperture)
    chord = rises[0] + (rises[-1] - rises[0]) * places / places[-1]
    assert (chord - rises).max() == pytest.approx(aperture, rel=1e-9)


@given(lengths, apertures)
def test_inscribed_in_a_circle(sides, aperture):
    """Angle between two sides: the same radius everywhere, φ = (l1 + l2) / 2R."""
    places, rises = polygon(sides, aperture)
    radii = (np.array(sides[:-1]) + np.array(sides[1:])) / (2.0 * angles(places, rises))
    assert radii == pytest.approx(radii[0], rel=1e-7)


@given(lengths, apertures, st.floats(0.01, 100.0))
def test_a_magnified_polygon_has_the_same_angles(sides, aperture, scale):
    places, rises = polygon(sides, aperture)
    larger = polygon(np.array(sides) * scale, aperture * scale)
    assert larger[0] == pytest.approx(places * scale)
    assert larger[1] == pytest.approx(rises * scale, abs=1e-12 * aperture * scale)
    assert slopes(*larger) == pytest.approx(slopes(places, rises), rel=1e-6, abs=1e-12)


@given(st.integers(2, 8), st.data())
def test_a_mirrored_polygon_rests_on_the_mirrored_side(half, data):
    """Of an odd number of sides; the middle one is made the longest, so that the middle is inside it."""
    outer = data.draw(st.lists(st.floats(0.01, 0.1), min_size=half, max_size=half))
    sides = [*outer, 2.0, *outer[1:], 0.05]
    places, rises = polygon(sides, 1e-3)
    other = polygon(sides[::-1], 1e-3)
    assert other[0] == pytest.approx(places[-1] - places[::-1], abs=1e-12)
    assert other[1] == pytest.approx(rises[::-1], abs=1e-12)


@pytest.mark.parametrize(
    ("sides", "aperture"), [([0.016, 0.008, 0.016], 1e-4), ([0.2] * 5, 0.01), ([0.3, 0.4, 0.3], 1e-3)]
)
def test_the_parabola_is_as_good_as_the_circle(sides, aperture):
    """Against corners on a true circle, found by bisection: the slope squared is what small angles leave out."""
    places, rises = polygon(sides, aperture)
    exact = foot(sides, aperture)
    error = slopes(places, rises).max() ** 2
    assert places - 0.5 * places[-1] == pytest.approx(exact[:, 0], abs=error * places[-1])
    assert rises == pytest.approx(exact[:, 1], rel=error, abs=1e-9 * aperture)


def test_the_oracle_overturns_a_block_as_the_data_book_says():
    """Rolling of a square block on five sides of 0.2 m with d = 10 mm, finite rotation: λ3 = 0.95431, u = h tan 2φ."""
    found = fall(1, 1.0, foot([0.2] * 5, 0.01))
    assert found.load == pytest.approx(0.95431, abs=5e-6)
    assert found.top == pytest.approx(0.0333, abs=1.5e-4)


def test_central_side():
    assert regular(3, 0.2) == pytest.approx([0.4, 0.2, 0.4])
    assert regular(5) == pytest.approx([0.2] * 5)
    with pytest.raises(ValueError, match="middle"):
        regular(4, 0.2)


@pytest.mark.parametrize(("sides", "aperture"), [([1.0], 1e-3), ([], 1e-3), ([1.0, 0.0], 1e-3), ([1.0, 1.0], -1e-3)])
def test_what_is_no_polygon(sides, aperture):
    with pytest.raises(ValueError):
        polygon(sides, aperture)
