"""Rotation of vectors in the plane and in space: by angles or unit quaternions, quarter turns, cross products, moments.

Orientations of n blocks are (n, 1), angles [rad], (n, 4), unit quaternions with the scalar first, or (n, 3), rotation
vectors, axis times angle [rad]: small ones add up, as those of geometry of the start do. Vectors are (n, 2) or (n, 3),
spins and moments (n, 1) or (n, 3): the lengths say the dimension. Kernels have their own (kernels/vec.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product


def turned_by(vectors: np.ndarray, cosines: np.ndarray | float, sines: np.ndarray | float) -> np.ndarray:
    """Turn vectors (..., 2) by angles given by cosines and sines, one for each or one for all."""
    x, y = vectors[..., 0], vectors[..., 1]
    first = np.asarray(cosines * x - sines * y)
    found = np.empty((*first.shape, 2))
    found[..., 0], found[..., 1] = first, sines * x + cosines * y
    return found


def turned(vectors: np.ndarray, angles: np.ndarray | float) -> np.ndarray:
    """Turn vectors (n, 2) about the origin, each by its own angle [rad] or all by one; 0 is exact."""
    return turned_by(vectors, np.cos(angles), np.sin(angles))


def turned_as_one(vectors: np.ndarray, rotation: np.ndarray | float) -> np.ndarray:
    """Turn vectors (n, d) about the origin by one angle or one rotation vector (3,) [rad], with matrices."""
    if vectors.shape[1] == 3:
        return product(vectors, matrices(np.reshape(rotation, (1, 3)))[0].T)
    angle = float(np.asarray(rotation).item())
    c, s = np.cos(angle), np.sin(angle)
    return product(vectors, np.array([[c, s], [-s, c]]))


def across(vectors: np.ndarray) -> np.ndarray:
    """Turn vectors by +90°, (..., 2): velocities of their tips at unit spin."""
    found = np.empty((*vectors.shape[:-1], 2))
    found[..., 0], found[..., 1] = -vectors[..., 1], vectors[..., 0]
    return found


def beside(normals: np.ndarray) -> np.ndarray:
    """Find a unit vector perpendicular to each unit vector, (n, d): in the plane turned by +90°."""
    if normals.shape[1] == 2:
        return across(normals)
    found = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=1)])
    return found / np.linalg.norm(found, axis=1)[:, np.newaxis]


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Compute the cross product in the plane, (...): how far b lies to the left of a, times the length of a."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def moments(arms: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Compute the moments of forces about the origin of their arms, arm × force, (n, r)."""
    return cross(arms, forces)[:, np.newaxis] if arms.shape[1] == 2 else np.cross(arms, forces)


