"""Polygons: invariance, cutting and summing, closed forms, and messages that teach."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dem_cli.core.geometry import polygon

ANGLES = st.floats(-math.pi, math.pi)
SHIFTS = st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
SIZES = st.floats(1e-3, 1e3)


@st.composite
def convex_polygons(draw, least=3, most=9):
    """Corners on an ellipse at angles well apart: strictly convex, counter-clockwise."""
    n = draw(st.integers(least, most))
    gaps = np.array(draw(st.lists(st.floats(0.2, 1.0), min_size=n, max_size=n)))
    angles = 2.0 * math.pi * np.cumsum(gaps) / gaps.sum()
    a, b = draw(SIZES), draw(st.floats(0.1, 1.0))
    return np.stack([a * np.cos(angles), a * b * np.sin(angles)], axis=1)


@given(convex_polygons(), ANGLES, SHIFTS)
def test_moving_changes_only_the_place(corners, angle, shift):
    before, after = polygon.properties(corners), polygon.properties(polygon.moved(corners, angle, shift))
    scale = polygon.size(corners)
    far = math.hypot(*shift) / scale + 1.0  # coordinates far away hold fewer digits of the shape
    tolerance = 1e-14 * far + 1e-12
    assert after.area == pytest.approx(before.area, rel=100 * tolerance)
    assert after.polar_moment == pytest.approx(before.polar_moment, rel=1000 * tolerance)
    expected = polygon.moved(before.centroid[None], angle, shift)[0]
    assert after.centroid == pytest.approx(expected, abs=100 * tolerance * scale)


@given(convex_polygons(), SIZES)
def test_scaling(corners, factor):
    before, after = polygon.properties(corners), polygon.properties(factor * corners)
    assert after.area == pytest.approx(factor**2 * before.area, rel=1e-12)
    assert after.polar_moment == pytest.approx(factor**4 * before.polar_moment, rel=1e-12)


@given(convex_polygons(least=4), st.data())
def test_cut_in_two_and_summed(corners, data):
    n = len(corners)
    i = data.draw(st.integers(0, n - 3))
    j = data.draw(st.integers(i + 2, n - 1 if i else n - 2))
    halves = [corners[i : j + 1], np.concatenate([corners[j:], corners[: i + 1]])]
    starts = np.array([0, len(halves[0]), len(halves[0]) + len(halves[1])])
    parts = polygon.properties_of_all(np.concatenate(halves), starts)
    whole, summed = polygon.properties(corners), polygon.compound(parts, np.array([0, 0]), 1)
    scale = polygon.size(corners)
    assert summed.area[0] == pytest.approx(whole.area, rel=1e-12)
    assert summed.centroid[0] == pytest.approx(whole.centroid, abs=1e-12 * scale)
    assert summed.polar_moment[0] == pytest.approx(whole.polar_moment, rel=1e-11)


@given(SIZES, SIZES, SHIFTS)
def test_rectangle(width, height, corner):
    shape = polygon.rectangle(0.0, 0.0, width, height)
    assert polygon.area(shape) == pytest.approx(width * height, rel=1e-14)
    assert polygon.centroid(shape) == pytest.approx([width / 2, height / 2], rel=1e-13)
    assert polygon.polar_moment(shape) == pytest.approx(width * height * (width**2 + height**2) / 12, rel=1e-13)


@given(st.integers(3, 12), SIZES)
def test_regular_polygon(n, radius):
    angles = 2.0 * math.pi * np.arange(n) / n
    shape = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    area = n / 2 * radius**2 * math.sin(2 * math.pi / n)
    assert polygon.area(shape) == pytest.approx(area, rel=1e-12)
    assert polygon.polar_moment(shape) == pytest.approx(
        area * radius**2 / 6 * (2 + math.cos(2 * math.pi / n)), rel=1e-12
    )


@given(convex_polygons())
def test_many_at_once_are_the_same_as_one_by_one(corners):
    shapes = [corners, polygon.rectangle(5.0, 1.0, 2.0, 3.0), 2.0 * corners + 7.0]
    starts = np.concatenate([[0], np.cumsum([len(shape) for shape in shapes])])
    many = polygon.properties_of_all(np.concatenate(shapes), starts)
    for k, shape in enumerate(shapes):
        one = polygon.properties(shape)
        assert many.area[k] == one.area
        assert (many.centroid[k] == one.centroid).all()
        assert many.polar_moment[k] == one.polar_moment
    assert polygon.are_convex(np.concatenate(shapes), starts).all()


@given(convex_polygons())
def test_clockwise_has_negative_area_and_the_same_centroid(corners):
    back = polygon.properties(corners[::-1])
    assert back.area == pytest.approx(-polygon.area(corners), rel=1e-12)
    assert polygon.signed_area(corners[::-1]) == back.area
    assert back.centroid == pytest.approx(polygon.centroid(corners), abs=1e-12 * polygon.size(corners))


@given(convex_polygons(), st.randoms(use_true_random=False))
def test_any_order_becomes_counter_clockwise(corners, random):
    shuffled = corners.tolist()
    random.shuffle(shuffled)
    found = polygon.in_order(shuffled)
    assert sorted(found.tolist()) == sorted(corners.tolist())
    assert polygon.is_convex(found)
    assert found[0, 1] == corners[:, 1].min()
    assert polygon.area(found) == pytest.approx(polygon.area(corners), rel=1e-12)


@given(convex_polygons(), st.data())
def test_points_on_edges_are_left_out(corners, data):
    k = data.draw(st.integers(0, len(corners) - 1))
    t = data.draw(st.floats(0.1, 0.9))
    between = corners[k] + t * (corners[(k + 1) % len(corners)] - corners[k])
    more = np.vstack([between, corners])
    assert (polygon.in_order(more) == polygon.in_order(corners)).all()
    longer = np.insert(corners, k + 1, between, axis=0)
    assert (polygon.simplified(longer) == corners).all()
    assert (polygon.simplified(np.repeat(longer, 2, axis=0)) == corners).all()
    assert polygon.is_convex(longer)


def test_not_convex():
    assert not polygon.is_convex([[0, 0], [2, 0], [0.5, 0.5], [0, 2]])  # dent
    assert not polygon.is_convex([[0, 0], [0, 1], [1, 1], [1, 0]])  # clockwise
    assert not polygon.is_convex([[0, 0], [1, 1], [1, 0], [0, 1]])  # crossed
    assert not polygon.is_convex([[0, 0], [1, 0], [2, 0]])  # flat
    assert not polygon.is_convex([[0, 0], [1, 0]])
    star = [[math.cos(4 * math.pi * k / 5), math.sin(4 * math.pi * k / 5)] for k in range(5)]
    assert not polygon.is_convex(star)  # twice around


BAD = {
    "a polygon needs at least 3 corners, found 2": [[0, 0], [1, 0]],
    "each corner is a pair [x, y]": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    "corners 2 and 4 are the same point, [1, 0]; give each once": [[0, 0], [1, 0], [1, 1], [1, 0]],
    "the corners lie on one line: the polygon has no area": [[0, 0], [1, 1], [2, 2]],
    "corner 3, [0.5, 0.5], lies inside the polygon of the others; a block must be convex: "
    "split a concave one into convex parts": [[0, 0], [2, 0], [0.5, 0.5], [0, 2]],
}


@pytest.mark.parametrize(("message", "points"), BAD.items())
def test_what_is_wrong_with_the_corners(message, points):
    with pytest.raises(ValueError) as error:
        polygon.in_order(points)
    assert str(error.value) == message


def test_compound_l_shape():
    parts = [polygon.rectangle(0, 0, 3, 1), polygon.rectangle(0, 1, 1, 2)]
    whole = polygon.compound(polygon.properties_of_all(np.concatenate(parts), np.array([0, 4, 8])), np.array([0, 0]), 1)
    corners = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]
    direct = polygon.properties(np.array(corners, float))
    assert whole.area[0] == pytest.approx(5.0)
    assert whole.centroid[0] == pytest.approx(direct.centroid)
    assert whole.polar_moment[0] == pytest.approx(direct.polar_moment)
