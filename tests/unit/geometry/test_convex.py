"""Distance of a point from a convex body, and what two bodies have in common: against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.core.geometry.convex import common, distance

SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
coordinates = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
sides = st.tuples(*[st.floats(0.1, 2.0)] * 3)


@given(point=coordinates, half=sides, far=st.floats(-1e4, 1e4))
@settings(deadline=None, max_examples=60)
def test_distance_from_a_box(point, half, far):
    point, half = np.array(point), np.array(half)
    exact = np.linalg.norm(np.maximum(np.abs(point) - half, 0.0))
    assert distance(SIGNS * half + far, point + far) == pytest.approx(exact, abs=1e-10 + 1e-14 * abs(far))


def test_distance_of_corners_symmetric_to_the_last_digits():
    half, point, far = (
        np.array([0.5678161418360557, 0.8440934138897425, 1.7622269363935776]),
        1.0281302278171682,
        8194.0,
    )
    found = distance(SIGNS * half + far, np.array([-point, 0.0, 0.0]) + far)
    assert found == pytest.approx(point - half[0], abs=1e-10)


def test_distance_in_the_plane():
    triangle = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])
    assert distance(triangle, np.array([4.0, 3.0])) == pytest.approx(12.0 / 5.0)
    assert distance(triangle, np.array([1.0, 1.0])) == 0.0
    assert distance(triangle, np.array([-3.0, -4.0])) == pytest.approx(5.0)
    assert distance(triangle, np.array([2.0, -1.0])) == pytest.approx(1.0)


@given(point=coordinates, half=sides, far=st.floats(-1e4, 1e4))
@settings(deadline=None, max_examples=60)
def test_distance_from_a_rectangle(point, half, far):
    """Its corners in no order."""
    point, half = np.array(point[:2]), np.array(half[:2])
    exact = np.linalg.norm(np.maximum(np.abs(point) - half, 0.0))
    assert distance(SIGNS[:4, 1:] * half + far, point + far) == pytest.approx(exact, abs=1e-10 + 1e-14 * abs(far))


def box_planes(middle, half):
    normals = np.vstack([np.eye(3), -np.eye(3)])
    return normals, np.concatenate([middle + half, half - middle])


@given(shift=coordinates, first=sides, second=sides)
@settings(deadline=None, max_examples=60)
def test_what_two_boxes_have_in_common(shift, first, second):
    shift, first, second = np.array(shift), np.array(first), np.array(second)
    low, high = np.maximum(-first, shift - second), np.minimum(first, shift + second)
    normals, offsets = map(np.concatenate, zip(box_planes(0.0, first), box_planes(shift, second), strict=True))
    found = common(normals, offsets)
    if (high - low).min() < 1e-6:
        assert found is None or found.volume < 1e-4
        return
    assert found is not None
    assert found.volume == pytest.approx(np.prod(high - low), rel=1e-9)
    assert found.centroid == pytest.approx((low + high) / 2.0, abs=1e-9)


def test_what_a_cube_and_an_octahedron_have_in_common():
    """|x| + |y| + |z| <= 3/4 in a cube of side 1 leaves a tetrahedron out at each corner, cut by the cube."""
    octahedron = SIGNS / np.sqrt(3.0), np.full(8, 0.75 / np.sqrt(3.0))
    normals, offsets = map(np.concatenate, zip(box_planes(0.0, np.full(3, 0.5)), octahedron, strict=True))
    found = common(normals, offsets)
    assert found is not None
    assert found.volume == pytest.approx(1.0 - 8.0 * (0.75**3 - 3.0 * 0.25**3) / 6.0, rel=1e-12)
