"""Faces of convex parts as compressed rows: in the plane each edge once, around every part."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.geometry import parts, polygon, spatial_parts
from dem_cli.core.geometry.compounds import covered_faces, inner_edges
from dem_cli.core.geometry.polyhedron import box, prism
from dem_cli.core.geometry.solids import face_areas
from dem_cli.core.geometry.topology import topology_of_polygons, topology_of_polyhedra

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


def test_faces_between_parts_of_a_block_in_space_are_inner():
    """The lower part is covered by two, of which one is of the same block as well; the third only touches."""
    solids = [
        box([0, 0, 0], [2, 1, 1]),
        box([0, 0, 1], [1, 1, 2]),
        box([1, 0, 1], [2, 1, 2]),
        box([0, 0, 2], [2, 1, 3]),
    ]
    vertices, topology = np.concatenate([s.vertices for s in solids]), topology_of_polyhedra(solids)
    starts = np.array([0, 8, 16, 24, 32])
    sizes = parts.sizes(vertices, starts)
    inner = covered_faces(vertices, topology, face_areas(vertices, topology), np.array([0, 0, 0, 1]), sizes)
    heights = [
        vertices[topology.face_corners[topology.face_starts[f] : topology.face_starts[f + 1]]] for f in range(24)
    ]
    found = {(int(topology.face_parts[f]), *heights[f].mean(axis=0).tolist()) for f in np.flatnonzero(inner)}
    assert found == {(0, 1.0, 0.5, 1.0), (1, 0.5, 0.5, 1.0), (1, 1.0, 0.5, 1.5), (2, 1.5, 0.5, 1.0), (2, 1.0, 0.5, 1.5)}


def test_edges_of_a_box_once():
    solid = box([0, 0, 0], [1, 2, 3])
    ends, part = spatial_parts.edges(topology_of_polyhedra([solid, solid]))
    lengths = np.linalg.norm(np.diff(np.tile(solid.vertices, (2, 1))[ends], axis=1)[:, 0], axis=1)
    assert sorted(lengths.tolist()) == [1.0] * 8 + [2.0] * 8 + [3.0] * 8
    assert part.tolist() == [0] * 12 + [1] * 12


def test_a_face_without_an_area_has_no_normal():
    """A drum 1e19 m high: its sides were divided by zero, with a warning of Python before the refusal."""
    solid = box([0, 0, 0], [1, 2, 3])
    flat = solid.vertices * [1.0, 1.0, 0.0]
    found = spatial_parts.normals(flat, topology_of_polyhedra([solid]))
    assert sorted(map(tuple, np.abs(found))) == [(0.0, 0.0, 0.0)] * 4 + [(0.0, 0.0, 1.0)] * 2


def test_narrowest_extents_in_space():
    drum = prism(np.array([[np.cos(a), np.sin(a)] for a in np.arange(8) * np.pi / 4]), 0.0, 5.0)
    solids = [box([0, 0, 0], [3, 0.2, 2]), box([0, 0, 0], [0.3, 0.3, 9]), drum]
    vertices, starts = np.concatenate([s.vertices for s in solids]), np.array([0, 8, 16, 32])
    widths = spatial_parts.widths(vertices, starts, topology_of_polyhedra(solids))
    assert widths == pytest.approx([0.2, 0.3, 2.0 * np.cos(np.pi / 8)])
