"""Bodies of blocks in plane and space: the same masses, places and inertias about y for prisms as for polygons."""

from __future__ import annotations

import numpy as np
import pytest
from oracle.shapes import running_wall
from synthetic.spatial import extruded, spatial_model

from dem_cli.geometry.polyhedron import box
from dem_cli.model.bodies import bodies_of


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
