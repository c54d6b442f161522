"""Faces of convex parts as compressed rows: in the plane each edge once, around every part."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry import polygon
from dem_cli.geometry.compounds import inner_edges
from dem_cli.geometry.topology import topology_of_polygons

STARTS = np.array([0, 3, 7, 12])


def test_a_face_of_a_polygon_is_an_edge():
    found = topology_of_polygons(STARTS)
    assert found.n_faces == 12
    assert np.array_equal(found.part_faces, STARTS)
    assert np.array_equal(np.diff(found.face_starts), np.full(12, 2))
    assert np.array_equal(found.ends[:, 0], np.arange(12))
    assert np.array_equal(found.ends[:, 1], polygon.following(STARTS))
    assert np.array_equal(found.face_parts, [0] * 3 + [1] * 4 + [2] * 5)


def test_faces_go_once_around_each_part():
    """Every corner begins one face and ends one, of the same part."""
    found = topology_of_polygons(STARTS)
    for part in range(3):
        corners = np.arange(STARTS[part], STARTS[part + 1])
        ends = found.ends[found.face_parts == part]
        assert np.array_equal(np.sort(ends[:, 0]), corners)
        assert np.array_equal(np.sort(ends[:, 1]), corners)


def test_edges_between_parts_of_a_block_are_inner():
    shapes = [polygon.rectangle(0, 0, 2, 1), polygon.rectangle(0, 1, 2, 1), polygon.rectangle(0, 2, 2, 1)]
    starts, vertices = np.array([0, 4, 8, 12]), np.concatenate(shapes)
    topology, sizes = topology_of_polygons(starts), polygon.sizes(vertices, starts)
    apart = inner_edges(vertices, topology, np.array([0, 1, 2]), sizes)
    assert not apart.any()
    together = inner_edges(vertices, topology, np.array([0, 0, 1]), sizes)
    assert np.flatnonzero(together).tolist() == [2, 4]  # the top of the first part, the foot of the second
