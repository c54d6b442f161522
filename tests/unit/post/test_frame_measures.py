"""Resultants, thrust chains and drawing scales, checked by hand."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic import boxes_model, no_contacts, wall_frames, wall_model

from dem_cli.core.records.frames import ContactRecord, Frame
from dem_cli.results.post import frame_measures
from dem_cli.results.post.capacity import with_breaks


def column_contacts(model, n_drums, forces=(1.0, 3.0), shear=0.5):
    """Two points per bed joint at x = 0 and 1, between drum i − 1 and i."""
    n = 2 * n_drums
    below = np.repeat(np.arange(n_drums), 2)
    heights = np.repeat(np.arange(n_drums, dtype=float), 2)
    return ContactRecord(
        joint=below,
        blocks=np.stack((below, below + 1), axis=1),
        points=np.stack((np.tile((0.0, 1.0), n_drums), heights), axis=1),
        normals=np.tile((0.0, 1.0), (n, 1)),
        normal_force=np.tile(forces, n_drums),
        shear_force=np.full((n, 1), shear),
        gap=np.zeros(n),
        slip=np.zeros(n),
        state=np.ones(n, dtype=np.int8),
    )


@pytest.fixture
def column():
    boxes = [(0.0, i - 1.0, 1.0, 1.0, i == 0) for i in range(4)]
    return boxes_model(boxes)


def test_resultant_of_two_points(column):
    found = frame_measures.resultants(column_contacts(column, 3))
    np.testing.assert_allclose(found.points[:, 0], 0.75)  # (0 · 1 + 1 · 3) / 4
    np.testing.assert_allclose(found.points[:, 1], [0.0, 1.0, 2.0])
    np.testing.assert_allclose(found.forces, [(-1.0, 4.0)] * 3)  # tangent = (−1, 0), two shears of 0.5
    assert found.blocks.tolist() == [[0, 1], [1, 2], [2, 3]]


def test_nothing_pressed():
    found = frame_measures.resultants(no_contacts())
    assert len(found.points) == len(found.forces) == 0


def test_thrust_runs_through_a_column_but_not_through_a_wall(column):
    (chain,) = frame_measures.chains(column, frame_measures.resultants(column_contacts(column, 3)))
    assert chain.tolist() in ([0, 1, 2], [2, 1, 0])
    wall = wall_model()
    assert frame_measures.chains(wall, frame_measures.resultants(wall_frames(wall)[0].contacts)) == []


def moved_frame(model, moved, turn=0.0):
    positions = model.centroids + np.array((moved, 0.0)) * ~model.fixed[:, np.newaxis]
    n = model.n_blocks
    angles = np.where(model.fixed, 0.0, turn)[:, np.newaxis]
    return Frame("loading", 1, 0.1, moved, positions, angles, np.zeros((n, 3)), no_contacts())


@pytest.mark.parametrize(
    ("moved", "turn", "scale"), [(0.0, 0.0, 1.0), (1e-6, 0.0, 1e5), (1e-3, 0.0, 100.0), (0.1, 0.0, 1.0)]
)
def test_scale_makes_displacements_visible(column, moved, turn, scale):
    assert frame_measures.visible_scale(column, moved_frame(column, moved, turn)) == pytest.approx(scale)


def test_scale_keeps_drawn_rotations_small(column):
    frame = moved_frame(column, 0.0, 1e-3)
    assert frame_measures.visible_scale(column, frame) * 1e-3 <= 0.35


def test_scaled_contacts_stay_on_their_block(column):
    frame = moved_frame(column, 1e-3, 0.01)
    corner = np.array((0.5, -0.5))
    arm = np.array(((np.cos(0.01), -np.sin(0.01)), (np.sin(0.01), np.cos(0.01)))) @ corner
    contacts = column_contacts(column, 1)._replace(
        blocks=np.array(((2, 3), (2, 3))), points=np.stack((frame.positions[2] + arm,) * 2)
    )
    shown = frame_measures.scaled(column, frame._replace(contacts=contacts), 10.0)
    turned = np.array(((np.cos(0.1), -np.sin(0.1)), (np.sin(0.1), np.cos(0.1)))) @ corner
    np.testing.assert_allclose(shown.positions[2], column.centroids[2] + (0.01, 0.0))
    np.testing.assert_allclose(shown.contacts.points[0], shown.positions[2] + turned)


def test_curves_break_where_another_simulation_starts():
    steps, loads = np.array((1, 5, 9, 2, 4)), np.arange(5)
    (found,) = with_breaks(steps, loads)
    np.testing.assert_array_equal(found, (0, 1, 2, np.nan, 3, 4))
