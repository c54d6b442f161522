"""Contact points of frames: with geometry that cannot move they go along with their blocks."""

from __future__ import annotations

import numpy as np
import pytest
from engine import simulation
from studies.space.structures import box, tables

from dem_cli.core.engine import measures
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.kernels import records as slot

MOVED, TURNED = np.array([0.4, -0.1, 0.2]), np.array([0.2, -0.3, 0.5])


def test_load_of_a_table_that_stands_upright():
    """A creep of joints that hold whatever comes turns it by 90°: dividing by zero was a warning on the terminal."""
    ground, cube = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True), box("b", (0.0,) * 3, (1.0,) * 3)
    sim = simulation(tables(ground, cube))
    for live, dead, load in ((0.6, 0.8, 0.75), (1.0, 0.0, np.inf), (-1.0, 0.0, -np.inf), (0.0, 0.0, 0.0)):
        sim.control[slot.LIVE_FACTOR], sim.control[slot.DEAD_FACTOR] = live, dead
        assert sim.load == pytest.approx(load, rel=1e-15)


def test_points_in_space_stay_on_the_first_block():
    """Two cubes, one on the other: the lower one moves and turns, the points of the joint between them with it."""
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    cubes = [box(f"b{k}", (0.0, 0.0, float(k)), (1.0, 1.0, k + 1.0)) for k in (0, 1)]
    sim = simulation(tables(ground, *cubes))
    rest = measures.contact_record(sim)
    sim.bodies.positions[1] += MOVED
    sim.bodies.orientations[1] = TURNED
    now = measures.contact_record(sim)
    first = rest.blocks[:, 0]
    assert set(first) == {0, 1}
    np.testing.assert_array_equal(now.points[first == 0], rest.points[first == 0])
    arms = rest.points[first == 1] - sim.model.centroids[1]
    expected = sim.model.centroids[1] + MOVED + arms @ matrices(TURNED[np.newaxis])[0].T
    np.testing.assert_allclose(now.points[first == 1], expected, rtol=1e-14)
    np.testing.assert_array_equal(now.normals, rest.normals)  # forces balance where the blocks were
