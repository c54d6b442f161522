"""Common planes of neighbours: faces that should lie against each other, put back onto one plane; any dimension.

Files round coordinates, and drawings are not exact: a face of one block then lies 1e-6 m off that of the next, or in
it. Faces of different blocks that look at each other within a tolerance get one plane, fitted to all of their corners;
corners go to where the planes of their faces meet, by least squares. What is exact already stays as it is to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.connected_groups import connected_groups
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.arithmetic.small_matrices import least_squares, singular
from dem_cli.core.geometry.facets import Facets

EXACT = 1e-9  # of the size of a block: faces and corners so close to their planes stay where they are
FACING = -0.9  # cosine between the normals of faces that may look at each other
NEARLY_PARALLEL = 0.05  # of the largest singular value: planes that meet at a smaller angle do not place a corner
FARTHEST = 10.0  # tolerances: a corner that would go farther stays


class Snapped(NamedTuple):
    """Corners of all blocks after their faces were put onto common planes, with counts of the changes."""

    points: list[np.ndarray]  # of each block [m], (n, d)
    moved: int  # corners that moved
    farthest: float  # by which one moved at most [m]
    planes: int  # common planes that were fitted
    left: int  # groups of faces that lie too far from one plane, and corners that would go too far: left as they were


class _AllFaces(NamedTuple):
    """Faces of all blocks in one set of arrays, one block after the other."""

    owners: np.ndarray  # block of each, (n,)
    first: np.ndarray  # number of the first face of each block, (n_blocks,)
    normals: np.ndarray
    heights: np.ndarray
    corners: np.ndarray  # places of all corners of all faces [m], (m, d)
    starts: np.ndarray  # face f has corners[starts[f]:starts[f + 1]]
    low: np.ndarray  # box of each [m], (n, d)
    high: np.ndarray


def on_common_planes(blocks: Sequence[Facets], pairs: np.ndarray, tolerance: float) -> Snapped:
    """Move the corners of blocks so that faces which nearly lie in one plane lie in it exactly.

    pairs: numbers of blocks that come near each other, (n, 2); tolerance: how far apart what is one may lie [m].
    """
    faces = _faces(blocks)
    sizes = np.array([norm(np.ptp(block.points, axis=0)) for block in blocks])[faces.owners]
    group = connected_groups(_facing(faces, pairs, tolerance), len(faces.owners))
    normals, heights, fitted, left = _planes(faces, group, EXACT * sizes, tolerance)
    points, moved, farthest = [], 0, 0.0
    for k, block in enumerate(blocks):
        own = slice(faces.first[k], faces.first[k] + len(block.normals))
        exact = EXACT * sizes[own][0]
        placed, stayed = _corners(block, normals[own], heights[own], exact, FARTHEST * tolerance)
        shift = np.linalg.norm(placed - block.points, axis=1)
        moved, left = moved + int((shift > 0.0).sum()), left + stayed
        farthest = max(farthest, float(shift.max()))
        points.append(placed)
    return Snapped(points, moved, farthest, fitted, left)


def _faces(blocks: Sequence[Facets]) -> _AllFaces:
    counts = np.array([len(block.normals) for block in blocks])
    corners = [block.points[own] for block in blocks for own in block.corners]
    starts = np.concatenate([[0], np.cumsum([len(own) for own in corners])])
    flat = np.concatenate(corners)
    return _AllFaces(
        np.repeat(np.arange(len(blocks)), counts),
        np.cumsum(counts) - counts,
        np.concatenate([block.normals for block in blocks]),
        np.concatenate([block.heights for block in blocks]),
        flat,
        starts,
        np.minimum.reduceat(flat, starts[:-1], axis=0),
        np.maximum.reduceat(flat, starts[:-1], axis=0),
    )


def _facing(faces: _AllFaces, pairs: np.ndarray, tolerance: float) -> np.ndarray:
    """Find pairs of faces of neighbouring blocks that should lie in one plane, (n, 2)."""
    counts = np.bincount(faces.owners)
    a, b = np.concatenate([pairs, np.arange(len(counts))[:, None].repeat(2, axis=1)]).T  # steps of a concave one too
    repeats = counts[a] * counts[b]
    which = np.repeat(np.arange(len(a)), repeats)
    within = np.arange(len(which)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    i = faces.first[a[which]] + within // counts[b[which]]
    j = faces.first[b[which]] + within % counts[b[which]]
    near = (faces.normals[i] * faces.normals[j]).sum(axis=1) < FACING
    i, j = i[near], j[near]
    near = (faces.low[i] <= faces.high[j] + tolerance).all(axis=1) & (faces.low[j] <= faces.high[i] + tolerance).all(
        axis=1
    )
    i, j = i[near], j[near]
    spans = np.linalg.norm(faces.high - faces.low, axis=1)
    small, large = np.where(spans[i] < spans[j], i, j), np.where(spans[i] < spans[j], j, i)
    counts = np.diff(faces.starts)[small]
    owner = np.repeat(np.arange(len(small)), counts)
    at = faces.starts[small][owner] + np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    off = np.abs((faces.corners[at] * faces.normals[large[owner]]).sum(axis=1) - faces.heights[large[owner]])
    if not len(small):
        return np.zeros((0, 2), np.int64)
    worst = np.maximum.reduceat(off, np.cumsum(counts) - counts)
    return np.column_stack([i, j])[worst <= tolerance]


def _planes(
    faces: _AllFaces, group: np.ndarray, exact: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, int, int]:
    """Compute the final plane of each face (normals, heights), the number of fitted planes and of failed fits."""
    order = np.argsort(group, kind="stable")
    spans = np.linalg.norm(faces.high - faces.low, axis=1)
    normals, heights = faces.normals.copy(), faces.heights.copy()
    fitted = left = 0
    for own in np.split(order, np.cumsum(np.bincount(group))[:-1]):
        lead = own[spans[own].argmax()]
        at = np.concatenate([np.arange(faces.starts[f], faces.starts[f + 1]) for f in own])
        corners = faces.corners[at]
        signs = np.where(product(faces.normals[own], faces.normals[lead]) < 0.0, -1.0, 1.0)
        off = np.abs(product(corners, faces.normals[lead]) - faces.heights[lead])
        if off.max() <= exact[own].min():
            normal, height = faces.normals[lead], faces.heights[lead]
        else:
            normal, height = fitted_plane(corners, faces.normals[lead], tolerance)
            if np.abs(product(corners, normal) - height).max() > tolerance:
                left += len(own) > 1
                continue
            fitted += 1
        normals[own], heights[own] = signs[:, None] * normal, signs * height
    return normals, heights, fitted, left


def fitted_plane(points: np.ndarray, towards: np.ndarray, tolerance: float) -> tuple[np.ndarray, float]:
    """Fit a plane to points by least squares; along an axis where all stay within a third of `tolerance`. Returns the
    unit normal and the height.

    towards: the side that the normal looks to.
    """
    middle = points.mean(axis=0)
    arms = points - middle
    normal = singular(arms)[2][:, -1] if len(points) >= points.shape[1] else towards
    normal = normal if product(normal, towards) > 0.0 else -normal
    axis = int(np.abs(normal).argmax())
    straight = np.zeros_like(normal)
    straight[axis] = np.sign(normal[axis])
    if np.abs(product(arms, normal - straight)).max() <= tolerance / 3.0:
        normal = straight
    return normal, float(product(middle, normal))


def _corners(
    block: Facets, normals: np.ndarray, heights: np.ndarray, exact: float, farthest: float
) -> tuple[np.ndarray, int]:
    """Intersect the planes of the faces of a block at its corners; corners that would move too far stay and are
    counted.
    """
    points, stayed = block.points.copy(), 0
    planes: list[list[int]] = [[] for _ in points]
    for k, own in enumerate(block.corners):
        for corner in own.tolist():
            planes[corner].append(k)
    for corner, through in enumerate(planes):
        rest = heights[through] - product(normals[through], points[corner])
        if not through or np.abs(rest).max() <= exact:
            continue
        shift = least_squares(normals[through], rest, NEARLY_PARALLEL)
        if norm(shift) > farthest:
            stayed += 1
        else:
            points[corner] = points[corner] + shift
    return points, stayed
