"""Convex decomposition of simple polygons: concave ones are cut along diagonals, no corner is added."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.rotation import cross

ROUND_OFF = 1e-12  # relative to the size of the polygon: corners on a line; below what convex parts are checked for


def convex_parts(corners: np.ndarray) -> list[np.ndarray]:
    """Divide a simple polygon (n, 2) [m], counter-clockwise, into convex parts; returns the numbers of their corners.

    Each cut goes from a corner that points inwards to that other corner which leaves the fewest of them, and then the
    widest narrower part. Corners on straight sides may end a cut. Raises ValueError: the sides cross each other.
    """
    return _parts(np.asarray(corners, float), np.arange(len(corners)), polygon.size(corners))


def is_simple(corners: np.ndarray) -> bool:
    """Test whether a polygon runs counter-clockwise and no two of its sides meet except at their common end."""
    size = polygon.size(corners)
    if len(corners) < 3 or polygon.signed_area(corners) <= ROUND_OFF * size**2:
        return False
    after = np.roll(corners, -1, axis=0)
    n = len(corners)
    i, j = np.triu_indices(n, 1)
    apart = (j - i > 1) & (j - i < n - 1)
    i, j = i[apart], j[apart]
    return not _meet(corners[i], after[i], corners[j], after[j], ROUND_OFF * size**2).any()


def _parts(corners: np.ndarray, loop: np.ndarray, size: float) -> list[np.ndarray]:
    here = corners[loop]
    inwards = _inwards(here, size)
    if not inwards.any():
        return [loop]
    best = None
    for r in np.flatnonzero(inwards):
        for v in _seen_from(here, int(r), size):
            first, second = _halves(len(loop), int(r), v)
            left = int(_inwards(here[first], size).sum() + _inwards(here[second], size).sum())
            smaller = min(_width(here[first]), _width(here[second]))
            if smaller > ROUND_OFF * size and (best is None or (left, -smaller) < best[0]):
                best = (left, -smaller), first, second
    if best is None:
        raise ValueError("the sides of the polygon cross each other")
    _, first, second = best
    return _parts(corners, loop[first], size) + _parts(corners, loop[second], size)


def _width(corners: np.ndarray) -> float:
    return polygon.signed_area(corners) / polygon.size(corners)


def _inwards(corners: np.ndarray, size: float) -> np.ndarray:
    """Find the corners at which a polygon is concave, (n,) bool."""
    edges = np.roll(corners, -1, axis=0) - corners
    return cross(np.roll(edges, 1, axis=0), edges) < -ROUND_OFF * size**2


def _halves(n: int, i: int, j: int) -> tuple[np.ndarray, np.ndarray]:
    i, j = min(i, j), max(i, j)
    return np.arange(i, j + 1), np.concatenate([np.arange(j, n), np.arange(i + 1)])


def _seen_from(corners: np.ndarray, r: int, size: float) -> list[int]:
    """Find the corners to which a straight cut from corner r lies inside the polygon."""
    n, least = len(corners), ROUND_OFF * size**2
    after = np.roll(corners, -1, axis=0)
    others = np.array([v for v in range(n) if v not in ((r - 1) % n, r, (r + 1) % n)], np.int64)
    found = []
    for v in others.tolist():
        arm = corners[v] - corners[r]
        if not (_opens_to(corners, r, arm, least) and _opens_to(corners, v, -arm, least)):
            continue
        sides = np.array([k for k in range(n) if r not in (k, (k + 1) % n) and v not in (k, (k + 1) % n)], np.int64)
        start, end = np.broadcast_to(corners[r], (len(sides), 2)), np.broadcast_to(corners[v], (len(sides), 2))
        if not _meet(start, end, corners[sides], after[sides], least).any():
            found.append(v)
    return found


def _opens_to(corners: np.ndarray, k: int, arm: np.ndarray, least: float) -> bool:
    """Test whether a direction from corner k points into the polygon."""
    here, n = corners[k], len(corners)
    out, back = corners[(k + 1) % n] - here, corners[(k - 1) % n] - here
    left_of_out, right_of_back = float(cross(out, arm)) > least, float(cross(arm, back)) > least
    if float(cross(out, back)) > least:
        return left_of_out and right_of_back
    return left_of_out or right_of_back


def _meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, least: float) -> np.ndarray:
    """Test whether segments a-b and c-d (n, 2) intersect, (n,) bool; twice the area `least` counts as zero."""
    sides = [cross(b - a, c - a), cross(b - a, d - a), cross(d - c, a - c), cross(d - c, b - c)]
    sides = [np.where(np.abs(side) <= least, 0.0, np.sign(side)) for side in sides]
    crossing = (sides[0] * sides[1] <= 0.0) & (sides[2] * sides[3] <= 0.0)
    on_one_line = (sides[0] == 0.0) & (sides[1] == 0.0)
    along = b - a
    places = np.stack([((c - a) * along).sum(axis=1), ((d - a) * along).sum(axis=1)])
    overlap = (places.max(axis=0) >= 0.0) & (places.min(axis=0) <= (along**2).sum(axis=1))
    return crossing & (~on_one_line | overlap)
