"""Clearance of convex polygons: exact in rational numbers, and what it promises: lifted by it, they touch."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.clearance import clearances

PLACES = st.tuples(st.floats(-2.0, 2.0), st.floats(-3.0, 3.0))


@st.composite
def convex_polygons(draw):
    """Corners on an ellipse somewhere, counter-clockwise; sometimes a box, whose sides are upright."""
    a, b = draw(st.floats(0.1, 3.0)), draw(st.floats(0.1, 3.0))
    if draw(st.booleans()):
        return polygon.rectangle(*draw(PLACES), a, b)
    n = draw(st.integers(3, 8))
    gaps = np.array(draw(st.lists(st.floats(0.2, 1.0), min_size=n, max_size=n)))
    angles = draw(st.floats(0.0, 6.0)) + 2.0 * math.pi * np.cumsum(gaps) / gaps.sum()
    return np.stack([a * np.cos(angles), b * np.sin(angles)], axis=1) + draw(PLACES)


def clearance(upper, lower, narrow=0.0):
    starts = np.array([0, len(upper), len(upper) + len(lower)])
    return float(clearances(np.array([0]), np.array([1]), np.concatenate([upper, lower]), starts, narrow)[0])


def crossing(corners, x):
    """Where the vertical line at x leaves a polygon: least and greatest y, in rational numbers; None outside."""
    heights = []
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1]):
        if min(x0, x1) <= x <= max(x0, x1):
            heights += [y0, y1] if x0 == x1 else [y0 + (x - x0) * (y1 - y0) / (x1 - x0)]
    return (min(heights), max(heights)) if heights else None


def separation(p, q):
    """Largest distance of two convex polygons along the normal of an edge; negative where they overlap."""
    best = -math.inf
    for one, other in ((p, q), (q, p)):
        edges = np.roll(one, -1, axis=0) - one
        normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
        best = max(best, (((other[None] - one[:, None]) * normals[:, None]).sum(axis=2).min(axis=1)).max())
    return best


@given(convex_polygons(), convex_polygons(), st.lists(st.floats(0.0, 1.0), max_size=20))
def test_exact_in_rational_numbers(upper, lower, shares):
    left, right = max(upper[:, 0].min(), lower[:, 0].min()), min(upper[:, 0].max(), lower[:, 0].max())
    found = clearance(upper, lower)
    if not left < right:
        assert found == math.inf
        return
    exact = [[(Fraction(x), Fraction(y)) for x, y in corners.tolist()] for corners in (upper, lower)]
    places = [Fraction(x) for x in (*upper[:, 0].tolist(), *lower[:, 0].tolist()) if left <= x <= right]
    gaps = [crossing(exact[0], x)[0] - crossing(exact[1], x)[1] for x in places]
    steepest = max(abs(dy / dx) for c in (upper, lower) for dx, dy in np.roll(c, -1, axis=0) - c if dx) + 1.0
    assert found == pytest.approx(float(min(gaps)), abs=1e-14 * steepest)
    for share in shares:  # nowhere else are they closer
        x = Fraction(left) + Fraction(share) * (Fraction(right) - Fraction(left))
        assert crossing(exact[0], x)[0] - crossing(exact[1], x)[1] >= min(gaps)


@given(convex_polygons(), convex_polygons())
def test_lifted_by_it_they_touch(upper, lower):
    common = min(upper[:, 0].max(), lower[:, 0].max()) - max(upper[:, 0].min(), lower[:, 0].min())
    assume(common > 1e-3)
    resting = upper - [0.0, clearance(upper, lower)]
    assert separation(resting, lower) == pytest.approx(0.0, abs=1e-9)
    assert separation(polygon.moved(resting, 0.0, (0.0, 0.01)), lower) > 0.0
    assert separation(polygon.moved(resting, 0.0, (0.0, -0.01)), lower) < 0.0


def test_boxes_are_compared_to_the_last_digit():
    low, high = polygon.rectangle(0.1, 0.2, 0.7, 0.3), polygon.rectangle(0.3, 0.2 + 0.3, 0.7, 0.1)
    assert clearance(high, low) == 0.0
    assert clearance(polygon.moved(high, 0.0, (0.0, 0.125)), low) == (0.2 + 0.3 + 0.125) - (0.2 + 0.3)
    assert clearance(low, high) == 0.2 - (0.2 + 0.3 + 0.1)


def test_blocks_side_by_side_have_none():
    left, right = polygon.rectangle(0.0, 0.0, 1.0, 1.0), polygon.rectangle(1.0, 0.0, 1.0, 1.0)
    assert clearance(left, right) == clearance(right, left) == math.inf
    leaning = right - [1e-10, 0.0]
    assert clearance(leaning, left) == -1.0
    assert clearance(leaning, left, narrow=1e-9) == math.inf


def test_many_pairs_at_once_and_polygons_of_several_sizes():
    shapes = [polygon.rectangle(0.0, 0.0, 2.0, 1.0), np.array([[0.0, 3.0], [1.0, 2.0], [2.0, 3.0]])]
    shapes.append(np.array([[0.5, 1.0], [1.5, 1.0], [1.5, 1.5], [1.0, 1.75], [0.5, 1.5]]))
    starts = np.concatenate([[0], np.cumsum([len(shape) for shape in shapes])])
    upper, lower = np.array([1, 2, 1, 0]), np.array([0, 0, 2, 1])
    found = clearances(upper, lower, np.concatenate(shapes), starts)
    assert found.tolist() == [1.0, 0.0, 0.25, -3.0]
    assert clearances(upper[:0], lower[:0], np.concatenate(shapes), starts).shape == (0,)
