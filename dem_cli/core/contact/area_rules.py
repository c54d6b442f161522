"""Quadrature points over the area of a joint in space: convex polygons, points at their corners, positive weights.

Area, first and second moments are exact, so that a joint is as stiff in bending about any axis and in torsion as an
elastic layer is; with its corners a block still turns about its edges.

Parallelograms have n × n Gauss–Lobatto points from n = 4 on, and nine for n = 3: corners, centre, and four on the
diagonals. These nine leave two numbers free beyond the moments, which are such that a brittle joint in bending about
either side is at its strongest when its edge cracks, as a continuous one is: the moment that it carries then falls to
97, 87 and 38 %. Of n × n Lobatto points it would rise to 2, 1.35, 1.19, 1.05 times for n = 3, 4, 5, 9.

Joints that crack or are crushed have 57 points of a parallelogram, scattered so that they lie at many places along
either side, each with its mirror images. In bending about a side they are as strong as the whole section, to 1 % at any
normal force, brittle or perfectly plastic; about the diagonal to 5.1 %, crushed by a twentieth of the crushing force or
more. Places and shares were found by minimising the largest of these errors.

Other polygons are a fan of triangles about their centroid, each cut into m² alike ones, m = (n − 1) // 2, with 1/12 of
the area of each at its corners and 3/4 at its centroid: exact for quadratic functions (Abramowitz and Stegun 25.4.63).
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.layout import SECTION, lobatto

LEAST = 3  # points along a side from which on a rule is exact for second moments
REACH = 0.4  # of the half diagonals: how far out the four points on them are
ON_DIAGONALS, AT_CENTRE = 5.0 / 48.0, 19.0 / 60.0  # share of the area of each of these, and of the centre

# The points of a section: share of the area of a corner, then place along one side and along the other, and share; each
# stands for its mirror images, and the centre has what is left.
AT_CORNER = 0.001407
IN_SECTION = (
    (0.799365, 1.000000, 0.002785),
    (0.654353, 0.969502, 0.009658),
    (0.920061, 0.920061, 0.010245),
    (0.495712, 0.873956, 0.020716),
    (0.074921, 0.766079, 0.020059),
    (0.436135, 0.673090, 0.027233),
    (0.220317, 0.340494, 0.031371),
)
# Where outlines are no parallelograms each triangle of a fan is cut into the square of so many for the same purpose:
# up to 14 % too strong where it is brittle, within 2 % where it is crushed (docs/numerics.md).
IN_FAN = 4
PARALLEL = 1e-9  # of its longest diagonal: a quadrilateral whose opposite sides are so alike is a parallelogram


class InnerPoints(NamedTuple):
    """Quadrature points of outlines beside their corners; outline j has the points starts[j]:starts[j + 1]."""

    starts: np.ndarray  # (n + 1,) int64
    places: np.ndarray  # [m], (n_inner, 3), and whatever else is linear over the polygon
    shares: np.ndarray  # of the area of the outline, (n_inner,)
    corners: np.ndarray  # share that the corners of each have together, (n,)


def inner_points(outlines: np.ndarray, starts: np.ndarray, centres: np.ndarray, sides: np.ndarray) -> InnerPoints:
    """Compute quadrature points inside many plane convex polygons at once.

    outlines: corners in order [m], (n_corners, 3), of which polygon j has starts[j]:starts[j + 1]; centres: centroids
    [m], (n, 3); both with more columns of what else is linear over a polygon. sides: points along a side, (n,), those
    with fewer than LEAST have none. Corners share what is left in proportion to the triangles that they make with the
    centroid.
    """
    n, counts = len(sides), np.diff(starts)
    ruled = sides >= LEAST
    even = np.zeros(n, bool)
    four = np.flatnonzero(ruled & (counts == 4))
    even[four] = _parallelograms(outlines[starts[four, None] + np.arange(4)])
    kinds = np.column_stack([np.where(even, -1, counts), sides])
    corners = np.ones(n)
    found: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for count, side in np.unique(kinds[ruled], axis=0).tolist():
        alike = np.flatnonzero(ruled & (kinds == (count, side)).all(axis=1))
        polygons = outlines[starts[alike, None] + np.arange(counts[alike[0]])]
        if count > 0:
            rule = _fan(polygons, centres[alike], IN_FAN if side == SECTION else (side - 1) // 2)
        else:
            rule = RULES[side](polygons) if side in RULES else _grid(polygons, side)
        corners[alike] = 1.0 - rule[1].sum(axis=1)
        found.update(zip(alike.tolist(), zip(*rule, strict=True), strict=True))
    sizes = [len(found[j][1]) if j in found else 0 for j in range(n)]
    order = sorted(found)
    none = (np.zeros((0, outlines.shape[1])), np.zeros(0))
    places, shares = (np.concatenate([none[i], *(found[j][i] for j in order)]) for i in (0, 1))
    return InnerPoints(np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), places, shares, corners)


def _parallelograms(polygons: np.ndarray) -> np.ndarray:
    """Test which quadrilaterals (n, 4, 3 or more) are parallelograms, (n,) bool."""
    polygons = polygons[:, :, :3]
    across = np.linalg.norm(polygons[:, 2:] - polygons[:, :2], axis=2).max(axis=1)
    odd = polygons[:, 0] - polygons[:, 1] + polygons[:, 2] - polygons[:, 3]
    return np.linalg.norm(odd, axis=1) <= PARALLEL * across


def _diagonals(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the centre and four diagonal points of parallelograms (m, 4, …): places (m, 5, …), shares."""
    centres = polygons.mean(axis=1)[:, None]
    at = np.concatenate([centres, centres + REACH * (polygons - centres)], axis=1)
    return at, np.tile([AT_CENTRE] + 4 * [ON_DIAGONALS], (len(polygons), 1))


