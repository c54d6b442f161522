"""Convex bodies in any dimension: distance of a point from one, and intersection of two."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.arithmetic.small_matrices import determinants

ROUND_OFF = 1e-12  # of the distance to the furthest corner


class CommonBody(NamedTuple):
    """Intersection of two convex bodies."""

    volume: float  # in the plane the area [m^d]
    centroid: np.ndarray  # [m], (d,)


def distance(corners: np.ndarray, point: np.ndarray) -> float:
    """Compute the distance of a point from the convex body with these corners (n, d) [m]; 0 inside.

    In the plane the nearest point lies on a line between two corners. In space it is a mean of the corners with weights
    w >= 0: those of the least |sum w (corner - point)|^2 + (1 - sum w)^2, which points the same way whatever the sum
    is. Bounded least squares (Stark and Parker 1995): that of Lawson and Hanson, scipy's nnls, ends early where corners
    are symmetric to the last digits (1 % off).
    """
    arms = np.asarray(corners, float) - point
    scale = float(np.abs(arms).max()) or 1.0
    if arms.shape[1] == 2:
        away = _to_lines(arms) if _all_on_one_side(arms) else 0.0
        return away if away > ROUND_OFF * scale else 0.0
    from scipy.optimize import lsq_linear  # 0.3 s

    rows, wanted = np.vstack([arms.T / scale, np.ones(len(arms))]), np.append(np.zeros(arms.shape[1]), 1.0)
    weights = lsq_linear(rows, wanted, (0.0, np.inf), method="bvls", tol=1e-15).x
    away = float(norm(product(weights, arms)) / weights.sum())
    return away if away > ROUND_OFF * scale else 0.0


def _all_on_one_side(arms: np.ndarray) -> bool:
    """Test whether a point is outside: all corners lie within half a turn around it; arms: to them [m], (n, 2)."""
    angles = np.sort(functions.arctan2(arms[:, 1], arms[:, 0]))
    return float(np.diff(angles, append=angles[0] + 2.0 * math.pi).max()) > math.pi


def _to_lines(arms: np.ndarray) -> float:
    """Compute the least distance from the lines between all corners [m]; arms: to them, (n, 2)."""
    i, j = np.triu_indices(len(arms), 1)
    along = arms[j] - arms[i]
    squares = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    shares = np.clip(-(arms[i] * along).sum(axis=1) / squares, 0.0, 1.0)
    return float(np.linalg.norm(arms[i] + shares[:, np.newaxis] * along, axis=1).min())


def common(normals: np.ndarray, offsets: np.ndarray) -> CommonBody | None:
    """Intersect half-spaces normal · x <= offset: unit normals (n, d), offsets [m] (n,); None where it is empty.

    Its corners are those of the dual hull about a point inside, which a linear program finds.
    """
    from scipy.optimize import linprog
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    d = normals.shape[1]
    rows = np.column_stack([normals, np.ones(len(normals))])
    found = linprog(np.append(np.zeros(d), -1.0), rows, offsets, bounds=[*[(None, None)] * d, (0.0, None)])
    if found.status != 0 or found.x[d] <= 0.0:
        return None
    inside = found.x[:d]
    try:
        rows = np.column_stack([normals, product(normals, inside) - offsets])
        corners = HalfspaceIntersection(rows, np.zeros(d)).intersections
        facets = corners[ConvexHull(corners).simplices]
    except QhullError:
        return None
    volumes = np.abs(determinants(facets)) / math.factorial(d)  # of the simplices between the facets and that point
    centroids = facets.sum(axis=1) / (d + 1)
    return CommonBody(float(volumes.sum()), inside + product(volumes, centroids) / volumes.sum())
