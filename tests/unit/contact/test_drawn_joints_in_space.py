"""Joints as they were drawn, in space: outlines, a block that turns about an edge in closed form, forces, gaps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from synthetic.spatial import extruded, spatial_model
from synthetic.spatial_joints import one_joint, shifted, start_joints

from dem_cli.core.contact.between import StartJoints
from dem_cli.core.contact.drawn_joints import OPEN, SLIDING, DrawnJoints
from dem_cli.core.contact.gaps import gaps_of_start, wedges_of_start
from dem_cli.core.geometry.polyhedron import Polyhedron, box, hull
from dem_cli.core.geometry.rotation import matrices, quaternions, unturned
from dem_cli.core.records.frames import ContactRecord

BASE = box([-2.0, -2.0, -0.5], [2.0, 2.0, 0.0])
B, D = 0.5, 0.8


def nothing() -> ContactRecord:
    none = np.zeros(0)
    return ContactRecord(
        np.zeros(0, np.int64), np.zeros((0, 2), np.int64), np.zeros((0, 3)), np.zeros((0, 3)), none, np.zeros((0, 2)),
        none, none, np.zeros(0, np.int8), np.zeros((0, 3)),
    )  # fmt: skip


def pressed(places, forces, state=SLIDING) -> ContactRecord:
    """Vertical and horizontal forces (n, 3) on block 1 at places of a horizontal joint."""
    n, forces = len(places), np.array(forces, float)
    return ContactRecord(
        np.zeros(n, np.int64), np.tile((0, 1), (n, 1)), np.array(places, float), np.tile((0.0, 0.0, 1.0), (n, 1)),
        forces[:, 2], forces[:, :2], np.zeros(n), np.zeros(n), np.full(n, state, np.int8),
        np.tile((1.0, 0.0, 0.0), (n, 1)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def pair():
    return spatial_model([BASE, box([0.0, 0.0, 0.0], [B, D, 1.0])])


def test_where_joints_are(pair):
    places = DrawnJoints(pair).places
    assert places.blocks.tolist() == [[0, 1]]
    assert places.normals == pytest.approx(np.array([[0.0, 0.0, 1.0]]))
    assert places.starts.tolist() == [0, 4]
    around = places.corners - [0.5 * B, 0.5 * D, 0.0]
    assert sorted(map(tuple, np.abs(around).round(12))) == [(0.5 * B, 0.5 * D, 0.0)] * 4
    turns = np.cross(around, np.roll(around, -1, axis=0))[:, 2]
    assert (turns > 0.0).all()  # counter-clockwise seen from b
    assert places.area == pytest.approx([B * D])
    assert places.length == pytest.approx([np.hypot(B, D)])
    assert places.middles()[0] == pytest.approx([0.5 * B, 0.5 * D, 0.0])
    assert set(places.stored()) == set(places._fields)


@pytest.mark.parametrize("kept", [unturned, lambda n, d: np.zeros((n, 3))])
def test_a_block_that_turns_about_an_edge(pair, kept):
    """By θ about its edge along y: the far corners open by B sin θ, the middle slides by B (1 − cos θ)/2."""
    theta = 0.3
    turn, edge = np.array([[0.0, theta, 0.0]]), np.array([B, 0.0, 0.0])
    positions, orientations = pair.centroids.copy(), kept(2, 3)
    orientations[1] = quaternions(turn)[0] if orientations.shape[1] == 4 else turn[0]
    positions[1] = edge + matrices(turn)[0] @ (positions[1] - edge)
    now = DrawnJoints(pair).at(positions, orientations, nothing())
    assert np.sort(now.gaps) == pytest.approx([0.0, 0.0, B * np.sin(theta), B * np.sin(theta)], abs=1e-15)
    assert now.states.opening == pytest.approx([0.5 * B * np.sin(theta)])
    assert now.states.crack_width == pytest.approx([B * np.sin(theta)])
    assert now.states.slip == pytest.approx([0.5 * B * (1.0 - np.cos(theta))])
    assert now.ends[:, 2].max() == pytest.approx(0.5 * B * np.sin(theta))
    assert now.states.state.tolist() == [OPEN]


@pytest.mark.parametrize("angle", [0.7, 2.9])
def test_what_turns_with_the_first_block_is_no_motion(pair, angle):
    """Both turned far as one, and the second on by 0.3 rad about the normal: slip of the middle, what forces do."""
    turn, spin = Rotation.from_rotvec(angle * np.array([2.0, -1.0, 2.0]) / 3.0), Rotation.from_rotvec([0.0, 0.0, 0.3])
    shift = np.array([3.0, -1.0, 0.5])
    positions, own = turn.apply(pair.centroids) + shift, [turn, turn * spin]
    orientations = np.array([each.as_quat(scalar_first=True) for each in own])
    held = pressed([[0, 0, 0], [B, D, 0]], [[3.0, 4.0, 30.0], [0.0, 0.0, 10.0]])
    held = held._replace(
        points=turn.apply(held.points) + shift, normals=turn.apply(held.normals), tangents=turn.apply(held.tangents)
    )
    states = DrawnJoints(pair).at(positions, orientations, held).states
    for still in (states.opening, states.crack_width, states.slip):  # it turns about the middle of the joint
        np.testing.assert_allclose(still, 0.0, atol=1e-14)
    assert states.normal_stress == pytest.approx([40.0 / (B * D)])
    assert states.shear_stress == pytest.approx([5.0 / (B * D)])
    assert states.eccentricity == pytest.approx([0.25 * np.hypot(B, D)])
    positions[1] += turn.apply([0.03, 0.04, 0.02])
    states = DrawnJoints(pair).at(positions, orientations, nothing()).states
    assert (states.opening[0], states.slip[0]) == (pytest.approx(0.02), pytest.approx(0.05))


def test_stresses_and_eccentricity_of_a_joint(pair):
    """Two forces at opposite corners: their sum over the area, the distance of the resultant from the middle."""
    states = (
        DrawnJoints(pair)
        .at(pair.centroids, unturned(2, 3), pressed([[0, 0, 0], [B, D, 0]], [[3.0, 4.0, 30.0], [0.0, 0.0, 10.0]]))
        .states
    )
    assert states.normal_stress == pytest.approx([40.0 / (B * D)])
    assert states.shear_stress == pytest.approx([5.0 / (B * D)])
    assert states.eccentricity == pytest.approx([0.25 * np.hypot(B, D)])
    assert states.state.tolist() == [SLIDING]


def test_forces_go_to_the_nearest_joint_of_two_blocks():
    """A table of two legs on a base: one pair of blocks, two joints."""
    table = [box([0, 0, 0], [0.2, 1, 1]), box([1.8, 0, 0], [2, 1, 1]), box([0, 0, 1], [2, 1, 1.2])]
    model = spatial_model([BASE, table])
    states = (
        DrawnJoints(model)
        .at(model.centroids, unturned(2, 3), pressed([[0.1, 0.5, 0], [1.9, 0.1, 0], [1.9, 0.9, 0]], [[0, 0, 1.0]] * 3))
        .states
    )
    assert sorted((states.normal_stress * 0.2).tolist()) == pytest.approx([1.0, 2.0])


def test_the_joint_of_two_blocks_from_either_side():
    model = spatial_model([BASE, box([0, 0, 0], [1, 1, 1]), box([1, 0, 0], [2, 1, 1])])
    joints = StartJoints(model)
    assert joints.neighbours(1) == [0, 2]
    there, back = joints.ends(1, 2), joints.ends(2, 1)
    assert there.normal == pytest.approx([1.0, 0.0, 0.0])
    assert back.normal == pytest.approx([-1.0, 0.0, 0.0])
    assert len(there.on_first) == 4
    ends = there.on_first + model.centroids[1]
    assert ends[:, 0] == pytest.approx(1.0)
    assert sorted(map(tuple, ends[:, 1:].round(12))) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert there.on_second + model.centroids[2] == pytest.approx(ends)
    assert joints.ends(0, 0) is None


def test_a_corner_on_a_face_is_a_joint_of_one_point():
    apex = hull(np.array([[0.3, 0.2, 0.0], [0.8, 0.2, 1.0], [0.0, 0.7, 1.0], [0.0, -0.3, 1.0]]))
    places = DrawnJoints(spatial_model([BASE, apex])).places
    assert places.starts.tolist() == [0, 1]
    assert places.corners == pytest.approx(np.array([[0.3, 0.2, 0.0]]))
    assert places.length == pytest.approx([0.0])


def test_gaps_that_close_and_gaps_that_are_named():
    """As in the plane: 0.05 % of the smaller part closes like a joint, 2 % is named, what only passes by is not."""
    size = np.sqrt(3.0)
    blocks = [BASE]
    for i, gap in enumerate((0.0, 5e-4 * size, 0.02 * size, 0.2 * size)):
        blocks.append(shifted(box([-1.9, 0, 0], [-0.9, 1, 1]), [1.2 * i, 0.0, gap]))
    wide = box([-30.0, -2.0, -0.5], [30.0, 2.0, 0.0])
    model = spatial_model([wide, *blocks[1:]])
    found = gaps_of_start(model)
    assert found.blocks.tolist() == [[0, 2], [0, 3]]
    assert found.widths == pytest.approx([5e-4 * size, 0.02 * size])
    assert found.close.tolist() == [True, False]


def test_a_block_that_stands_on_an_edge_of_a_narrow_wedge():
    tilt = 0.01
    turn = matrices(np.array([[0.0, tilt, 0.0]]))[0]
    block = box([-1.0, 0.0, 0.0], [0.0, 1.0, 1.0])
    model = spatial_model([BASE, Polyhedron(block.vertices @ turn.T, block.faces)])
    found = wedges_of_start(model, one_joint())
    assert found.blocks.tolist() == [[0, 1]]
    assert found.widths == pytest.approx([np.sin(tilt)], rel=1e-3)


@pytest.mark.parametrize(("tilt", "wedges"), [(0.05, 1), (0.2, 0), (0.5, 0)])
def test_a_deep_joint_is_a_wedge_by_its_slope_not_by_its_depth(tilt, wedges):
    """0.2 m open at an angle, 3 m through the thickness; above STEEPEST it is a corner on a face."""
    turn = matrices(np.array([[0.0, tilt, 0.0]]))[0]
    block = box([-0.2, -1.5, 0.0], [0.0, 1.5, 0.4])
    model = spatial_model([BASE, Polyhedron(block.vertices @ turn.T, block.faces)])
    found = wedges_of_start(model, one_joint())
    assert len(found.widths) == wedges
    assert found.widths == pytest.approx([0.2 * np.sin(tilt)] * wedges, rel=1e-2)


def test_areas_of_a_wall_are_those_of_its_contact_points():
    model = spatial_model(extruded([np.array([[i, 0], [i + 1, 0], [i + 1, 1], [i, 1]], float) for i in range(4)]), (0,))
    places, built = DrawnJoints(model).places, start_joints(model)
    assert places.blocks.tolist() == built.joints.blocks.tolist()
    assert places.area == pytest.approx(built.geometry.areas)
