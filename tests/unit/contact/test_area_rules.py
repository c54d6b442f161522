"""Points over the area of a joint in space: area, first and second moments against polygons, weights, corners."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from synthetic.spatial import spatial_model
from synthetic.spatial_joints import KN, shifted, start_joints

from dem_cli.core.contact import spatial
from dem_cli.core.contact.area_rules import inner_points
from dem_cli.core.contact.caps import centroid
from dem_cli.core.geometry.polyhedron import box, hull
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.kernels.records import FACES
from dem_cli.core.kernels.spatial_geometry import AREA, CENTRE

RECTANGLE = np.array([[0.0, 0.0], [0.4, 0.0], [0.4, 0.15], [0.0, 0.15]])
SKEW = RECTANGLE @ np.array([[1.0, 0.3], [0.5, 1.0]])
TRAPEZOID = np.array([[0.0, 0.0], [3.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def ring(k: int, random: np.random.Generator) -> np.ndarray:
    """A convex polygon with corners on an ellipse."""
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, k))
    return np.column_stack([np.cos(angles), 0.6 * np.sin(angles)])


def moments(polygon: np.ndarray) -> np.ndarray:
    """Integrals of 1, x, y, x², xy, y² over a polygon, by Green's theorem."""
    (x, y), (u, v) = polygon.T, np.roll(polygon, -1, axis=0).T
    c = x * v - u * y
    terms = [
        c / 2, c * (x + u) / 6, c * (y + v) / 6, c * (x * x + x * u + u * u) / 12,
        c * (2 * x * y + x * v + u * y + 2 * u * v) / 24, c * (y * y + y * v + v * v) / 12,
    ]  # fmt: skip
    return np.array([term.sum() for term in terms])


def in_space(polygon: np.ndarray) -> np.ndarray:
    """Turned out of all planes, far from the origin."""
    turn = matrices(np.array([[0.8, 0.3, -0.4, 0.33166247903554]]))[0]
    return np.column_stack([polygon, np.zeros(len(polygon))]) @ turn.T + [3.0, -2.0, 1.0], turn


def rule(polygon: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """All points of the rule in the plane of the polygon, corners first, and the area of each."""
    places, turn = in_space(polygon)
    middle = centroid(places)
    inner = inner_points(places, np.array([0, len(places)]), middle[None], np.array([n]))
    one = places - middle
    thirds = np.linalg.norm(np.cross(one, np.roll(one, -1, axis=0)), axis=1)
    corners = inner.corners[0] * (thirds + np.roll(thirds, 1)) / (2.0 * thirds.sum())
    area = moments(polygon)[0]
    back = (np.concatenate([places, inner.places]) - [3.0, -2.0, 1.0]) @ turn
    return back[:, :2], area * np.concatenate([corners, inner.shares])


POLYGONS = {"rectangle": RECTANGLE, "parallelogram": SKEW, "trapezoid": TRAPEZOID} | {
    f"{k} corners": ring(k, np.random.default_rng(k)) for k in (3, 4, 5, 6, 9, 12)
}


@pytest.mark.parametrize("n", range(3, 10))
@pytest.mark.parametrize("name", POLYGONS)
def test_area_first_and_second_moments_are_exact(name, n):
    polygon = POLYGONS[name]
    places, weights = rule(polygon, n)
    x, y = places.T
    found = np.array([(weights * f).sum() for f in (x**0, x, y, x * x, x * y, y * y)])
    size = np.abs(polygon).max()
    scales = moments(polygon)[0] * np.array([1, size, size, size**2, size**2, size**2])
    assert (np.abs(found - moments(polygon)) < 1e-12 * scales).all()
    assert (weights > 0.0).all()
    hull = ConvexHull(polygon).equations
    assert (hull[:, :2] @ places.T + hull[:, 2:] < 1e-12).all()


SIZES = [("rectangle", 3, 9), ("rectangle", 5, 25), ("parallelogram", 9, 81), ("trapezoid", 3, 9)]


@pytest.mark.parametrize(("name", "n", "points"), [*SIZES, ("6 corners", 4, 13), ("6 corners", 5, 43)])
def test_how_many_points(name, n, points):
    places, _ = rule(POLYGONS[name], n)
    assert len(places) == points
    assert len(np.unique(places.round(9), axis=0)) == points


def test_many_polygons_at_once_are_those_one_by_one():
    polygons = [in_space(POLYGONS[name])[0] for name in POLYGONS for _ in range(2)]
    sides = np.array([2, 3, 5, 5, 3, 4] * 3)
    starts = np.concatenate([[0], np.cumsum([len(p) for p in polygons])])
    middles = np.array([centroid(p) for p in polygons])
    all_at_once = inner_points(np.concatenate(polygons), starts, middles, sides)
    for i, polygon in enumerate(polygons):
        one = inner_points(polygon, np.array([0, len(polygon)]), middles[[i]], sides[[i]])
        own = slice(*all_at_once.starts[i : i + 2])
        assert all_at_once.places[own].tolist() == one.places.tolist()
        assert all_at_once.shares[own].tolist() == one.shares.tolist()
        assert all_at_once.corners[i] == one.corners[0]


HEXAGON = [[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3]


COLUMN = hull(np.array([(x, y, z) for z in (0, 1) for x, y in HEXAGON]))
PAIRS = [
    (box([0, 0, 0], [1, 1, 1]), shifted(box([0, 0, 0], [0.5, 0.8, 1.0]), [0.2, 0.1, 1.0])),
    (COLUMN, shifted(box([0, 0, 0], [1.0, 1.0, 1.0]), [0.1, 0.2, 1.0])),
]


@pytest.mark.parametrize(("below", "above"), PAIRS)
def test_a_joint_is_as_stiff_as_its_area(below, above):
    """Stiffness of the points about the centroid: kn A, and kn times the second moments of the overlap."""
    model = spatial_model([below, above], fixed=())
    joints = start_joints(model, points=5).joints
    faces = spatial.find(model, np.concatenate([below.vertices, above.vertices]), 1e-6)
    met = spatial.meetings(model, faces, np.concatenate([below.vertices, above.vertices]))
    assert met.kinds.tolist() == [FACES]
    arms = joints.points - met.measures[0, CENTRE : CENTRE + 3]
    exact = moments(met.places[:, :2] - met.measures[0, CENTRE : CENTRE + 2])
    exact *= np.sign(exact[0])
    assert exact[0] == pytest.approx(met.measures[0, AREA], rel=1e-12)
    x, y = arms[:, :2].T
    found = np.array([(joints.kn * f).sum() for f in (x**0, x, y, x * x, x * y, y * y)])
    assert found == pytest.approx(KN * exact, rel=1e-12, abs=1e-12 * KN * exact[0])
