"""Rotation in the plane and in space: the same vectors by angles, quaternions, matrices and cross products."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.geometry import rotation

RNG = np.random.default_rng(5)
PLANE, SPACE = RNG.normal(size=(7, 2)), RNG.normal(size=(7, 3))
ANGLES = RNG.uniform(-3.0, 3.0, 7)


def quaternions(axes: np.ndarray, angles: np.ndarray) -> np.ndarray:
    units = axes / np.linalg.norm(axes, axis=1)[:, None]
    return np.column_stack([np.cos(0.5 * angles), np.sin(0.5 * angles)[:, None] * units])


def about_z(angles: np.ndarray) -> np.ndarray:
    return quaternions(np.tile([0.0, 0.0, 1.0], (len(angles), 1)), angles)


def lifted(vectors: np.ndarray) -> np.ndarray:
    return np.column_stack([vectors, np.zeros(len(vectors))])


def test_turned_each_by_its_own_and_all_by_one():
    as_matrices = np.einsum("nij,nj->ni", rotation.matrices(ANGLES[:, None]), PLANE)
    assert rotation.turned(PLANE, ANGLES) == pytest.approx(as_matrices, abs=1e-15)
    assert rotation.turned_as_one(PLANE, 0.7) == pytest.approx(rotation.turned(PLANE, 0.7), abs=1e-15)
    assert np.array_equal(rotation.turned(PLANE, 0.0), PLANE)
    assert np.hypot(*rotation.turned(PLANE, ANGLES).T) == pytest.approx(np.hypot(*PLANE.T))


def test_across_is_a_quarter_turn():
    assert rotation.across(PLANE) == pytest.approx(rotation.turned(PLANE, 0.5 * np.pi), abs=1e-15)


def test_beside_is_square():
    normals = SPACE / np.linalg.norm(SPACE, axis=1)[:, None]
    found = rotation.beside(normals)
    assert (found * normals).sum(axis=1) == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1.0)
    assert np.array_equal(rotation.beside(PLANE), rotation.across(PLANE))


def test_the_plane_is_a_part_of_space():
    """Products, velocities and matrices of planar data are those of the same data in space."""
    other = RNG.normal(size=(7, 2))
    assert np.array_equal(rotation.cross(PLANE, other), np.cross(lifted(PLANE), lifted(other))[:, 2])
    assert np.array_equal(rotation.moments(PLANE, other)[:, 0], rotation.moments(lifted(PLANE), lifted(other))[:, 2])
    spins = np.column_stack([np.zeros((7, 2)), ANGLES])
    planar = rotation.swept(ANGLES[:, None], PLANE)
    assert planar == pytest.approx(rotation.swept(spins, lifted(PLANE))[:, :2], abs=1e-15)
    flat, full = rotation.matrices(ANGLES[:, None]), rotation.matrices(about_z(ANGLES))
    assert full[:, :2, :2] == pytest.approx(flat, abs=1e-14)
    assert full[:, 2] == pytest.approx(np.tile([0.0, 0.0, 1.0], (7, 1)), abs=1e-15)


def test_swept_is_the_velocity_of_turned():
    h = 1e-6
    rate = (rotation.turned(PLANE, h * ANGLES) - rotation.turned(PLANE, -h * ANGLES)) / (2 * h)
    assert rotation.swept(ANGLES[:, None], PLANE) == pytest.approx(rate, abs=1e-9)


def test_matrices_of_quaternions_are_rotations():
    found = rotation.matrices(quaternions(SPACE, ANGLES))
    assert found @ found.swapaxes(1, 2) == pytest.approx(np.tile(np.eye(3), (7, 1, 1)), abs=1e-14)
    assert np.einsum("nij,nj->ni", found, SPACE) == pytest.approx(SPACE, abs=1e-14)  # the axis stays
    assert np.trace(found, axis1=1, axis2=2) == pytest.approx(1.0 + 2.0 * np.cos(ANGLES), abs=1e-14)


def test_how_far_and_about_what():
    found = rotation.rotation_vectors(quaternions(SPACE, ANGLES))
    units = SPACE / np.linalg.norm(SPACE, axis=1)[:, None]
    assert found == pytest.approx(ANGLES[:, None] * units, abs=1e-14)
    assert rotation.angles_of(quaternions(SPACE, ANGLES)) == pytest.approx(np.abs(ANGLES), abs=1e-14)
    assert np.array_equal(rotation.angles_of(ANGLES[:, None]), ANGLES)
    assert np.array_equal(rotation.rotation_vectors(ANGLES[:, None])[:, 0], ANGLES)
    assert rotation.rotation_vectors(-about_z(np.array([0.3]))) == pytest.approx(np.array([[0.0, 0.0, 0.3]]))


@pytest.mark.parametrize(("dimension", "identity"), [(2, np.eye(2)), (3, np.eye(3))])
def test_unturned_turns_nothing(dimension, identity):
    still = rotation.unturned(3, dimension)
    assert np.array_equal(rotation.matrices(still), np.tile(identity, (3, 1, 1)))
    assert not rotation.angles_of(still).any()
    assert not rotation.rotation_vectors(still).any()


def test_frames_in_the_plane_are_made_of_normals():
    stored = np.column_stack([PLANE, np.full((7, 2), np.nan)])
    assert np.array_equal(rotation.frames(stored, 2), np.stack([PLANE, rotation.across(PLANE)], axis=1))
    assert np.array_equal(rotation.frames(np.arange(18.0).reshape(2, 9), 3), np.arange(18.0).reshape(2, 3, 3))


def test_what_leans_is_the_upright_axis():
    """A turn about the vertical is none; in the plane the angle itself."""
    found = quaternions(SPACE, ANGLES)
    upright = rotation.matrices(found)[:, 2, 2]
    assert np.cos(rotation.leans_of(found)) == pytest.approx(upright, abs=1e-14)
    assert rotation.leans_of(quaternions(np.tile([0.0, 0.0, 1.0], (7, 1)), ANGLES)) == pytest.approx(0.0, abs=1e-15)
    assert np.array_equal(rotation.leans_of(ANGLES[:, None]), np.abs(ANGLES))
