"""Bodies of blocks in plane and space: the same masses, places and inertias about y for prisms as for polygons."""

from __future__ import annotations

import numpy as np
import pytest
from oracle.shapes import running_wall
from synthetic.spatial import extruded, spatial_model

from dem_cli.core.geometry.polyhedron import box
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.places import block_at
from dem_cli.core.model.scales import stiffness_scale


def test_prisms_weigh_what_their_polygons_do():
    polygons, _ = running_wall(4, 3)
    n, depth = len(polygons), 0.3
    flat = bodies_of(2, [[each] for each in polygons], np.full(n, 1800.0), np.full(n, depth))
    solid = bodies_of(3, [[each] for each in extruded(polygons, depth)], np.full(n, 1800.0), np.ones(n))
    assert solid.masses == pytest.approx(flat.masses, rel=1e-14)
    assert solid.centroids[:, [0, 2]] == pytest.approx(flat.centroids, abs=1e-15)
    assert solid.inertias[:, 1] == pytest.approx(flat.inertias[:, 0], rel=1e-13)
    assert solid.principal_axes == pytest.approx(np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)), abs=1e-14)


def test_model_in_space_with_some_of_its_blocks():
    blocks = [
        box([0, 0, 0], [1, 1, 1]),
        [box([0, 0, 1], [1, 1, 2]), box([1, 0, 1], [2, 1, 2])],
        box([0, 0, 2], [3, 1, 3]),
    ]
    model = spatial_model(blocks)
    few = model.only([1, 2], fixed=np.array([True, False]))
    alone = spatial_model(blocks[1:])
    for name in (
        "part_faces",
        "face_starts",
        "face_corners",
        "part_starts",
        "part_blocks",
        "vertices",
        "principal_axes",
    ):
        assert np.array_equal(getattr(few, name), getattr(alone, name)), name


def test_blocks_at_points_and_measures_in_space():
    step = [box([0, 0, 1], [1, 1, 2]), box([1, 0, 1], [3, 1, 1.5])]
    model = spatial_model([box([0, 0, 0], [4, 1, 1]), step])
    points = {(0.5, 0.5, 0.5): 0, (2.5, 0.0, 1.25): 1, (0.5, 0.5, 1.9): 1, (2.5, 0.5, 1.75): None}
    assert [block_at(model, np.array(point)) for point in points] == list(points.values())
    assert model.shapes.volumes == pytest.approx([4.0, 2.0])
    assert model.shapes.edges == pytest.approx([1.0, 0.5])
    assert model.shapes.widths == pytest.approx([1.0, 0.5])
    ends = np.concatenate([part.vertices for part in step])
    assert model.shapes.radii[1] == pytest.approx(np.linalg.norm(ends - model.centroids[1], axis=1).max())
    assert model.inner_faces.sum() == 1  # the face of the lower part; the higher one is free above it
    joint = 2.0 ** (2 / 3)
    assert stiffness_scale(model) == pytest.approx(2.0 * 2000.0 * 9.81 / (joint * 0.5))
