"""Convex decomposition of concave polyhedra, exact: their hull cut by the planes of their concave sides.

The hull is cut by the plane of a side that goes through a piece until no side does (binary space partition; Fuchs,
Kedem and Naylor 1980); pieces inside are kept, and joined again where two are convex together. Corners of the solid
keep their coordinates.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.arithmetic.small_matrices import determinants
from dem_cli.core.geometry.polyhedron import newell

ROUND_OFF = 1e-9  # of the size: points that coincide, heights that are zero
THIN = 1e-6  # of the size: pieces of a side that are narrower are not cut along
SAME_VOLUME = 1e-9  # relative: two pieces whose hull is no larger are convex together
MOST_PIECES = 200


class Sides(NamedTuple):
    """Surface of a solid: flat sides, each of one or several triangles."""

    points: np.ndarray  # corners [m], (n, 3)
    triangles: np.ndarray  # counter-clockwise seen from outside; in a fan of a concave face some are not, (m, 3)
    planes: np.ndarray  # side that each triangle belongs to, (m,)
    normals: np.ndarray  # outward and unit, of each side, (k, 3)
    heights: np.ndarray  # of each side over the origin [m], (k,)


def convex_pieces(sides: Sides) -> list[np.ndarray]:
    """Divide a solid into convex pieces, each given by its corners (n, 3). Raises ValueError where there are too many,
    or they do not fill it.
    """
    size = float(norm(np.ptp(sides.points, axis=0)))
    rough = roughness(sides)
    gap = max(ROUND_OFF * size, 2.0 * rough)
    over = product(sides.points, sides.normals.T) - sides.heights
    through = set(np.flatnonzero((over > THIN * size).any(axis=0)).tolist())
    faces = [(k, sides.points[corners]) for k, corners in zip(sides.planes, sides.triangles) if k in through]
    waiting, leaves = [(hull_corners(sides.points), faces)], []
    while waiting:
        cell, inside = waiting.pop()
        k = _best(sides, inside, gap)
        if k is None:
            leaves.append(cell)
            continue
        if len(waiting) + len(leaves) > MOST_PIECES:
            raise ValueError(f"it takes more than {MOST_PIECES} convex pieces")
        for sign in (1.0, -1.0):
            below = sign * sides.normals[k], sign * float(sides.heights[k])
            part = _half(cell, *below, sides.points, gap)
            if part is not None:
                cuts = [(j, _clipped(piece, *below, gap)) for j, piece in inside]
                waiting.append((part, [(j, cut) for j, cut in cuts if j != k and _width(cut) > THIN * size]))
    kept = [cell for cell in leaves if _winding(sides, cell.mean(axis=0)) > 0.5]
    pieces = _joined(kept, rough)
    whole, found = solid_volume(sides), sum(map(volume, pieces))
    if abs(found - whole) > SAME_VOLUME * whole + rough * 12.0 * size**2:
        raise ValueError(f"its faces cross each other: its convex parts would have {found:.9g} of {whole:.9g} m3")
    return pieces


def roughness(sides: Sides) -> float:
    """Compute the largest distance of corners from the planes of their sides [m]: 0 where a file is exact."""
    own = np.repeat(sides.planes, 3)
    places = sides.points[sides.triangles.ravel()]
    return float(np.abs((places * sides.normals[own]).sum(axis=1) - sides.heights[own]).max())


def solid_volume(sides: Sides) -> float:
    """Compute the volume of a solid from the triangles of its surface [m3]."""
    arms = sides.points[sides.triangles] - sides.points.mean(axis=0)
    return abs(float(determinants(arms).sum())) / 6.0


def volume(corners: np.ndarray) -> float:
    """Compute the volume of the convex hull of corners (n, 3) [m3]; 0 for corners in one plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(corners - corners.mean(axis=0)).volume)
    except QhullError:
        return 0.0


