"""Tangent stiffness of joints along their normals: springs of points, and elastic faces that are closed in part.

Of a face whose pressure is integrated (kernels/deformation/pressed_faces.py), K = ∫ kn N Nᵀ dA over its closed part,
with the same N: lines in closed form, outlines by their fans of triangles, each cut where its gap is zero.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from dem_cli.core.kernels.records import INTEGRATED, Joints

MASS = (np.ones((3, 3)) + np.eye(3)) / 12.0  # ∫ N Nᵀ dA over the area of a triangle
LEAST = 1e-12  # of the largest pivot: what is less counts as zero


def root_of_stiffness(joints: Joints, overlaps: np.ndarray) -> csr_array:
    """S with SᵀS = K, forces [N] by closing [m] of all points, (n_points, n_points); of points alone √kn.

    overlaps: of all points [m], (n_points,), 0: just closed, negative: open. A point alone acts where it is closed.
    """
    n, kn = len(joints.kn), np.where(overlaps >= 0.0, joints.kn, 0.0)
    whole = np.flatnonzero(joints.integrated == INTEGRATED)
    alone = np.ones(n, bool)
    rows, columns, values = [], [], []
    for points in _alike(joints, whole):
        alone[points.ravel()] = False
        root = _upper_root(_tangents(joints, points, overlaps[points]))
        count = points.shape[1]
        rows.append(np.repeat(points, count, axis=1).ravel())
        columns.append(np.tile(points, count).ravel())
        values.append(root.ravel())
    rest = np.flatnonzero(alone)
    found = [np.concatenate([rest, *each]) for each in (rows, columns)]
    root = csr_array((np.concatenate([np.sqrt(kn[rest]), *values]), tuple(found)), shape=(n, n))
    root.eliminate_zeros()
    return root


def _alike(joints: Joints, whole: np.ndarray) -> list[np.ndarray]:
    """Group joints by their number of contact points, in the order of their outlines, (n, count) each.

    Faces that may meet, and do not overlap, have none.
    """
    found: dict[int, list[list[int]]] = {}
    for joint in whole:
        if points := _around(joints, joint):
            found.setdefault(len(points), []).append(points)
    return [np.array(points) for _, points in sorted(found.items())]


def _around(joints: Joints, joint: int) -> list[int]:
    """Return the contact points of a joint with stiffness, in the order of its outline."""
    used = [p for p in range(joints.starts[joint], joints.starts[joint + 1]) if joints.kn[p] > 0.0]
    if len(used) < 3 or not joints.fans[used].any():
        return used
    order = used[:1]
    while len(order) < len(used):
        order.append(int(joints.after[order[-1]]))
    return order


def _tangents(joints: Joints, points: np.ndarray, overlaps: np.ndarray) -> np.ndarray:
    """K of joints whose points stand along their outlines, (n, count), all with overlaps [m]: (n, count, count)."""
    total = joints.kn[points].sum(axis=1)
    if points.shape[1] == 2:
        return total[:, None, None] * _of_line(overlaps)
    fans = joints.fans[points]
    if points.shape[1] < 2 or not fans.any():
        return joints.kn[points][:, None] * np.eye(points.shape[1]) * (overlaps >= 0.0)[:, None]
    n, count = points.shape
    weights = joints.kn[points] / total[:, None]
    middle = (weights * overlaps).sum(axis=1)
    found = np.zeros((n, count, count))
    for k in range(count):
        m = (k + 1) % count
        corners = np.zeros((n, 3, count))  # overlaps of the corners of a triangle by those of the points
        corners[:, 0], corners[:, 1, k], corners[:, 2, m] = weights, 1.0, 1.0
        part = _of_triangles(np.column_stack([middle, overlaps[:, k], overlaps[:, m]]))
        found += fans[:, k, None, None] * np.einsum("nai,nab,nbj->nij", corners, part, corners)
    return total[:, None, None] * found


def _of_line(overlaps: np.ndarray) -> np.ndarray:
    """∫ N Nᵀ ds over the closed part of lines, over their length; overlaps of both ends (n, 2): (n, 2, 2)."""
    low, high = overlaps.T
    across = (low >= 0.0) != (high >= 0.0)
    closed = np.where(low >= 0.0, 1.0, 0.0)
    closed[across] = (low / np.where(across, low - high, 1.0))[across]  # from the first end; from the other: turned
    turned = across & (high >= 0.0)
    c = np.where(turned, 1.0 - closed, closed)
    own, both, other = c - c**2 + c**3 / 3.0, c**2 / 2.0 - c**3 / 3.0, c**3 / 3.0
    first, second = np.where(turned, other, own), np.where(turned, own, other)
    return np.stack([np.stack([first, both], axis=1), np.stack([both, second], axis=1)], axis=1)


def _of_triangles(overlaps: np.ndarray) -> np.ndarray:
    """∫ N Nᵀ dA over the closed part of triangles, over their area; overlaps of corners (n, 3): (n, 3, 3)."""
    closed = overlaps >= 0.0
    count = closed.sum(axis=1)
    found = np.where((count > 0)[:, None, None], MASS, 0.0)
    for k in range(3):
        single = ((count == 1) & closed[:, k]) | ((count == 2) & ~closed[:, k])
        if not single.any():
            continue
        part = _corner(overlaps[single], k)
        found[single] = np.where((count[single] == 1)[:, None, None], part, MASS - part)
    return found


def _corner(overlaps: np.ndarray, k: int) -> np.ndarray:
    """∫ N Nᵀ dA of the part around corner k whose sign differs from that of both others, over the area, (n, 3, 3)."""
    here, apart = overlaps[:, [k]], overlaps[:, [k]] - overlaps
    apart[:, k] = np.inf
    shares = here / apart  # along the sides to the others, where the gap is zero
    corners = np.zeros((len(overlaps), 3, 3))  # of the part, by those of the triangle
    for m in range(3):
        corners[:, m, m] += shares[:, m]
        corners[:, m, k] += 1.0 - shares[:, m]
    area = np.prod(np.delete(shares, k, axis=1), axis=1)
    return area[:, None, None] * np.einsum("nai,ab,nbj->nij", corners, MASS, corners)


def _upper_root(matrices: np.ndarray) -> np.ndarray:
    """Rᵀ with R Rᵀ = K of positive semidefinite matrices (n, m, m), by Cholesky; vanishing pivots are left out."""
    left, m = matrices.copy(), matrices.shape[1]
    root = np.zeros_like(left)
    least = LEAST * np.einsum("nii->ni", left).max(axis=1, initial=0.0)
    for k in range(m):
        pivot = left[:, k, k]
        fits = pivot > least
        column = np.where(fits[:, None], left[:, :, k] / np.sqrt(np.where(fits, pivot, 1.0))[:, None], 0.0)
        column[:, :k] = 0.0
        root[:, k] = column
        left -= column[:, :, None] * column[:, None, :]
    return root
