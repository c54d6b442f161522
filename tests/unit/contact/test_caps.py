"""Joints in space that are not plane: polyhedral caps over the outline of a joint."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from dem_cli.case.tables.declared import table_of
from dem_cli.core.contact.caps import cap_over, centroid, half_profile, has_cap, slopes, steepest
from dem_cli.core.contact.layout import PointLayout, draw
from dem_cli.core.laws.profile import Profile

UP = np.array([0.0, 0.0, 1.0])
WIDE, DEEP = 0.4, 0.3  # [m]
RECTANGLE = np.array([[0.0, 0.0, 1.0], [WIDE, 0.0, 1.0], [WIDE, DEEP, 1.0], [0.0, DEEP, 1.0]])
QUARTERS = np.full(4, 0.25)
FIVE = {"sides": 5, "aperture": 1e-3}
SHAPES = [
    {"sides": 3, "central": 0.2, "aperture": 1e-3},
    FIVE,
    {"lengths": [0.1, 0.05, 0.1, 0.05, 0.1], "aperture": 1e-3},
    {"lengths": [0.1, 0.05, 0.1, 0.05, 0.1], "aperture": 1e-3, "keep": "angle"},
    {"lengths": [0.1, 0.05, 0.1, 0.05, 0.1], "aperture": 1e-3, "keep": "lengths"},
    {"lengths": [0.3, 0.2, 0.3], "aperture": 1e-3, "keep": "lengths"},
    {"lengths": [0.1, 0.9, 0.1], "aperture": 1e-3, "keep": "lengths"},
]


def layout(seed=1, **table) -> PointLayout:
    return PointLayout(**table_of(Profile)(**table).ranges, seed=seed)


def polygon(sides: int, turned: float = 0.3) -> np.ndarray:
    """A flattened regular polygon away from the origin."""
    angles = turned + 2.0 * np.pi * np.arange(sides) / sides
    return np.column_stack([1.0 + 0.5 * np.cos(angles), 2.0 + 0.2 * np.sin(angles), np.zeros(sides)])


@pytest.mark.parametrize("table", SHAPES[:3])
def test_across_a_rectangle_it_is_the_profile_of_the_plane(table):
    """Places, rises and shares of the cut along its axis; two corners of a ring are one vertex of the plane."""
    cap = cap_over(RECTANGLE, QUARTERS, UP, layout(**table), (3,))
    places, rises, shares = draw(layout(**table), (3,), WIDE)
    left, right = cap.places.reshape(-1, 4, 3)[:, [0, 1], 0].T
    assert np.concatenate([left, right[::-1]]) == pytest.approx(places, abs=1e-15)
    assert np.concatenate([cap.rises[::4], cap.rises[::-4]]) == pytest.approx(rises, abs=1e-18)
    assert np.concatenate([cap.shares[::4] + cap.shares[3::4]] * 2) == pytest.approx(shares, abs=1e-15)


def test_what_stays_is_told_by_the_way_to_the_corners():
    """A rectangle is as long as its diagonal: with the angle kept, its rise goes with that, and its sides keep."""
    table = {"lengths": [0.1, 0.05, 0.1], "aperture": 1e-3}
    corners = cap_over(RECTANGLE, QUARTERS, UP, layout(**table, keep="angle"), (0,))
    assert corners.rises[0] == pytest.approx(1e-3 * np.hypot(WIDE, DEEP) / 0.25, rel=1e-14)
    ways, _ = half_profile(layout(**table, keep="lengths"), (0,), RECTANGLE)
    assert ways * 0.5 * np.hypot(WIDE, DEEP) == pytest.approx([0.25, 0.025], rel=1e-13)


@pytest.mark.parametrize("table", SHAPES)
@pytest.mark.parametrize("outline", [RECTANGLE, polygon(3), polygon(6), polygon(7)], ids=["4", "3", "6", "7"])
def test_convex(table, outline):
    """Every point is a corner of the hull of the cap and of what closes it above, unless the cap is flat."""
    k = len(outline)
    cap = cap_over(outline, np.full(k, 1.0 / k), UP, layout(**table), (0,))
    assert cap.places[:k, :2] == pytest.approx(outline[:, :2], abs=1e-15)
    assert cap.places[:, 2] - outline[0, 2] == pytest.approx(cap.rises, abs=5e-16)
    assert cap.rises.min() == 0.0
    closed = np.concatenate([cap.places, outline + 0.1 * UP])
    assert len(ConvexHull(closed, qhull_options="Qt").vertices) == len(closed)


@pytest.mark.parametrize("outline", [RECTANGLE, polygon(5)], ids=["4", "5"])
def test_volume_between_cap_and_plane(outline):
    """Rings at scale s with rise z: the volume is the integral of z over the area A s², side by side of the profile."""
    cap = cap_over(outline, np.full(len(outline), 1.0 / len(outline)), UP, layout(**FIVE), (0,))
    ways, rises = half_profile(layout(**FIVE), (0,), outline)
    s1, s0, z1, z0 = ways[:-1], ways[1:], rises[:-1], rises[1:]
    slope = (z1 - z0) / (s1 - s0)
    area = ConvexHull(outline[:, :2]).volume
    below = 2.0 * area * ((z0 - slope * s0) * (s1**2 - s0**2) / 2.0 + slope * (s1**3 - s0**3) / 3.0).sum()
    hull = ConvexHull(cap.places).volume
    assert rises[0] * area - hull == pytest.approx(below, rel=1e-9)


def seen(cap, direction):
    """Cap seen from the side: slopes of the lower hull of its points along a direction, which it rolls on."""
    flat = np.column_stack([cap.places @ direction, cap.rises])
    hull = ConvexHull(flat)
    lower = hull.equations[hull.equations[:, 1] < -1e-9]
    return np.unique(np.round(-lower[:, 0] / lower[:, 1], 12))


@given(azimuth=st.floats(0.0, 360.0))
def test_microrotation_by_direction(azimuth):
    """A block that is pushed askew rests on a ridge before a side: no rotation is larger than the steepest side's."""
    cap = cap_over(RECTANGLE, QUARTERS, UP, layout(**FIVE), (0,))
    direction = np.array([np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth)), 0.0])
    steep = slopes(RECTANGLE, *half_profile(layout(**FIVE), (0,), RECTANGLE))
    across = np.abs([direction[1], direction[0]] * 2) @ np.diag([DEEP, WIDE] * 2)  # half widths in that direction
    found = seen(cap, direction)[-1]
    assert found == pytest.approx(steep[0, 0] * 0.5 * DEEP / (0.5 * across[:2].sum()), rel=1e-6)
    assert found <= steep.max() * (1.0 + 1e-6)


