"""Joints of the start by joint: frames, levers and points of every point, worked out from one plane each."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, scene, tables

from dem_cli.core.contact.joint_planes import in_planes
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.kernels.records import FixedJoints, MovingJoints
from dem_cli.core.model.scales import smallest_edge

N_BLOCKS, COUNTS = 4, np.array([1, 4, 3, 5, 2])


def scattered(d: int, rng: np.random.Generator) -> tuple[MovingJoints, np.ndarray]:
    """Joints with any number of points each, all in one plane, and the centroids of their blocks."""
    r, owners = d * (d - 1) // 2, np.repeat(np.arange(len(COUNTS)), COUNTS)
    directions = np.linalg.qr(rng.normal(size=(len(COUNTS), d, d)))[0]
    directions[:, -1] *= np.linalg.det(directions)[:, None]
    centroids = rng.normal(size=(N_BLOCKS, d))
    blocks = np.array([rng.choice(N_BLOCKS, 2, replace=False) for _ in COUNTS])
    places = rng.normal(size=(len(owners), d - 1))
    points = rng.normal(size=(len(COUNTS), d))[owners] + (places[:, :, None] * directions[owners, 1:]).sum(axis=1)
    arms = (points[:, None] - centroids[blocks[owners]])[:, :, None]
    along = directions[owners][:, None]
    levers = np.cross(arms, along) if d == 3 else arms[..., 0] * along[..., 1] - arms[..., 1] * along[..., 0]
    return MovingJoints(
        blocks, np.concatenate([[0], np.cumsum(COUNTS)]), directions[owners].reshape(-1, d * d),
        levers.reshape(-1, 2 * d * r), points, rng.uniform(1, 2, len(owners)), rng.uniform(1, 2, len(owners)),
        np.zeros((len(COUNTS), 1)),
    ), centroids  # fmt: skip


@pytest.mark.parametrize("d", [2, 3])
def test_points_of_a_plane_are_read_as_they_were_written(d):
    rng = np.random.default_rng(d)
    placed, centroids = scattered(d, rng)
    joints = in_planes(placed, rng.uniform(size=len(placed.kn)), centroids)
    assert joints.places.shape == (COUNTS.sum(), d - 1)
    for name in ("frames", "levers", "points"):
        assert getattr(joints, name) == pytest.approx(getattr(placed, name), abs=1e-14), name
    for name in ("blocks", "starts", "owners", "kn", "ks", "law"):
        assert np.array_equal(getattr(joints, name), getattr(placed, name)), name


def test_a_plane_goes_through_the_closest_point():
    """A block that stands on its lower corner only: the normal of that end, levers of the other along it alone."""
    tilted = [[0.0, 0.0], [1.0, 0.1], [1.0, 1.1], [0.0, 1.0]]
    made = scene(tables(block("base", rectangle(-1, -1, 2, 0), fixed=True), block("b", tilted)))
    model = made.model
    bodies = bodies_at_rest(model)
    built = joints_of_start(model, bodies, joint_properties(made.request, model, 1e6), smallest_edge(model))
    joints, gaps = built.joints, built.contacts.gaps
    assert isinstance(joints, FixedJoints)
    closest = int(gaps.argmin())
    assert (gaps[closest], gaps[1 - closest]) == (0.0, pytest.approx(0.1, rel=0.01))
    normals = joints.frames[:, :2]
    assert np.array_equal(normals[0], normals[1])
    assert joints.points[closest] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert (joints.points - joints.points[closest]) @ normals[0] == pytest.approx([0.0, 0.0], abs=1e-15)


def test_joints_of_the_start_take_less_memory_than_their_points_one_by_one():
    made = scene(tables(*running_wall(4, 5)))
    model = made.model
    built = joints_of_start(
        model, bodies_at_rest(model), joint_properties(made.request, model, 1e6), smallest_edge(model)
    )
    joints = built.joints
    one_by_one = joints.frames.nbytes + joints.levers.nbytes + joints.points.nbytes
    assert joints.axes.nbytes + joints.anchors.nbytes + joints.arms.nbytes + joints.places.nbytes < 0.6 * one_by_one
