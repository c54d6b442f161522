"""Vertical clearance between convex polygons, exact: from the lower side of the one and the upper side of the other."""

from __future__ import annotations

import numpy as np

CHUNK_OF_PAIRS = 1 << 20  # numbers held at a time in an array


def clearances(
    upper: np.ndarray, lower: np.ndarray, corners: np.ndarray, starts: np.ndarray, narrow: np.ndarray | float = 0.0
) -> np.ndarray:
    """Compute the least height of polygons `upper` above polygons `lower`, both (n,) numbers of polygons [m], (n,).

    Polygon p is corners[starts[p]:starts[p + 1]], convex, in either sense. Negative where they overlap: how far the
    upper one has to be lifted to rest on the lower one. Infinite where no vertical line wider than `narrow` [m],
    (n,) or one for all, goes through both.
    The lower side of a polygon is a convex function of x and the upper one a concave one: their distance is
    least at a corner of either, or where the common width ends.
    """
    counts = np.diff(starts)
    result = np.full(len(upper), np.inf)
    narrow = np.broadcast_to(narrow, result.shape)
    kinds = counts[upper] * (counts.max(initial=0) + 1) + counts[lower]
    for kind in np.unique(kinds):
        pairs = np.flatnonzero(kinds == kind)
        p, q = counts[upper[pairs[0]]], counts[lower[pairs[0]]]
        step = max(1, CHUNK_OF_PAIRS // ((p + q) * max(p, q)))
        for first in range(0, len(pairs), step):
            some = pairs[first : first + step]
            above = corners[starts[upper[some], None] + np.arange(p)]
            below = corners[starts[lower[some], None] + np.arange(q)]
            result[some] = _clearance(above, below, narrow[some])
    return result


def _clearance(above: np.ndarray, below: np.ndarray, narrow: np.ndarray) -> np.ndarray:
    """Compute the vertical clearance [m] of n pairs of polygons with p and q corners, (n, p, 2) and (n, q, 2)."""
    left = np.maximum(above[..., 0].min(axis=1), below[..., 0].min(axis=1))
    right = np.minimum(above[..., 0].max(axis=1), below[..., 0].max(axis=1))
    common = right - left > narrow
    places = np.concatenate([above[..., 0], below[..., 0]], axis=1)
    places = np.clip(places, left[:, None], np.maximum(left, right)[:, None])
    heights = _lower_side(above, places) + _lower_side(below * [1.0, -1.0], places)
    return np.where(common, heights.min(axis=1, initial=np.inf), np.inf)


def _lower_side(polygons: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Heights of the lower sides of n polygons (n, p, 2) at places x (n, m) within their width, (n, m)."""
    start, end = polygons, np.roll(polygons, -1, axis=1)
    x0, y0, x1, y1 = (side[:, None, :, axis] for side in (start, end) for axis in (0, 1))
    x = places[:, :, None]
    run = x1 - x0
    upright = np.abs(run) < 1e-300  # also what would overflow in the division
    share = np.where(upright, 0.0, (x - x0) / np.where(upright, 1.0, run))
    heights = np.where(upright, np.minimum(y0, y1), np.where(share == 1.0, y1, y0 + share * (y1 - y0)))
    within = (x >= np.minimum(x0, x1)) & (x <= np.maximum(x0, x1))
    return np.where(within, heights, np.inf).min(axis=2)
