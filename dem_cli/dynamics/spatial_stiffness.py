"""Geometric stiffness in space: how contact forces turn and shift when blocks with forces between them move.

With F the force on b at a point and A, B the arms of the point from both centroids, the motion of b against a there is

    r = v_b − v_a + ω_b × B − ω_a × A.

The force turns with the spin Ω = S_a ω_a + S_b ω_b of normal and tangents, and the point goes along with b by R r and
with a by the rest. So virtual motions r', ω' see that much more work to the second order,

    r' · (Ω × F) + (ω_a' × F) · R r + (ω_b' × F) · (r − R r) + F · (ω_b' × (ω_b × B)) − F · (ω_a' × (ω_a × A)),

whatever the point is: a corner of b on a face of a has S_b = 0 and R = 1, one of a on a face of b S_a = 0 (but for the
tangents, that turn with a) and R = 0, a crossing of two edges what its cross product says. The symmetric part of that,
times −1, is what has to be added to the stiffness of the springs. The other part changes no frequency to first order:
for blocks at rest it is that of slip which is counted along a direction of the other block, and nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from dem_cli.kernels.records import Bodies


def second_derivatives(forces: np.ndarray, arms: np.ndarray, spins: np.ndarray, follows: np.ndarray) -> np.ndarray:
    """Of the work of contact forces, (n_points, 12, 12), symmetric: x, rotation vector of a, then of b.

    forces: on b [N], (n_points, 3); arms: from the centroids of a and b [m], (n_points, 2, 3); spins: S_b, and S_a is
    the rest of 1, for what turns as one keeps its forces, (n_points, 3, 3); follows: R, (n_points, 3, 3).
    """
    n, unit = len(forces), np.eye(3)
    motion, found = np.zeros((n, 3, 12)), np.zeros((n, 12, 12))
    motion[:, :, :3], motion[:, :, 6:9] = -unit, unit
    turned = np.zeros((n, 3, 12))  # half of what forces, and moments by the way of the point, change by
    force = cross_matrices(forces)
    for side, spin, way in ((0, unit - spins, follows), (1, spins, unit - follows)):
        sign, arm, rotations = 2.0 * side - 1.0, arms[:, side], slice(6 * side + 3, 6 * side + 6)
        motion[:, :, rotations] = -sign * cross_matrices(arm)
        turned[:, :, rotations] = -0.5 * (force @ spin + way.swapaxes(1, 2) @ force)
        both = np.einsum("pi,pj->pij", forces, arm)
        found[:, rotations, rotations] = sign * (0.5 * (both + both.swapaxes(1, 2)) - _scaled_unit(both))
    mixed = motion.swapaxes(1, 2) @ turned
    return found + mixed + mixed.swapaxes(1, 2)


def cross_matrices(vectors: np.ndarray) -> np.ndarray:
    """Matrices of v ×, (n, 3, 3)."""
    found = np.zeros((len(vectors), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[:, k, j], found[:, j, k] = vectors[:, i], -vectors[:, i]
    return found


def _scaled_unit(matrices: np.ndarray) -> np.ndarray:
    """Unit matrices times the traces of others, (n, 3, 3)."""
    return np.trace(matrices, axis1=1, axis2=2)[:, None, None] * np.eye(3)
