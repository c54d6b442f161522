"""Pieces of surfaces: segments in the plane (2, 2), convex polygons in space (n, 3), cut by half-spaces and integrated.

A half-space is normal · x <= offset. One text for both dimensions: a polygon stays in its plane whatever cuts it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import norm, product

ON_PLANE = 1e-12  # of the size of a piece: so close to a plane a corner lies on it
GAUSS = 0.5 / np.sqrt(3.0)  # of a segment, from its middle: two points are exact for cubics


def kept(piece: np.ndarray, normal: np.ndarray, offset: float) -> np.ndarray:
    """Clip a piece by a half-space; (0, d) where nothing is left. Sutherland and Hodgman (1974)."""
    heights = product(piece, normal) - offset
    heights[np.abs(heights) <= ON_PLANE * np.ptp(piece, axis=0).sum()] = 0.0
    if (heights <= 0.0).all():
        return piece
    if (heights >= 0.0).all():
        return piece[:0]
    after = np.roll(heights, -1)
    following = np.roll(piece, -1, axis=0)
    crossing = heights * after < 0.0
    if len(piece) == 2:
        crossing[1] = False  # there is one way between two ends
    share = np.where(crossing, heights / np.where(crossing, heights - after, 1.0), 0.0)
    cuts = piece + share[:, np.newaxis] * (following - piece)
    both = np.stack([piece, cuts], axis=1).reshape(-1, piece.shape[1])
    return both[np.column_stack([heights <= 0.0, crossing]).ravel()]


def inside(piece: np.ndarray, normals: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Clip a piece by all of several half-spaces; (0, d) where nothing is left."""
    for normal, offset in zip(normals, offsets, strict=True):
        piece = kept(piece, normal, offset)
        if not len(piece):
            break
    return piece


def outside(piece: np.ndarray, normals: np.ndarray, offsets: np.ndarray) -> Iterator[np.ndarray]:
    """Subtract the intersection of half-spaces from a piece; yields convex pieces."""
    for normal, offset in zip(normals, offsets, strict=True):
        within = kept(piece, normal, offset)
        if within is piece:  # all of it, also where it lies on the plane
            continue
        beyond = kept(piece, -normal, -offset)
        if len(beyond):
            yield beyond
        piece = within
        if not len(piece):
            return


def measure(piece: np.ndarray) -> float:
    """Compute the length of a segment [m], or the area of a polygon [m²]; 0 for an empty piece."""
    if len(piece) < piece.shape[1]:
        return 0.0
    if piece.shape[1] == 2:
        return float(np.hypot(*(piece[1] - piece[0])))
    return 0.5 * float(norm(_products(piece[1:-1] - piece[0], piece[2:] - piece[0]).sum(axis=0)))


def quadrature(piece: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute quadrature points (n, d) and weights (n,) [m, m²] of a piece, exact for polynomials of second degree.

    Two points of Gauss on a segment, the middles of the sides of each triangle from the first corner of a polygon.
    """
    if piece.shape[1] == 2:
        middle, along = piece.mean(axis=0), piece[1] - piece[0]
        return middle + np.outer([-GAUSS, GAUSS], along), np.full(2, 0.5 * np.hypot(*along))
    a, b, c = np.broadcast_arrays(piece[0], piece[1:-1], piece[2:])
    areas = 0.5 * np.linalg.norm(_products(b - a, c - a), axis=1)
    return 0.5 * np.concatenate([a + b, b + c, c + a]), np.tile(areas / 3.0, 3)


def over_disc(piece: np.ndarray, centre: np.ndarray, radius: float) -> tuple[float, np.ndarray]:
    """Compute the area of a polygon over or under a disc, seen from above [m²], and its centroid (3,) [m].

    centre (2,) and radius [m]; no upright polygon. Green's theorem along the sides: what of one lies within the circle
    bounds a triangle with the centre, what lies outside a sector.
    """
    low, high = piece[:, :2] - centre, np.roll(piece[:, :2], -1, axis=0) - centre
    doubled, moments = 0.0, np.zeros(2)
    for start, end in zip(low, high, strict=True):
        shares = _within(start, end, radius)
        enters, leaves = (start + share * (end - start) for share in shares)
        twice = _cross(enters, leaves)
        doubled += twice
        moments += twice / 6.0 * (enters + leaves)
        for a, b, beyond in ((start, enters, shares[0] > 0.0), (leaves, end, shares[1] < 1.0)):
            if beyond:
                from_, to = a / np.hypot(*a), b / np.hypot(*b)
                doubled += radius**2 * functions.arctan2(_cross(a, b), product(a, b))
                moments += radius**3 / 3.0 * np.array([to[1] - from_[1], from_[0] - to[0]])
    if doubled == 0.0:
        return 0.0, piece.mean(axis=0)
    normal = _products(piece[1:-1] - piece[0], piece[2:] - piece[0]).sum(axis=0)
    place = centre + moments / (0.5 * doubled)
    height = piece[0, 2] - product(normal[:2], place - piece[0, :2]) / normal[2]
    return 0.5 * abs(doubled), np.append(place, height)


def _within(start: np.ndarray, end: np.ndarray, radius: float) -> tuple[float, float]:
    """Intersect the line between two points (2,) with a circle about the origin: shares of the way at entry and
    exit.
    """
    along = end - start
    length = product(along, along)
    beside = _cross(start, along) ** 2
    if beside >= radius**2 * length:
        return 0.0, 0.0
    middle, half = -product(start, along) / length, np.sqrt(radius**2 * length - beside) / length
    return min(max(middle - half, 0.0), 1.0), min(max(middle + half, 0.0), 1.0)


def _cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _products(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Compute cross products in space (n, 3): np.cross takes ten times as long for a few."""
    (x, y, z), (u, v, w) = a.T, b.T
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u]).T


def shadow(normals: np.ndarray, offsets: np.ndarray, level: float = 1e-9) -> tuple[np.ndarray, np.ndarray]:
    """Compute the half-spaces of all that lies in or under a convex body given by half-spaces.

    Up is the last axis. Faces that look up or sideways stay; each pair of one that looks up and one that looks down
    gives an upright plane (Fourier and Motzkin: the height between them is not negative). level: |normal| of a
    vertical component that counts as none.
    """
    up = normals[:, -1]
    down, rising = np.flatnonzero(up < -level), np.flatnonzero(up > level)
    i, j = (each.ravel() for each in np.meshgrid(rising, down))
    planes = normals[i] * -up[j, np.newaxis] + normals[j] * up[i, np.newaxis]
    heights = offsets[i] * -up[j] + offsets[j] * up[i]
    lengths = np.linalg.norm(planes, axis=1)
    upright = lengths > level
    rest = np.flatnonzero(up >= -level)
    return (
        np.concatenate([planes[upright] / lengths[upright, np.newaxis], normals[rest]]),
        np.concatenate([heights[upright] / lengths[upright], offsets[rest]]),
    )
