"""Volume, centroid, second moments and principal axes of convex polyhedra and compounds of them: exact, all at once.

Signed tetrahedra from the mean corner of each part to the triangles of its faces: nothing is lost far from the origin.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.small_matrices import determinants, diagonalised
from dem_cli.core.geometry.topology import Topology

DIAGONAL = 1e-13  # of the trace: products of inertia that are round-off


class VolumeProperties(NamedTuple):
    """Volume, centroid and second moments of n polyhedra or bodies."""

    volume: np.ndarray  # [m3], (n,)
    centroid: np.ndarray  # [m], (n, 3)
    second_moments: np.ndarray  # ∫ x xᵀ dV about the centroid [m5], (n, 3, 3)


class Triangles(NamedTuple):
    """Faces of parts cut into triangles, each from the first corner of its face."""

    corners: np.ndarray  # (n, 3) int64
    faces: np.ndarray  # face of each, (n,)


def triangles_of(topology: Topology) -> Triangles:
    """Cut all faces of a topology into triangles."""
    counts = np.diff(topology.face_starts) - 2
    faces = np.repeat(np.arange(topology.n_faces), counts)
    within = np.arange(len(faces)) - np.repeat(np.cumsum(counts) - counts, counts)
    first = topology.face_starts[:-1][faces]
    places = np.column_stack([first, first + within + 1, first + within + 2])
    return Triangles(topology.face_corners[places], faces)


def face_areas(vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """Compute the area of each face times its outward normal [m²], (n_faces, 3)."""
    triangles = triangles_of(topology)
    a, b, c = (vertices[triangles.corners[:, i]] for i in range(3))
    return _sums(0.5 * np.cross(b - a, c - a), triangles.faces, topology.n_faces)


def unit_vectors(vectors: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Divide vectors (n, 3) by their lengths (n,); zero where a length is zero, as of sides of flat blocks."""
    return vectors / np.where(lengths == 0.0, 1.0, lengths)[:, None]


def properties_of_all(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> VolumeProperties:
    """Volume properties of m polyhedra; polyhedron p has the corners vertices[part_starts[p]:part_starts[p + 1]]."""
    counts, n = np.diff(part_starts), len(part_starts) - 1
    origin = np.add.reduceat(vertices, part_starts[:-1], axis=0) / counts[:, None]
    local = vertices - np.repeat(origin, counts, axis=0)
    triangles = triangles_of(topology)
    parts = topology.face_parts[triangles.faces]
    a, b, c = (local[triangles.corners[:, i]] for i in range(3))
    volumes = (a * np.cross(b, c)).sum(axis=1) / 6.0
    total = a + b + c
    squares = sum(x[:, :, None] * x[:, None, :] for x in (a, b, c, total))
    volume = np.bincount(parts, volumes, n)
    first = _sums(volumes[:, None] * total / 4.0, parts, n)
    second = _sums((volumes[:, None, None] * squares / 20.0).reshape(-1, 9), parts, n).reshape(-1, 3, 3)
    offset = first / np.where(volume == 0.0, 1.0, volume)[:, None]
    second = second - volume[:, None, None] * offset[:, :, None] * offset[:, None, :]
    return VolumeProperties(volume, origin + offset, second)


def compound(parts: VolumeProperties, groups: np.ndarray, n_groups: int) -> VolumeProperties:
    """Combine the volume properties of parts into bodies, by parallel axes; part p belongs to body groups[p]."""
    volume = np.bincount(groups, parts.volume, n_groups)
    first = np.zeros((n_groups, 3))
    first[groups[::-1]] = parts.centroid[::-1]  # a point of each body, against loss of digits
    local = parts.centroid - first[groups]
    shift = _sums(parts.volume[:, None] * local, groups, n_groups) / np.where(volume == 0.0, 1.0, volume)[:, None]
    arms = local - shift[groups]
    moved = parts.second_moments + parts.volume[:, None, None] * arms[:, :, None] * arms[:, None, :]
    second = _sums(moved.reshape(-1, 9), groups, n_groups).reshape(-1, 3, 3)
    return VolumeProperties(volume, first + shift, second)


def inertia_tensors(second_moments: np.ndarray) -> np.ndarray:
    """Compute inertia tensors at unit density, tr(S) 1 − S [m5], (n, 3, 3), from second moments S."""
    traces = np.trace(second_moments, axis1=1, axis2=2)
    return traces[:, None, None] * np.eye(3) - second_moments


def principal(tensors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute principal moments (n, 3) and axes: unit quaternions from principal axes to those of the tensors, (n, 4).

    Of the orders of the axes, one that turns them little: a body along the axes has the identity.
    """
    scale = np.trace(tensors, axis1=1, axis2=2)[:, None, None]
    tidy = np.where((np.abs(tensors) <= DIAGONAL * scale) & ~np.eye(3, dtype=bool), 0.0, tensors)
    moments, axes = diagonalised(tidy)
    order = np.empty((len(tensors), 3), np.int64)
    rows, free = np.arange(len(tensors)), np.ones((len(tensors), 3), bool)
    for k in range(3):  # of the columns that are left, that which is nearest to axis k
        order[:, k] = np.where(free, np.abs(axes[:, k]), -1.0).argmax(axis=1)
        free[rows, order[:, k]] = False
    moments = np.take_along_axis(moments, order, axis=1)
    axes = np.take_along_axis(axes, order[:, None, :], axis=2)
    signs = np.where(np.diagonal(axes, axis1=1, axis2=2) < 0.0, -1.0, 1.0)
    axes = axes * signs[:, None, :]
    axes[:, :, 2] *= np.where(determinants(axes) < 0.0, -1.0, 1.0)[:, None]
    return moments, quaternions_of(axes)


def quaternions_of(matrices: np.ndarray) -> np.ndarray:
    """Convert rotation matrices (n, 3, 3) to unit quaternions, scalar first and not negative, (n, 4); Shepperd 1978."""
    m = matrices
    xx, yy, zz = m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]
    products = np.empty((len(m), 4, 4))  # 4 q qᵀ
    for i, square in enumerate((1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)):
        products[:, i, i] = square
    for i, j, value in (
        (0, 1, m[:, 2, 1] - m[:, 1, 2]), (0, 2, m[:, 0, 2] - m[:, 2, 0]), (0, 3, m[:, 1, 0] - m[:, 0, 1]),
        (1, 2, m[:, 0, 1] + m[:, 1, 0]), (1, 3, m[:, 0, 2] + m[:, 2, 0]), (2, 3, m[:, 1, 2] + m[:, 2, 1]),
    ):  # fmt: skip
        products[:, i, j] = products[:, j, i] = value
    largest = np.diagonal(products, axis1=1, axis2=2).argmax(axis=1)
    found = products[np.arange(len(m)), largest]
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    return found * np.where(found[:, :1] < 0.0, -1.0, 1.0)


def _sums(values: np.ndarray, groups: np.ndarray, n: int) -> np.ndarray:
    """Sum rows (m, k) by group, (n, k)."""
    return np.stack([np.bincount(groups, values[:, k], n) for k in range(values.shape[1])], axis=1)