def _scattered(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of a whole section of parallelograms (m, 4, …) without corners: places (m, points, …), shares."""
    x, y, shares = section_points()
    along, up = polygons[:, 1] - polygons[:, 0], polygons[:, 3] - polygons[:, 0]
    at = polygons.mean(axis=1)[:, None] + 0.5 * (x[:, None] * along[:, None] + y[:, None] * up[:, None])
    return at, np.tile(shares, (len(polygons), 1))


@cache
def section_points() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places from −1 to 1 along both sides and shares of the area of the points of a whole section but its corners."""
    places, shares = np.array(IN_SECTION)[:, :2], np.array(IN_SECTION)[:, 2]
    alike = np.where(places[:, 0] == places[:, 1], 4.0, 8.0)
    # The last of them get what the digits leave off the second moments.
    squares = 0.5 * alike * (places**2).sum(axis=1)
    shares[-1] += (1.0 / 3.0 - 4.0 * AT_CORNER - (shares * squares).sum()) / squares[-1]
    found = [(0.0, 0.0, 1.0 - 4.0 * AT_CORNER - (shares * alike).sum())]
    for (p, q), share in zip(places.tolist(), shares.tolist(), strict=True):
        found += [(s * a, t * b, share) for a, b in sorted({(p, q), (q, p)}) for s in (1.0, -1.0) for t in (1.0, -1.0)]
    x, y, shares = np.array(found).T
    return x, y, shares


def _grid(polygons: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss–Lobatto points, n × n, of parallelograms (m, 4, …) but their corners: places (m, n² − 4, …), shares."""
    places, weights = lobatto(n)
    x, y = (each.ravel() for each in np.meshgrid(places, places, indexing="ij"))
    inner = ~(np.isin(x, places[[0, -1]]) & np.isin(y, places[[0, -1]]))
    shares = np.outer(weights, weights).ravel()[inner]
    first, along, up = polygons[:, 0], polygons[:, 1] - polygons[:, 0], polygons[:, 3] - polygons[:, 0]
    at = first[:, None] + x[inner, None] * along[:, None] + y[inner, None] * up[:, None]
    return at, np.tile(shares, (len(polygons), 1))


RULES = {LEAST: _diagonals, SECTION: _scattered}  # of parallelograms, by points along a side; of others a grid


def _fan(polygons: np.ndarray, centres: np.ndarray, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of convex polygons (n, k, …) but their corners, by triangles about places within: places, shares."""
    n = len(polygons)
    one = polygons - centres[:, None]
    two = np.roll(one, -1, axis=1)
    areas = np.linalg.norm(np.cross(one[:, :, :3], two[:, :, :3]), axis=2)
    areas /= areas.sum(axis=1)[:, None]
    places, shares = [centres[:, None]], [np.full((n, 1), 1.0 / (12.0 * m * m))]

    def put(p: float, q: float, parts: np.ndarray) -> None:
        """Add points p along one side of each triangle and q along the other, as seen from the centre."""
        places.append(centres[:, None] + p * one + q * two)
        shares.append(parts)

    for s in range(1, m + 1):
        if s < m:
            put(s / m, 0.0, 0.25 * (areas + np.roll(areas, 1, axis=1)) / m**2)
        for t in range(1, s):
            put((s - t) / m, t / m, (0.5 if s < m else 0.25) * areas / m**2)
    for s in range(m):
        for t in range(s + 1):
            put((s - t + 1.0 / 3.0) / m, (t + 1.0 / 3.0) / m, 0.75 * areas / m**2)
            if t < s:
                put((s - t - 1.0 / 3.0) / m, (t + 2.0 / 3.0) / m, 0.75 * areas / m**2)
    return np.concatenate(places, axis=1), np.concatenate(shares, axis=1)
