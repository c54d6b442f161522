"""Convex polyhedra: hulls and given faces against closed forms, Qhull's volume, and words of what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from dem_cli.core.geometry import polygon, polyhedron, solids
from dem_cli.core.geometry.polyhedron import Polyhedron, box, from_faces, hull, prism, prisms
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.geometry.topology import topology_of_polyhedra

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
L_SHAPE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])


def properties(*parts: Polyhedron) -> solids.VolumeProperties:
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    return solids.properties_of_all(np.concatenate([p.vertices for p in parts]), starts, topology_of_polyhedra(parts))


def assert_sound(solid: Polyhedron) -> None:
    """Plane faces whose normals point outwards, each edge twice, Euler's formula."""
    edges = set()
    for loop in solid.faces:
        normal = polyhedron.newell(solid.vertices[loop])
        heights = (solid.vertices - solid.vertices[loop[0]]) @ normal / np.linalg.norm(normal)
        assert np.abs(heights[loop]).max() < 1e-6
        assert heights.max() < 1e-6
        edges |= set(zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True))
    assert edges == {(j, i) for i, j in edges}
    assert len(solid.vertices) - len(edges) // 2 + len(solid.faces) == 2


def test_hull_of_cube_with_points_on_faces_and_edges():
    more = np.array([[0.5, 0.5, 1.0], [0.5, 0.0, 0.0], [0.25, 0.75, 1.0]])
    solid = hull(np.concatenate([CUBE, more]))
    assert_sound(solid)
    assert len(solid.vertices) == 8
    assert sorted(len(face) for face in solid.faces) == [4] * 6


def test_hulls_of_random_points_have_the_volume_of_qhull():
    random = np.random.default_rng(1)
    for n in (4, 5, 8, 20, 60):
        points = random.normal(size=(n, 3))
        points /= np.linalg.norm(points, axis=1, keepdims=True) + 0.2 * random.random((n, 1))
        expected = ConvexHull(points)
        solid = hull(points[expected.vertices])
        assert_sound(solid)
        assert properties(solid).volume[0] == pytest.approx(expected.volume, rel=1e-12)


def test_turned_prisms_of_many_sides_keep_their_faces():
    """Qhull leaves slivers of no area on such faces: an arch voussoir, drums."""
    random = np.random.default_rng(2)
    for n in (3, 4, 6, 8, 12, 24):
        angles = 2.0 * np.pi * np.arange(n) / n
        solid = prism(np.column_stack([np.cos(angles), np.sin(angles)]), -0.3, 0.4)
        quaternion = random.normal(size=(1, 4))
        turned = solid.vertices @ matrices(quaternion / np.linalg.norm(quaternion))[0].T
        found = hull(random.permutation(turned + np.array([100.0, -200.0, 50.0])))
        assert_sound(found)
        assert sorted(len(face) for face in found.faces) == sorted(len(face) for face in solid.faces)


def test_given_faces_may_run_either_way_round():
    solid = from_faces(CUBE, [loop[::-1] if i % 2 else loop for i, loop in enumerate(CUBE_FACES)])
    assert_sound(solid)
    assert properties(solid).volume[0] == pytest.approx(1.0, rel=1e-15)


def test_given_faces_of_one_plane_become_one():
    triangles = [half for a, b, c, d in CUBE_FACES for half in ([a, b, c], [a, c, d])]
    solid = from_faces(CUBE, triangles)
    assert_sound(solid)
    assert len(solid.faces) == 6


