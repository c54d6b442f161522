"""Pockets of simple polygons: empty areas between an outline and its convex hull, and between a hull and its box.

Outlines are arrays of corners (n, 2) [m], counter-clockwise.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.decomposition import convex_parts


def hull(outline: np.ndarray) -> np.ndarray:
    """Compute the convex hull of an outline, counter-clockwise, (n, 2)."""
    points = outline[np.lexsort((outline[:, 0], outline[:, 1]))]
    return points[polygon.outline(points, polygon.ROUND_OFF * polygon.size(points))]


def hull_pockets(outline: np.ndarray) -> list[np.ndarray]:
    """Fill the area between a simple outline and its convex hull with convex pieces."""
    corners, gap = hull(outline), polygon.ROUND_OFF * polygon.size(outline)
    ends = np.roll(corners, -1, axis=0)
    along = (ends - corners) / np.hypot(*(ends - corners).T)[:, None]
    arms = outline[:, None] - corners
    away = (along[:, 0] * arms[:, :, 1] - along[:, 1] * arms[:, :, 0]).min(axis=1)
    on = np.flatnonzero(away <= gap).tolist()
    found = []
    for i, j in zip(on, [*on[1:], on[0] + len(outline)], strict=True):
        if j - i > 1:
            found += convex_pieces(outline[np.arange(j, i - 1, -1) % len(outline)])
    return found


def box_pockets(corners: np.ndarray) -> list[np.ndarray]:
    """Fill the area between a convex polygon and its bounding box with convex pieces, at the corners of the box."""
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    sides = [(1, y0), (0, x1), (1, y1), (0, x0)]  # counter-clockwise from below
    box = polygon.rectangle(x0, y0, x1 - x0, y1 - y0)[[1, 2, 3, 0]]
    box[:, 0], box[:, 1] = [x1, x1, x0, x0], [y0, y1, y1, y0]
    found, n = [], len(corners)
    for (axis, level), (next_axis, next_level), corner in zip(sides, [*sides[1:], sides[0]], box, strict=True):
        on = corners[:, axis] == level
        last = next(k for k in range(n) if on[k] and not on[(k + 1) % n])
        first = next(k for k in range(n) if corners[k, next_axis] == next_level and _begins(corners, k, next_axis))
        chain = [(last + k) % n for k in range((first - last) % n + 1)]
        if len(chain) > 1:
            found += convex_pieces(np.concatenate([corner[None], corners[chain[::-1]]]))
    return found


def _begins(corners: np.ndarray, k: int, axis: int) -> bool:
    """Test whether a side of a box begins at corner k: the corner before it lies elsewhere."""
    return bool(corners[k - 1, axis] != corners[k, axis])


def convex_pieces(shape: np.ndarray) -> list[np.ndarray]:
    """Divide a simple polygon into convex pieces, without corners on straight sides."""
    whole = polygon.simplified(shape)
    if polygon.is_convex(whole):
        return [whole]
    return [polygon.simplified(whole[part]) for part in convex_parts(whole)]
