"""Convex profile of a joint that is not plane: a polygon on a flat surface (thesis 7.3.1).

Along the joint x [m], from 0 to its length; across it z [m], the height of the polygon over the flat surface.
All rises are tiny beside the length, so that the circle around the polygon is the parabola z = x²/2R.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

MIDDLE = 1e-9  # of the length: a vertex this near to the middle is at the middle


def polygon(lengths: Sequence[float] | np.ndarray, aperture: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of a polygon inscribed in a circle: places along the joint and initial gaps [m], each (n + 1,).

    lengths: of the n sides [m]; aperture: distance between the line through the ends of the polygon and the parallel
    line that touches it [m] (thesis 7.3.1, footnote 10). The polygon rests on the side that contains the middle of
    the joint; where a vertex is there, on the side before it. The gaps of the two ends of that side are exactly 0.
    Raises ValueError: fewer than two sides, a length that is not positive, or a negative aperture.
    """
    lengths = np.asarray(lengths, float)
    if lengths.ndim != 1 or len(lengths) < 2:
        raise ValueError("a profile has at least two sides")
    if not (lengths > 0.0).all() or aperture < 0.0:
        raise ValueError("lengths of sides are positive, and the aperture is not negative")
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    x = places - 0.5 * places[-1]
    # All vertices lie on x²/2R; the lowest one is the aperture below the ends.
    curvature = aperture / (x[-1] ** 2 - (x[1:-1] ** 2).min())  # 1/2R [1/m]
    rest = int(np.searchsorted(x, -MIDDLE * places[-1])) - 1
    # Height over the secant through the ends of that side: a product of which no factor turns its sign by rounding.
    return places, np.abs(curvature * (x - x[rest]) * (x - x[rest + 1]))


def cut(places: np.ndarray, rises: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Cut a chain from place `low` to `high` [m]: the vertices between them and two new ends, (m + 1,) each.

    Its first and last sides go on where the part is longer than the chain.
    """
    inner = (places > low) & (places < high)
    inner[[0, -1]] = False
    first, *_, last = slopes(places, rises)
    ends = np.interp([low, high], places, rises)
    ends += first * min(low - places[0], 0.0) * np.array([1.0, 0.0])
    ends += last * max(high - places[-1], 0.0) * np.array([0.0, 1.0])
    return np.concatenate([[low], places[inner], [high]]), np.concatenate([ends[:1], rises[inner], ends[1:]])


def slopes(places: np.ndarray, rises: np.ndarray) -> np.ndarray:
    """Slope of each side of a profile against the one the joint rests on [-], (n,); it grows from left to right."""
    return np.diff(rises) / np.diff(places)


def angles(places: np.ndarray, rises: np.ndarray) -> np.ndarray:
    """Compute the angle between each side of a profile and the next [rad], (n − 1,): the rotation from one contact to
    the next; small angles.
    """
    return np.diff(slopes(places, rises))


def regular(sides: int, central: float | None = None) -> np.ndarray:
    """Compute the lengths of the sides of a profile as shares of the joint, (n,): equal, or the middle one `central`.

    Raises ValueError: a central side of an even number of sides.
    """
    if central is None:
        return np.full(sides, 1.0 / sides)
    if sides % 2 == 0:
        raise ValueError(f"{sides} sides have none in the middle")
    shares = np.full(sides, (1.0 - central) / (sides - 1))
    shares[sides // 2] = central
    return shares
