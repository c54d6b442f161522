"""Pieces of surfaces against shapely: what is cut off, what is left of one under others, integrals, shadows."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, QhullError

from dem_cli.core.geometry import surface_pieces

COORDINATE = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
POINTS = st.lists(st.tuples(COORDINATE, COORDINATE), min_size=3, max_size=8, unique=True)
TURN = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0  # a rotation
SHIFT = np.array([5.0, -3.0, 0.7])


def convex(points) -> np.ndarray:
    """Corners of the hull, counter-clockwise; too thin ones are not looked at."""
    try:
        hull = ConvexHull(np.array(points))
    except QhullError:
        assume(False)
    assume(hull.volume > 0.02)
    return hull.points[hull.vertices]


def placed(flat: np.ndarray) -> np.ndarray:
    """A polygon of the plane in space."""
    return np.column_stack([flat, np.zeros(len(flat))]) @ TURN.T + SHIFT


def sides(flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half-spaces through the sides of a polygon in space."""
    along = np.roll(flat, -1, axis=0) - flat
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    in_space = np.column_stack([normals, np.zeros(len(flat))]) @ TURN.T
    return in_space, (in_space * placed(flat)).sum(axis=1)


@settings(max_examples=60, deadline=None)
@given(POINTS, POINTS)
def test_what_is_inside_and_outside_of_another(a, b):
    a, b = convex(a), convex(b)
    piece, halfspaces = placed(a), sides(b)
    common = shapely.Polygon(a).intersection(shapely.Polygon(b))
    assert surface_pieces.measure(surface_pieces.inside(piece, *halfspaces)) == pytest.approx(common.area, abs=1e-12)
    rest = [surface_pieces.measure(one) for one in surface_pieces.outside(piece, *halfspaces)]
    assert sum(rest) == pytest.approx(shapely.Polygon(a).area - common.area, abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(POINTS)
def test_integrals_of_second_degree_are_exact(a):
    """Of x y: shoelace of second order; in space of the same function of places turned back."""
    a = convex(a)
    (x, y), (u, v) = a.T, np.roll(a, -1, axis=0).T
    exact = ((x * v - u * y) * (x * v + 2 * x * y + 2 * u * v + u * y)).sum() / 24.0
    points, weights = surface_pieces.quadrature(placed(a))
    flat = (points - SHIFT) @ TURN
    assert weights @ (flat[:, 0] * flat[:, 1]) == pytest.approx(exact, abs=1e-13)
    assert weights.sum() == pytest.approx(shapely.Polygon(a).area, rel=1e-13)


def test_a_segment():
    piece = np.array([[0.0, 0.0], [3.0, 4.0]])
    points, weights = surface_pieces.quadrature(piece)
    assert weights @ points[:, 1] ** 3 == pytest.approx(5.0 * 4.0**3 / 4, rel=1e-14)
    beyond = list(surface_pieces.outside(piece, np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([2.0, -1.0])))
    assert [surface_pieces.measure(one) for one in beyond] == pytest.approx([5.0 / 3.0] * 2)
    assert surface_pieces.measure(surface_pieces.kept(piece, np.array([0.0, 1.0]), -1.0)) == 0.0


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(COORDINATE, COORDINATE, COORDINATE), min_size=5, max_size=10, unique=True),
       st.tuples(COORDINATE, COORDINATE, COORDINATE))  # fmt: skip
def test_a_point_is_in_the_shadow_where_a_line_upwards_meets_the_body(corners, point):
    try:
        hull = ConvexHull(np.array(corners))
    except QhullError:
        assume(False)
    normals, offsets = hull.equations[:, :3], -hull.equations[:, 3]
    dark = surface_pieces.shadow(normals, offsets)
    depths = dark[0] @ point - dark[1]
    assume(np.abs(depths).min() > 1e-6)
    x, y, z = point  # heights at which the line through the point is in the body
    rates, rest = normals[:, 2], offsets - normals[:, :2] @ [x, y]
    level = np.abs(rates) < 1e-12
    low = max((rest[~level] / rates[~level])[rates[~level] < 0.0], default=-np.inf)
    high = min((rest[~level] / rates[~level])[rates[~level] > 0.0], default=np.inf)
    met = (rest[level] >= 0.0).all() and low <= high and high >= z
    assert (depths.max() <= 0.0) == met


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_piece_on_a_plane_is_not_outside_of_it(side):
    """Of a square in one of the faces of a box, all lies in the box: none of it is left, and nothing twice."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    normals, offsets = sides(corners * 2.0 - 0.5)
    plane = side * TURN[:, 2]
    normals, offsets = np.vstack([plane, normals]), np.append(plane @ placed(corners)[0], offsets)
    assert list(surface_pieces.outside(placed(corners), normals, offsets)) == []
    half = placed(corners + np.array([1.0, 0.0]))  # beyond x = 1.5
    (left,) = surface_pieces.outside(half, normals, offsets)
    assert surface_pieces.measure(left) == pytest.approx(0.5)


@settings(max_examples=60, deadline=None)
@given(POINTS, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.02, 1.5))
def test_what_of_a_polygon_lies_over_a_disc(points, x, y, radius):
    """Area and centroid beside those of a polygon of 4,000 sides, on a slope of 1 in 2 and 1 in 4."""
    flat = convex(points)
    disc = shapely.Point(x, y).buffer(radius, quad_segs=1000)
    common = shapely.Polygon(flat).intersection(disc)
    piece = np.column_stack([flat, 1.0 + flat @ [0.5, -0.25]])
    area, place = surface_pieces.over_disc(piece, np.array([x, y]), radius)
    assert area == pytest.approx(common.area, rel=2e-6, abs=2e-6 * radius**2)
    if common.area > 0.01 * radius**2:
        assert place[:2] == pytest.approx([common.centroid.x, common.centroid.y], abs=1e-5)
        assert place[2] == pytest.approx(1.0 + place[:2] @ [0.5, -0.25], abs=1e-12)


def test_a_disc_cut_by_a_chord():
    """Segment of a circle: r² (φ − sin φ) / 2, centroid 4 r sin³(φ/2) / 3 (φ − sin φ) from the centre."""
    square = np.array([[1.0, -9.0, 2.0], [9.0, -9.0, 2.0], [9.0, 9.0, 2.0], [1.0, 9.0, 2.0]])
    area, place = surface_pieces.over_disc(square, np.zeros(2), 2.0)
    angle = 2.0 * np.pi / 3.0
    assert area == pytest.approx(2.0 * (angle - np.sin(angle)), rel=1e-14)
    assert place == pytest.approx([8.0 * np.sin(np.pi / 3) ** 3 / 3.0 / (angle - np.sin(angle)), 0.0, 2.0], rel=1e-14)
    area, place = surface_pieces.over_disc(square, np.array([5.0, 1.0]), 2.0)
    assert [area, *place] == pytest.approx([4.0 * np.pi, 5.0, 1.0, 2.0], rel=1e-14)