def swept(spins: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Compute the velocities of the tips of arms (..., d) that turn with spins (..., r): ω × arm, (..., d)."""
    return spins * across(arms) if arms.shape[-1] == 2 else np.cross(spins, arms)


def turning(orientations: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Make a function that turns vectors (..., d) with blocks of these orientations, (..., 1), (..., 3) or (..., 4).

    What the orientations give, cosines or matrices, is worked out once.
    """
    if orientations.shape[-1] == 1:
        cosines, sines = np.cos(orientations[..., 0]), np.sin(orientations[..., 0])
        return lambda vectors: turned_by(vectors, cosines, sines)
    flat = matrices(orientations.reshape(-1, orientations.shape[-1]))
    turns = flat.reshape(*orientations.shape[:-1], 3, 3)
    return lambda vectors: np.einsum("...ij,...j->...i", turns, vectors)


def frames(stored: np.ndarray, dimension: int) -> np.ndarray:
    """Unpack unit normals and tangents, (n, d, d), from frames (n, d·d); in the plane only normals are up to date."""
    if dimension == 2:
        return np.stack([stored[:, :2], across(stored[:, :2])], axis=1)
    return stored.reshape(-1, dimension, dimension)


def along_frames(stored: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Compose vectors (n, d) from their components along the normals and tangents of frames (n, d·d)."""
    total: np.ndarray = (values[:, :, None] * frames(stored, values.shape[1])).sum(axis=1)
    return total


def tangents_of(normals: np.ndarray, first: np.ndarray) -> list[np.ndarray]:
    """Tangents of each normal, d − 1 of (n, d): in the plane turned by +90°, in space `first` and normal × first."""
    return [across(normals)] if normals.shape[1] == 2 else [first, np.cross(normals, first)]


def unturned(n: int, dimension: int) -> np.ndarray:
    """Make the orientations of n blocks that have not turned, (n, 1) or (n, 4)."""
    return np.zeros((n, 1)) if dimension == 2 else np.tile((1.0, 0.0, 0.0, 0.0), (n, 1))


def oriented_as(others: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Convert rotations (n, r) from the start [rad] to orientations in the representation of others."""
    return rotations if others.shape[1] == rotations.shape[1] else quaternions(rotations)


def turned_further(orientations: np.ndarray, rotations: np.ndarray | float) -> np.ndarray:
    """Turn orientations further about the world axes: by angles, or rotation vectors (3,) or (n, 3) [rad]."""
    if orientations.shape[1] < 4:
        return orientations + rotations
    return _after(quaternions(np.reshape(rotations, (-1, 3))), orientations)


def turned_since(orientations: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Compute the rotation between two orientations, (n, r): in space rotation vectors along the world axes [rad]."""
    if orientations.shape[1] < 4:
        return orientations - before
    return rotation_vectors(_after(orientations, before * (1.0, -1.0, -1.0, -1.0)))


def _after(second: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Multiply unit quaternions: the first turn, then the second, (n, 4)."""
    scalar, vector, start, arm = second[:, :1], second[:, 1:], first[:, :1], first[:, 1:]
    real = scalar * start - (vector * arm).sum(axis=1, keepdims=True)
    found = np.column_stack([real, scalar * arm + start * vector + np.cross(vector, arm)])
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def angles_of(orientations: np.ndarray) -> np.ndarray:
    """Angle by which each block has turned [rad], (n,): with its sign in the plane, from 0 to π in space."""
    if orientations.shape[1] == 1:
        return orientations[:, 0]
    if orientations.shape[1] == 3:
        return np.linalg.norm(orientations, axis=1)
    return 2.0 * functions.arctan2(np.linalg.norm(orientations[:, 1:], axis=1), np.abs(orientations[:, 0]))


def leans_of(orientations: np.ndarray) -> np.ndarray:
    """Tilt of each block from the upright [rad], (n,): the angle in the plane, in space that of z, from 0 to π."""
    if orientations.shape[1] == 1:
        return np.abs(orientations[:, 0])
    _, x, y, _ = quaternions(orientations).T
    return 2.0 * functions.arcsin(np.clip(np.hypot(x, y), 0.0, 1.0))


def largest_angle_between(one: np.ndarray, other: np.ndarray) -> float:
    """Compute the largest angle by which any block has turned between two orientations [rad]: in space up to π."""
    if one.shape[1] == 4:
        return 2.0 * math.acos(min(float(np.abs((one * other).sum(axis=1)).min(initial=1.0)), 1.0))
    return math.sqrt(((one - other) ** 2).sum(axis=1).max(initial=0.0))


def rotation_vectors(orientations: np.ndarray) -> np.ndarray:
    """Axis times angle of each rotation [rad], (n, r): in the plane the angle, in space the shorter way round."""
    if orientations.shape[1] < 4:
        return orientations
    shorter = orientations * np.where(orientations[:, :1] < 0.0, -1.0, 1.0)
    sines = np.linalg.norm(shorter[:, 1:], axis=1, keepdims=True)
    angles = 2.0 * functions.arctan2(sines, shorter[:, :1])
    return shorter[:, 1:] * np.divide(angles, sines, out=np.full_like(sines, 2.0), where=sines > 0.0)


def quaternions(orientations: np.ndarray) -> np.ndarray:
    """Convert orientations for frames: angles in the plane (n, 1), unit quaternions in space (n, 4)."""
    if orientations.shape[1] != 3:
        return orientations.copy()
    angles = np.linalg.norm(orientations, axis=1, keepdims=True)
    half = 0.5 * np.sinc(angles / (2.0 * np.pi))  # sin(θ/2)/θ
    return np.column_stack([np.cos(0.5 * angles), half * orientations])


def turns_of(orientations: np.ndarray) -> np.ndarray:
    """Convert orientations for kernels: cosine and sine in the plane (n, 2), matrices row by row in space (n, 9)."""
    if orientations.shape[1] == 1:
        return np.column_stack([np.cos(orientations[:, 0]), np.sin(orientations[:, 0])])
    return matrices(orientations).reshape(-1, 9)


def matrices(orientations: np.ndarray) -> np.ndarray:
    """Compute rotation matrices: (n, 1) angles -> (n, 2, 2); (n, 4) unit quaternions or (n, 3) vectors -> (n, 3, 3)."""
    if orientations.shape[1] == 1:
        c, s = np.cos(orientations[:, 0]), np.sin(orientations[:, 0])
        return np.stack((np.stack((c, -s), axis=1), np.stack((s, c), axis=1)), axis=1)
    w, x, y, z = quaternions(orientations).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)