def hull_corners(points: np.ndarray) -> np.ndarray:
    """Find the corners of the convex hull of points (n, 3), without those on its faces or edges; in their order."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        found = ConvexHull(points - points.mean(axis=0))
    except QhullError:
        raise ValueError("its faces are not plane enough to tell its convex parts") from None
    return points[np.sort(found.vertices)]


def _best(sides: Sides, faces: list[tuple[int, np.ndarray]], gap: float) -> int | None:
    """Choose the side whose plane cuts the fewest others through the same piece; None where no plane does."""
    chosen, least = None, np.inf
    for k in dict.fromkeys(k for k, _ in faces):
        cuts = 0
        for j, piece in faces:
            heights = product(piece, sides.normals[k]) - sides.heights[k]
            cuts += j != k and heights.min() < -gap and heights.max() > gap
        if cuts < least:
            chosen, least = k, cuts
    return chosen


def _half(cell: np.ndarray, normal: np.ndarray, height: float, known: np.ndarray, gap: float) -> np.ndarray | None:
    """Compute the corners of the part of a convex piece below a plane; None where nothing is left."""
    over = product(cell, normal) - height
    if over.min() >= -gap:
        return None
    if over.max() <= gap:
        return cell
    low, high = np.flatnonzero(over < -gap), np.flatnonzero(over > gap)
    share = over[low][:, None] / (over[low][:, None] - over[high][None, :])
    crossings = cell[low][:, None] + share[:, :, None] * (cell[high][None, :] - cell[low][:, None])
    crossings = crossings.reshape(-1, 3)
    near = np.linalg.norm(crossings[:, None] - known[None], axis=2)
    k = near.argmin(axis=1)
    crossings = np.where((near.min(axis=1) <= gap)[:, None], known[k], crossings)
    return hull_corners(_apart(np.concatenate([cell[over <= gap], crossings]), gap))


def _apart(points: np.ndarray, gap: float) -> np.ndarray:
    """Remove repeated points."""
    kept: list[np.ndarray] = []
    for point in points:
        if not kept or np.abs(np.array(kept) - point).max(axis=1).min() > gap:
            kept.append(point)
    return np.array(kept)


def _clipped(piece: np.ndarray, normal: np.ndarray, height: float, gap: float) -> np.ndarray:
    """Cut a flat convex side (corners in order, (n, 3)) to the part below a plane; Sutherland and Hodgman 1974."""
    if not len(piece):
        return piece
    over = product(piece, normal) - height
    over = np.where(np.abs(over) <= gap, 0.0, over)
    after, over_after = np.roll(piece, -1, axis=0), np.roll(over, -1)
    kept = []
    for k in range(len(piece)):
        if over[k] <= 0.0:
            kept.append(piece[k])
        if over[k] * over_after[k] < 0.0:
            kept.append(piece[k] + over[k] / (over[k] - over_after[k]) * (after[k] - piece[k]))
    return np.array(kept).reshape(-1, 3)


def _width(piece: np.ndarray) -> float:
    """Estimate the width of a flat side: the square root of its area [m]."""
    return float(np.sqrt(norm(newell(piece)))) if len(piece) > 2 else 0.0


def _winding(sides: Sides, point: np.ndarray) -> float:
    """Compute the winding number of the surface about a point: 1 inside, 0 outside; Van Oosterom and Strackee 1983."""
    arms = sides.points[sides.triangles] - point
    lengths = np.linalg.norm(arms, axis=2)
    a, b, c = arms[:, 0], arms[:, 1], arms[:, 2]
    la, lb, lc = lengths.T
    below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return abs(float(2.0 * functions.arctan2(determinants(arms), below).sum())) / (4.0 * np.pi)


def _joined(pieces: list[np.ndarray], rough: float) -> list[np.ndarray]:
    """Join pieces, two at a time, that are convex together; the largest first."""
    left = sorted(pieces, key=volume, reverse=True)
    sizes = [volume(piece) for piece in left]
    k = 0
    while k < len(left):
        for j in range(k + 1, len(left)):
            both = np.concatenate([left[k], left[j]])
            together = sizes[k] + sizes[j]
            span = float(norm(np.ptp(both, axis=0)))
            if volume(both) <= together * (1.0 + SAME_VOLUME) + rough * span**2:
                gap = max(ROUND_OFF * span, 2.0 * rough)
                left[k], sizes[k] = hull_corners(_apart(both, gap)), together
                del left[j], sizes[j]
                k = -1
                break
        k += 1
    return left
