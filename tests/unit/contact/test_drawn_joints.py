"""Joints as they were drawn: distances of turned blocks in closed form, forces to the joint that they go through."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, tables
from synthetic import boxes_model, no_contacts

from dem_cli.core.contact.drawn_joints import OPEN, SLIDING, STICKING, DrawnJoints
from dem_cli.core.geometry.rotation import turned_as_one
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord

B, H, DEPTH = 0.5, 2.0, 0.080


@pytest.fixture(scope="module")
def pair() -> Model:
    """A block on a wide base; the base is block 0."""
    return boxes_model([(-2.0, -0.5, 4.0, 0.5, True), (0.0, 0.0, B, H, False)])


def points(places, normal_forces, shears, states, blocks=(0, 1)) -> ContactRecord:
    n = len(places)
    return ContactRecord(
        np.zeros(n, np.int64), np.tile(blocks, (n, 1)), np.array(places, float), np.tile((0.0, 1.0), (n, 1)),
        np.array(normal_forces, float), np.array(shears, float)[:, np.newaxis], np.zeros(n), np.zeros(n),
        np.array(states, np.int8),
    )  # fmt: skip


def at_rest(model: Model) -> tuple[np.ndarray, np.ndarray]:
    return model.centroids.copy(), np.zeros((model.n_blocks, 1))


def test_where_joints_are(pair):
    places = DrawnJoints(pair).places
    assert places.blocks.tolist() == [[0, 1]]
    np.testing.assert_allclose(places.normals, [[0.0, 1.0]])
    np.testing.assert_allclose(np.sort(places.ends[0, :, 0]), [0.0, B], atol=1e-15)
    assert places.length == pytest.approx([B])
    assert places.area == pytest.approx([B * DEPTH])


def test_a_block_that_rocks(pair):
    """About its right corner, by θ: the far end opens by B sin θ, the near one not; it slides by B (cos θ − 1)/2."""
    theta, corner = -0.3, np.array([B, 0.0])
    positions, angles = at_rest(pair)
    positions[1] = corner + turned_as_one(positions[[1]] - corner, theta)[0]
    angles[1] = theta
    now = DrawnJoints(pair).at(positions, angles, no_contacts())
    wide = B * np.sin(-theta)
    np.testing.assert_allclose(np.sort(now.gaps[0]), [0.0, wide], atol=1e-15)
    np.testing.assert_allclose(now.states.opening, [0.5 * wide])
    np.testing.assert_allclose(now.states.crack_width, [wide])
    drift = 0.5 * B * (1.0 - np.cos(theta))  # of the far end to the right, the tangent points to the left
    np.testing.assert_allclose(now.states.slip, [-drift])
    np.testing.assert_allclose(now.ends[0, :, 1].max(), 0.5 * wide)
    assert now.states.state.tolist() == [OPEN]


def test_what_turns_with_the_first_block_is_no_motion(pair):
    """Both turned and moved as one: nothing opens, and stresses are across and along the turned joint."""
    theta, shift = 0.7, np.array([3.0, -1.0])
    positions, angles = at_rest(pair)
    positions, angles = turned_as_one(positions, theta) + shift, angles + theta
    ends = turned_as_one(np.array([[0.0, 0.0], [B, 0.0]]), theta) + shift
    contacts = points(ends, [30.0, 10.0], [4.0, 0.0], [2, 1])
    contacts = contacts._replace(normals=turned_as_one(contacts.normals, theta))
    states = DrawnJoints(pair).at(positions, angles, contacts).states
    for moved in (states.opening, states.crack_width, states.slip):
        np.testing.assert_allclose(moved, [0.0], atol=1e-14)
    np.testing.assert_allclose(states.normal_stress, [40.0 / (B * DEPTH)])
    np.testing.assert_allclose(states.shear_stress, [4.0 / (B * DEPTH)])
    np.testing.assert_allclose(states.eccentricity, [0.5 * B * 20.0 / 40.0])  # towards x = 0, where the tangent points
    assert states.state.tolist() == [SLIDING]


def test_a_gap_that_was_drawn_is_no_crack():
    """A block over a base whose top falls off by 1 in 50: drawn open at one end, and no wider until it has moved."""
    slope = 0.02 * B
    base = [[-1.0, -0.5], [B, -0.5], [B, -slope], [0.0, 0.0], [-1.0, 0.0]]
    model = scene(tables(block("base", base, fixed=True), block("above", rectangle(0.0, 0.0, B, H)))).model
    drawn = DrawnJoints(model)
    sides = (drawn.places.normals[:, 0] > 0.0).nonzero()[0]
    assert len(sides) == 1  # the sloping face, seen by the block above
    positions, angles = at_rest(model)
    now = drawn.at(positions, angles, no_contacts())
    np.testing.assert_allclose(now.gaps[sides].max(), slope, rtol=1e-3)
    np.testing.assert_allclose(now.states.crack_width, 0.0, atol=1e-15)
    positions[1] += (0.0, 0.003)
    np.testing.assert_allclose(drawn.at(positions, angles, no_contacts()).states.crack_width[sides], 0.003, rtol=1e-3)


def test_far_apart_it_is_the_same_joint(pair):
    positions, angles = at_rest(pair)
    positions[1] += (0.0, 5.0)
    states = DrawnJoints(pair).at(positions, angles, no_contacts()).states
    np.testing.assert_allclose([states.opening[0], states.crack_width[0]], 5.0)
    assert states.normal_stress.tolist() == states.eccentricity.tolist() == [0.0]


def test_forces_between_blocks_without_a_joint_are_left_out():
    model = boxes_model([(0, -1, 4, 1, True), (0, 0, 1, 1, False), (2, 0, 1, 1, False)])
    joints = DrawnJoints(model)
    assert joints.places.blocks.tolist() == [[0, 1], [0, 2]]
    states = joints.at(*at_rest(model), points([[1.5, 0.5]], [7.0], [0.0], [1], blocks=(1, 2))).states
    assert states.normal_stress.tolist() == [0.0, 0.0]


def test_two_joints_of_two_blocks():
    """A block in a step rests on its tread and leans on its riser: each force belongs to the nearer joint."""
    step = {"id": "step", "parts": [rectangle(0.0, 0.0, 3.0, 1.0), rectangle(0.0, 1.0, 1.0, 3.0)], "fixed": True}
    model = scene(tables(step, block("stone", rectangle(1.0, 1.0, 2.0, 2.0)))).model
    joints = DrawnJoints(model)
    assert joints.places.blocks.tolist() == [[0, 1], [0, 1]]
    tread = int(np.argmax(joints.places.normals[:, 1]))
    contacts = points([[1.5, 1.0], [1.0, 1.6]], [5.0, 3.0], [0.0, 0.0], [1, 1])
    contacts = contacts._replace(normals=np.array([[0.0, 1.0], [1.0, 0.0]]))
    states = joints.at(*at_rest(model), contacts).states
    force = states.normal_stress * joints.places.area
    np.testing.assert_allclose([force[tread], force[1 - tread]], [5.0, 3.0])
    assert states.state.tolist() == [STICKING, STICKING]
