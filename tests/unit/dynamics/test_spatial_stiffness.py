"""Geometric stiffness of contact points in space against differences of their forces, whatever a point is."""

from __future__ import annotations

import numpy as np
import pytest
from oracle.contact_in_space import BOTH, CROSSING, FACE_OF_A, FACE_OF_B, ContactPoint

from dem_cli.core.dynamics.spatial_stiffness import Attachment, cross_matrices, second_derivatives


def unit(values) -> np.ndarray:
    return np.array(values) / np.linalg.norm(values)


NORMAL = unit([0.2, -0.3, 1.0])
TANGENT = unit(np.cross(NORMAL, [0.3, 1.0, 0.1]))
EDGES = (unit(TANGENT + 0.3 * np.cross(NORMAL, TANGENT)), unit(np.cross(NORMAL, TANGENT) - 0.5 * TANGENT))


def spins_of(kind: str) -> np.ndarray:
    """Of the frame per spin of b, by hand: its normal by what makes it, its tangents about the normal with a."""
    flat = np.eye(3) - np.outer(NORMAL, NORMAL)
    if kind == CROSSING:
        d, h = EDGES
        length = np.linalg.norm(np.cross(d, h)) * np.sign(np.cross(d, h) @ NORMAL)
        return cross_matrices(NORMAL[None])[0] @ ((d @ h) * flat - np.outer(h, d)) / length
    return {FACE_OF_A: 0.0, FACE_OF_B: 1.0, BOTH: 0.5}[kind] * flat


def follows_of(kind: str) -> np.ndarray:
    """How the point goes along with b."""
    d, h = EDGES
    if kind == CROSSING:
        return np.outer(d, np.cross(h, NORMAL)) / (np.cross(d, h) @ NORMAL)
    return {FACE_OF_A: 1.0, FACE_OF_B: 0.0, BOTH: 0.5}[kind] * np.eye(3)


@pytest.mark.parametrize("kind", [FACE_OF_A, FACE_OF_B, BOTH, CROSSING])
def test_second_derivatives_are_those_of_the_forces(kind):
    """The symmetric part of what the forces change by; central differences, measured 1e-9 of the largest."""
    kn, ks, pressed, slip = 30.0, 20.0, 0.05, np.array([0.04, -0.03])
    place, apart = np.array([0.5, 0.3, 0.4]), np.array([0.7, -0.2, 1.3])
    point = ContactPoint(kind, place, NORMAL, TANGENT, apart, kn, ks, pressed, slip, EDGES)
    step, found = 1e-5, np.zeros((12, 12))
    for k in range(12):
        motion = np.zeros(12)
        motion[k] = step
        found[:, k] = (point.forces(-motion) - point.forces(motion)) / (2.0 * step)
    along = np.array([NORMAL, TANGENT, np.cross(NORMAL, TANGENT)])
    arms = np.array([place, place - apart])
    rows = np.hstack([-along, np.cross(along, arms[0]), along, -np.cross(along, arms[1])])
    springs = rows.T @ np.diag([kn, ks, ks]) @ rows
    force = kn * pressed * NORMAL - ks * slip @ along[1:]
    geometric = -second_derivatives(force[None], arms[None], Attachment(spins_of(kind)[None], follows_of(kind)[None]))[
        0
    ]
    assert np.abs(geometric).max() > 0.1
    assert 0.5 * (found + found.T) == pytest.approx(springs + geometric, abs=1e-8 * np.abs(geometric).max())
