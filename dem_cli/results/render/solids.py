"""Surfaces of the blocks in space: faces with corners fixed to a block, and the poses of blocks in a frame.

2D blocks are extruded by their thickness, half of it to either side of the plane, and get a narrow chamfer, as
dressed stones have: light makes the joints visible. Polyhedra have theirs from render/chamfered.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import across, cross, matrices
from dem_cli.core.model.model import Model
from dem_cli.results.post import frame_measures
from dem_cli.results.render.chamfered import Surface, chamfered

_CHAMFER = 0.05  # of the narrowest side of an ordinary block
_LARGEST_CHAMFER = 0.006  # of the size of the structure
_WIDEST_CHAMFER = 0.16  # of the narrowest side of the block itself
_SAME_PLACE = 1e-6  # of the size of a part: edges so close are one


class Pose(NamedTuple):
    """Pose of all blocks: positions and rotations."""

    positions: np.ndarray  # centroids [m], (n_blocks, 3)
    turns: np.ndarray  # rotation matrices, (n_blocks, 3, 3)


def pose(positions: np.ndarray, orientations: np.ndarray) -> Pose:
    """Create poses from centroids (n_blocks, d) and angles or quaternions; 2D blocks lie in the plane z = 0."""
    found = matrices(orientations)
    n, d = positions.shape
    turns = np.tile(np.eye(3), (n, 1, 1))
    turns[:, :d, :d] = found
    return Pose(lifted(positions), turns)


def lifted(vectors: np.ndarray, height: np.ndarray | float = 0.0) -> np.ndarray:
    """Extend vectors to three components; the third one of those in the plane is `height`."""
    if vectors.shape[1] == 3:
        return vectors
    return np.column_stack([vectors, np.broadcast_to(height, len(vectors))])


def placed(surface: Surface, where: Pose) -> np.ndarray:
    """Compute the corners in space [m], (n, 3)."""
    turned = np.einsum("nij,nj->ni", where.turns[surface.owners], surface.points)
    return where.positions[surface.owners] + turned


def surface(model: Model) -> Surface:
    """Create the faces of all blocks."""
    return SURFACES[model.dimension](model)


def prisms(model: Model) -> Surface:
    """Create the faces of all blocks of a 2D model."""
    widths = [narrowest(part_corners(model, p)) for p in range(model.n_parts)]
    usual = min(_CHAMFER * float(np.median(widths)), _LARGEST_CHAMFER * frame_measures.size(model))
    points, owners, faces, face_owners, edges = [], [], [], [], []
    count = 0
    for p, block in enumerate(model.part_blocks):
        corners = part_corners(model, p)
        chamfer = min(usual, _WIDEST_CHAMFER * widths[p])
        inner = inner_edges(model, p)
        around = inset(corners, np.where(inner, 0.0, chamfer))
        half = 0.5 * float(model.thickness[block])
        n = len(corners)
        rings = [(around, -half), (corners, chamfer - half), (corners, half - chamfer), (around, half)]
        points += [lifted(ring, z) for ring, z in rings]
        owners.append(np.full(4 * n, block))
        here = [[count + n - 1 - k for k in range(n)], [count + 3 * n + k for k in range(n)]]
        for low in range(3):
            base = count + low * n
            here += [[base + k, base + (k + 1) % n, base + n + (k + 1) % n, base + n + k] for k in range(n)]
        faces += [[len(face), *face] for face in here]
        face_owners.append(np.full(len(here), block))
        edges += _sharp_edges(inner, count)
        count += 4 * n
    flat = np.array([number for face in faces for number in face], dtype=np.int64)
    return Surface(np.concatenate(points), np.concatenate(owners), flat, np.concatenate(face_owners), np.array(edges))


def _sharp_edges(inner: np.ndarray, first: int) -> list[tuple[int, int]]:
    """Return the edges of a prism whose second and third ring of points are its outlines; none inside a block."""
    n = len(inner)
    back, front = first + n, first + 2 * n
    found = []
    for k in range(n):
        if not inner[k]:
            found += [(ring + k, ring + (k + 1) % n) for ring in (back, front)]
            if not inner[k - 1]:
                found.append((back + k, front + k))
    return found


def part_corners(model: Model, part: int) -> np.ndarray:
    """Return the corners of a convex part from the centroid of its block [m], (n, d)."""
    return model.vertices[model.part_starts[part] : model.part_starts[part + 1]]


def narrowest(corners: np.ndarray) -> float:
    """Return the smallest width of a convex polygon [m]."""
    normals = _inward(corners)
    reach = (corners[np.newaxis] - corners[:, np.newaxis]) @ normals[:, :, np.newaxis]
    return float(reach[..., 0].max(axis=1).min())


def inset(corners: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Move each edge of a convex polygon inwards by its distance [m]; corner k lies on the edges k − 1 and k."""
    normals = _inward(corners)
    before = np.roll(normals, 1, axis=0)
    turn = cross(before, normals)
    a, b = np.roll(distances, 1), distances
    straight = np.abs(turn) < 1e-9  # the two edges lie on one line
    scale = np.where(straight, 1.0, turn)
    moved = np.stack((a * normals[:, 1] - b * before[:, 1], b * before[:, 0] - a * normals[:, 0]), axis=1)
    return corners + np.where(straight[:, np.newaxis], b[:, np.newaxis] * normals, moved / scale[:, np.newaxis])


def inner_edges(model: Model, part: int) -> np.ndarray:
    """Test which edges of a part lie against another part of the same block, (n,) bool, so that no joint is seen."""
    block, corners = model.part_blocks[part], part_corners(model, part)
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    found = np.zeros(len(corners), dtype=bool)
    for other in np.flatnonzero(model.part_blocks == block):
        if other != part:
            theirs = part_corners(model, int(other))
            depths = np.einsum("mkd,kd->mk", middles[:, np.newaxis] - theirs, _inward(theirs))
            found |= depths.min(axis=1) > -_SAME_PLACE * np.ptp(corners, axis=0).max()
    return found


def _inward(corners: np.ndarray) -> np.ndarray:
    """Return unit normals of the edges of a counter-clockwise polygon, into it, (n, 2); edge k starts at corner k."""
    along = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    return across(along) / np.where(lengths > 0.0, lengths, 1.0)


SURFACES = {2: prisms, 3: chamfered}