@pytest.mark.parametrize(
    ("points", "loops", "words"),
    [
        (CUBE, CUBE_FACES[:5], "do not close: the edge from"),
        (CUBE, [*CUBE_FACES[:5], [1, 5, 7]], "do not close"),
        (CUBE, [*CUBE_FACES[:5], [1, 5, 7, 8]], "face 6 names corner 8; corners count from 0 to 7"),
        (CUBE, [*CUBE_FACES[:5], [1, 5, 7, 5]], "face 6 names a corner twice"),
        (CUBE, [*CUBE_FACES[:5], [1, 5]], "face 6 needs at least 3"),
        (CUBE, [*CUBE_FACES[:5], [1, 5, 3, 7]], "face 6"),
        (CUBE + np.eye(8, 3) * 0.1, CUBE_FACES, "is not plane: corner"),
        (np.concatenate([CUBE, [[0.5, 0.5, 0.5]]]), CUBE_FACES, r"corner 9, \[0.5, 0.5, 0.5\], belongs to no face"),
        (
            np.concatenate([CUBE, [[0.5, 0.5, 0.5]]]),
            [*CUBE_FACES[:5], [1, 5, 8], [5, 7, 8], [7, 3, 8], [3, 1, 8]],
            "must be convex",
        ),
    ],
)
def test_what_is_no_polyhedron_is_refused_with_its_place(points, loops, words):
    with pytest.raises(ValueError, match=words):
        from_faces(points, loops)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (CUBE[:3], "at least 4 corners, found 3"),
        (CUBE[:4], "in one plane"),
        (np.concatenate([CUBE, CUBE[3:4]]), "corners 4 and 9 are the same point"),
        (np.concatenate([CUBE, [[0.5, 0.5, 0.5]]]), r"corner 9, \[0.5, 0.5, 0.5\], lies inside"),
        (CUBE[:, :2], r"triple \[x, y, z\]"),
    ],
)
def test_points_without_a_hull_are_refused(points, words):
    with pytest.raises(ValueError, match=words):
        hull(points)


def test_prisms_along_the_edges_of_their_polygons():
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [0.5, 1.0]])
    first, second = prisms([triangle, L_SHAPE], [0.0, 1.0], [0.5, 4.0])
    for solid, flat, depth in ((first, triangle, 0.5), (second, L_SHAPE, 3.0)):
        assert_sound(solid)
        assert properties(solid).volume[0] == pytest.approx(polygon.area(flat) * depth, rel=1e-14)
        for k, face in enumerate(solid.faces[: len(flat)]):
            ends = {tuple(flat[k]), tuple(flat[(k + 1) % len(flat)])}
            assert {tuple(corner) for corner in solid.vertices[face][:, [0, 2]]} == ends
    assert np.ptp(second.vertices[:, 1]) == 3.0
    assert properties(prism(triangle[::-1], 0.0, 0.5)).volume == properties(first).volume


def test_mass_of_a_box_of_a_corner_and_of_a_compound():
    a, b, c = 0.5, 2.0, 3.0
    solid = box([10.0, 20.0, 30.0], [10.0 + a, 20.0 + b, 30.0 + c])
    found = properties(solid)
    assert found.volume[0] == pytest.approx(a * b * c, rel=1e-14)
    assert found.centroid[0] == pytest.approx([10.25, 21.0, 31.5], rel=1e-15)
    assert found.second_moments[0] == pytest.approx(a * b * c / 12.0 * np.diag([a * a, b * b, c * c]), abs=1e-13)
    corner = hull(np.array([[0.0, 0.0, 0.0], [a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]))
    volume = a * b * c / 6.0
    edges = np.array([a, b, c])
    about_corner = volume / 20.0 * (np.outer(edges, edges) + np.diag(edges**2))
    expected = about_corner - volume * np.outer(edges, edges) / 16.0
    assert properties(corner).second_moments[0] == pytest.approx(expected, abs=1e-15)
    halves = [box([10.0, 20.0, 30.0], [10.2, 22.0, 33.0]), box([10.2, 20.0, 30.0], [10.5, 22.0, 33.0])]
    whole = solids.compound(properties(*halves), np.zeros(2, np.int64), 1)
    for field, expected in zip(whole, found, strict=True):
        assert field == pytest.approx(expected, rel=1e-13, abs=1e-13)


def test_principal_axes_turn_the_principal_moments_into_the_tensor():
    random = np.random.default_rng(3)
    shapes = [hull(random.normal(size=(4, 3))) for _ in range(20)] + [box([0.0, 0.0, 0.0], [1.0, 2.0, 3.0])]
    tensors = solids.inertia_tensors(properties(*shapes).second_moments)
    moments, axes = solids.principal(tensors)
    turns = matrices(axes)
    again = turns @ (moments[:, :, None] * turns.swapaxes(1, 2))
    assert np.abs(again - tensors).max() < 1e-13 * np.abs(tensors).max()
    assert axes[-1] == pytest.approx([1.0, 0.0, 0.0, 0.0], abs=1e-15)
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1.0, rel=1e-15)


def test_turned_about_the_vertical_axis():
    solid = box([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])
    (found,) = polyhedron.all_moved([solid], np.pi / 2, [0.0, 0.0, 5.0])
    assert found.vertices.min(axis=0) == pytest.approx([-1.0, 1.0, 5.0])
    assert found.vertices.max(axis=0) == pytest.approx([0.0, 2.0, 6.0])
    assert_sound(found)