def test_along_its_axes_it_turns_as_profiles_of_the_plane():
    cap = cap_over(RECTANGLE, QUARTERS, UP, layout(**FIVE), (0,))
    for direction, length in ((np.eye(3)[0], WIDE), (np.eye(3)[1], DEEP)):
        places, rises, _ = draw(layout(**FIVE), (0,), length)
        assert seen(cap, direction) == pytest.approx(np.diff(rises) / np.diff(places), abs=1e-9)
    assert steepest(layout(**FIVE), RECTANGLE) == pytest.approx((np.diff(rises) / np.diff(places)).max(), rel=1e-12)


def test_drawn_profiles_are_mirror_images_and_odd():
    table = {"sides": [3, 7], "lengths": [[0.5, 1.5]], "aperture": [5e-5, 2e-4]}
    counts = set()
    for i in range(40):
        places, rises, _ = draw(layout(**table), (i,), 1.0, mirrored=True)
        counts.add(len(places) - 1)
        assert places + places[::-1] == pytest.approx(np.ones(len(places)), abs=1e-15)
        assert rises == pytest.approx(rises[::-1], abs=1e-18)
    assert counts == {3, 5, 7}


@pytest.mark.parametrize(("only", "bed", "head"), [("all", True, True), ("bed", True, False), ("head", False, True)])
def test_which_joints_have_one(only, bed, head):
    one = layout(**FIVE, only=only)
    assert (has_cap(one, UP), has_cap(one, np.eye(3)[0])) == (bed, head)
    assert not has_cap(None, UP)
    assert not has_cap(PointLayout(3), UP)


def test_centroid():
    tilted = polygon(6) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.8, 0.6], [0.0, -0.6, 0.8]])
    triangles = tilted[:3]
    assert centroid(tilted) == pytest.approx(tilted.mean(axis=0), abs=1e-15)
    assert centroid(triangles) == pytest.approx(triangles.mean(axis=0), abs=1e-15)
    trapezoid = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    assert centroid(trapezoid) == pytest.approx([13 / 12, 5 / 12, 0.0], abs=1e-15)
