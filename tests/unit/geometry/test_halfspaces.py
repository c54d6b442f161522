"""Polyhedra cut by planes: volumes add up, faces are plane and close, both halves share the corners of the cut."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.geometry import polyhedron, solids
from dem_cli.core.geometry.halfspaces import behind_all, halves
from dem_cli.core.geometry.topology import topology_of_polyhedra


def volume(solid):
    return float(
        solids.properties_of_all(
            solid.vertices, np.array([0, len(solid.vertices)]), topology_of_polyhedra([solid])
        ).volume[0]
    )


def random_solid(seed):
    points = np.random.default_rng(seed).normal(size=(14, 3))
    return polyhedron.hull(points / np.linalg.norm(points, axis=1, keepdims=True))


@pytest.mark.parametrize("seed", range(6))
def test_halves_fill_the_whole_and_share_the_cut(seed):
    solid, random = random_solid(seed), np.random.default_rng(100 + seed)
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)
    both = halves(solid, normal, 0.2 * random.random())
    assert volume(both.behind) + volume(both.beyond) == pytest.approx(volume(solid), rel=1e-14)
    for half in both:
        again = polyhedron.from_faces(half.vertices, half.faces)  # plane, convex, closed
        assert volume(again) == pytest.approx(volume(half), rel=1e-14)
    on_cut = [{tuple(v) for v in half.vertices if abs(v @ normal - both_height(both, normal)) < 1e-12} for half in both]
    assert on_cut[0] == on_cut[1]
    assert len(on_cut[0]) > 2


def both_height(both, normal):
    return max(both.behind.vertices @ normal)


def test_through_corners_and_edges_of_a_box():
    box = polyhedron.box((0, 0, 0), (1, 1, 1))
    both = halves(box, np.array([1, -1, 0]) / np.sqrt(2), 0.0)  # through two opposite edges
    assert [len(half.vertices) for half in both] == [6, 6]
    assert [len(half.faces) for half in both] == [5, 5]
    assert volume(both.behind) == pytest.approx(0.5, rel=1e-15)


def test_beside_and_on_a_face_nothing_is_cut():
    box = polyhedron.box((0, 0, 0), (1, 1, 1))
    assert halves(box, (0, 0, 1), 1.0 + 1e-12) == (box, None)
    assert halves(box, (0, 0, -1), -1.0) == (None, box)
    assert halves(box, (0, 0, 1), 3.0).beyond is None


def test_corner_of_a_box_behind_three_planes():
    box = polyhedron.box((0, 0, 0), (1, 1, 1))
    tetra = behind_all(box, [(np.ones(3) / np.sqrt(3), 1 / np.sqrt(3))])
    assert volume(tetra) == pytest.approx(1 / 6, rel=1e-15)
    assert len(tetra.faces) == 4
    assert behind_all(tetra, [((0, 0, 1), -0.1)]) is None
