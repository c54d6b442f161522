"""Cuts of convex polygons by lines: pieces on either side, common edges and unions.

Polygons are arrays of corners (n, 2) [m], counter-clockwise; nothing is an array (0, 2).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.rotation import cross

NOTHING = np.empty((0, 2))
SAME_AREA = 1e-12  # relative: a hull of two polygons that is as large as both is their union


def halves(shape: np.ndarray, start: np.ndarray, end: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
    """Cut a convex polygon by the line start -> end into its left and its right piece.

    Corners within `gap` [m] of the line lie on it: no piece is narrower.
    """
    if not len(shape):
        return NOTHING, NOTHING
    along = np.subtract(end, start)
    heights = cross(along, shape - start) / np.hypot(*along)
    heights[np.abs(heights) <= gap] = 0.0
    if heights.min() >= 0.0:
        return shape, NOTHING
    if heights.max() <= 0.0:
        return NOTHING, shape
    after, heights_after = np.roll(shape, -1, axis=0), np.roll(heights, -1)
    crosses = heights * heights_after < 0.0
    share = np.where(crosses, heights / np.where(crosses, heights - heights_after, 1.0), 0.0)
    corners = np.stack([shape, shape + share[:, None] * (after - shape)], axis=1).reshape(-1, 2)
    left = corners[np.stack([heights >= 0.0, crosses], axis=1).ravel()]
    right = corners[np.stack([heights <= 0.0, crosses], axis=1).ravel()]
    return left, right


def less_box(shape: np.ndarray, box: Sequence[float], gap: float) -> list[np.ndarray]:
    """Subtract a box [left, bottom, right, top] from a convex polygon: pieces left and right of it, below and above
    it.
    """
    x0, y0, x1, y1 = box
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    pieces, rest = [], shape
    for start, end in ((3, 0), (1, 2), (0, 1), (2, 3)):
        rest, outside = halves(rest, corners[start], corners[end], gap)
        pieces.append(outside)
    return [piece for piece in pieces if len(piece)] if len(rest) else [shape]


def less_convex(shape: np.ndarray, hole: np.ndarray, gap: float) -> list[np.ndarray]:
    """Subtract a convex polygon from another, divided by the lines from the middle of the hole through its corners."""
    rest, ends = shape, np.roll(hole, -1, axis=0)
    for start, end in zip(hole, ends, strict=True):
        rest = halves(rest, start, end, gap)[0]
    if not len(rest):
        return [shape]
    middle, found = polygon.centroid(hole), []
    for start, end in zip(hole, ends, strict=True):
        wedge = halves(halves(shape, middle, start, gap)[0], middle, end, gap)[1]
        found.append(halves(wedge, start, end, gap)[1])
    return [piece for piece in found if len(piece)]


def common_edge(a: np.ndarray, b: np.ndarray, gap: float) -> float:
    """Compute the length along which two convex polygons that do not overlap touch [m]."""
    if (a.max(axis=0) < b.min(axis=0) - gap).any() or (b.max(axis=0) < a.min(axis=0) - gap).any():
        return 0.0
    along = np.roll(a, -1, axis=0) - a
    lengths = np.hypot(*along.T)
    along = along / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    arms = b[None, :, :] - a[:, None, :]
    places = (arms * along[:, None, :]).sum(axis=2)
    on_line = np.abs(cross(along[:, None, :], arms)) <= gap
    both = on_line & np.roll(on_line, -1, axis=1)
    overlap = np.minimum(places, lengths[:, None]) - np.maximum(np.roll(places, -1, axis=1), 0.0)
    return float(np.where(both, np.maximum(overlap, 0.0), 0.0).sum())


def union(a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
    """Unite two convex polygons that touch, where the union is convex; else None."""
    points = np.unique(np.concatenate([a, b]), axis=0)
    points = points[np.lexsort((points[:, 0], points[:, 1]))]
    hull = points[polygon.outline(points, polygon.ROUND_OFF * polygon.size(points))]
    whole = polygon.area(a) + polygon.area(b)
    return hull if len(hull) > 2 and abs(polygon.area(hull) - whole) <= whole * SAME_AREA else None


def unions(parts: Sequence[np.ndarray], gap: float) -> list[np.ndarray]:
    """Join convex polygons that touch, as long as two of them are convex together."""
    left = list(parts)
    k = 0
    while k < len(left):
        for j in range(k + 1, len(left)):
            one = union(left[k], left[j]) if common_edge(left[k], left[j], gap) > gap else None
            if one is not None:
                left[k] = one
                del left[j]
                k = -1
                break
        k += 1
    return left


def connected(parts: Sequence[np.ndarray], gap: float) -> list[list[int]]:
    """Group the numbers of convex polygons that touch along edges, each group in order."""
    groups: list[list[int]] = []
    for i, part in enumerate(parts):
        touching = [group for group in groups if any(common_edge(parts[j], part, gap) > gap for j in group)]
        for group in touching:
            groups.remove(group)
        groups.append(sorted([i, *(j for group in touching for j in group)]))
    return sorted(groups)


def welded(shapes: Sequence[np.ndarray], gap: float) -> list[np.ndarray]:
    """Make coordinates of polygons equal where they differ by no more than `gap` [m], the round-off of cuts."""
    if not shapes:
        return []
    points = np.concatenate(shapes)
    for axis in (0, 1):
        values, back = np.unique(points[:, axis], return_inverse=True)
        first = np.concatenate([[True], np.diff(values) > gap])
        points[:, axis] = values[first][np.cumsum(first) - 1][back]
    return np.split(points, np.cumsum([len(shape) for shape in shapes])[:-1])
