"""Polygons in the plane: pure functions of arrays of corners (n, 2) [m], counter-clockwise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.geometry.rotation import across, cross, turned_as_one

ROUND_OFF = 1e-9  # relative to the size of the polygon: what counts as coincident or collinear


class AreaProperties(NamedTuple):
    """Area, centroid and polar moment of one polygon, or of many (then each field has one row per polygon)."""

    area: np.ndarray  # [m2]
    centroid: np.ndarray  # [m], (..., 2)
    polar_moment: np.ndarray  # second moment of area about the centroid, Ixx + Iyy [m4]


def size(vertices: np.ndarray) -> float:
    """Compute the diagonal of the bounding box of a polygon [m]."""
    return float(np.hypot(*np.ptp(np.asarray(vertices, float), axis=0)))


def sizes(vertices: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Compute the diagonals of the bounding boxes of m polygons [m], (m,)."""
    low = np.minimum.reduceat(vertices, starts[:-1], axis=0)
    high = np.maximum.reduceat(vertices, starts[:-1], axis=0)
    return np.hypot(*(high - low).T)


def following(starts: np.ndarray) -> np.ndarray:
    """Find the next corner around for each corner of m polygons."""
    after = np.arange(1, starts[-1] + 1)
    after[starts[1:] - 1] = starts[:-1]
    return after


def signed_area(vertices: np.ndarray) -> float:
    """Compute the area of a polygon [m2], negative where the corners run clockwise. Equal to that of `properties` to
    the last bit, six times as fast.
    """
    corners = np.asarray(vertices, float)
    arms = corners - corners[0]
    twice = cross(arms, np.concatenate((arms[1:], arms[:1])))
    return float(np.add.reduceat(twice, [0])[0]) / 2.0


def area(vertices: np.ndarray) -> float:
    """Compute the area of a polygon [m2], positive whatever the sense of the corners."""
    return abs(signed_area(vertices))


def centroid(vertices: np.ndarray) -> np.ndarray:
    """Compute the centroid of the area of a polygon [m], (2,)."""
    return properties(vertices).centroid


def polar_moment(vertices: np.ndarray) -> float:
    """Compute the second moment of area of a polygon about its centroid, Ixx + Iyy [m4]."""
    return abs(float(properties(vertices).polar_moment))


def properties(vertices: np.ndarray) -> AreaProperties:
    """Compute area, centroid and polar moment of one polygon; signed like the sense of its corners."""
    vertices = np.asarray(vertices, float)
    many = properties_of_all(vertices, np.array([0, len(vertices)]))
    return AreaProperties(many.area[0], many.centroid[0], many.polar_moment[0])


def properties_of_all(vertices: np.ndarray, starts: np.ndarray) -> AreaProperties:
    """Compute properties of m polygons at once; polygon p is vertices[starts[p]:starts[p + 1]], starts (m + 1,).

    Sums over triangles from the first corner of each, so that a polygon far from the origin loses no digits.
    Areas and moments are negative for clockwise corners; without area the centroid is the first corner.
    """
    first, counts = starts[:-1], np.diff(starts)
    origin = vertices[first]
    a = vertices - np.repeat(origin, counts, axis=0)
    b = a[following(starts)]
    twice = cross(a, b)
    doubled = np.add.reduceat(twice, first)
    moment = np.add.reduceat(twice[:, None] * (a + b), first, axis=0) / 3.0
    square = np.add.reduceat(twice * (a * a + a * b + b * b).sum(axis=1), first) / 12.0
    safe = np.where(doubled == 0.0, 1.0, doubled)
    offset = np.where((doubled == 0.0)[:, None], 0.0, moment / safe[:, None])
    area_ = doubled / 2.0
    return AreaProperties(area_, origin + offset, square - area_ * (offset * offset).sum(axis=1))


def compound(parts: AreaProperties, groups: np.ndarray, n_groups: int) -> AreaProperties:
    """Combine the area properties of parts into bodies; part p (area positive) belongs to body groups[p]."""
    total = np.bincount(groups, parts.area, n_groups)
    first = np.zeros((n_groups, 2))
    first[groups[::-1]] = parts.centroid[::-1]  # a point of each body, against loss of digits
    local = parts.centroid - first[groups]
    shift: np.ndarray = np.stack([np.bincount(groups, parts.area * local[:, k], n_groups) for k in (0, 1)], axis=1)
    shift = shift / np.where(total == 0.0, 1.0, total)[:, None]
    arm = local - shift[groups]
    polar = np.bincount(groups, parts.polar_moment + parts.area * (arm * arm).sum(axis=1), n_groups)
    return AreaProperties(total, first + shift, polar)


def is_convex(vertices: np.ndarray, tolerance: float = ROUND_OFF) -> bool:
    """Test whether the corners run counter-clockwise around a convex polygon; collinear corners are allowed."""
    vertices = np.asarray(vertices, float)
    return len(vertices) >= 3 and bool(are_convex(vertices, np.array([0, len(vertices)]), tolerance)[0])


def are_convex(vertices: np.ndarray, starts: np.ndarray, tolerance: float = ROUND_OFF) -> np.ndarray:
    """Test whether each of m polygons is convex, (m,); polygon p is vertices[starts[p]:starts[p + 1]]."""
    after_each = following(starts)
    edges = vertices[after_each] - vertices
    after = edges[after_each]
    turns = cross(edges, after)
    angles = np.add.reduceat(functions.arctan2(turns, (edges * after).sum(axis=1)), starts[:-1])
    once_around = np.abs(angles - 2.0 * np.pi) < 1.0
    least = tolerance * sizes(vertices, starts) ** 2
    left_turns = np.minimum.reduceat(turns, starts[:-1]) >= -least
    has_area = properties_of_all(vertices, starts).area > least
    return once_around & left_turns & has_area & (np.diff(starts) >= 3)


def in_order(points: Sequence | np.ndarray, tolerance: float = ROUND_OFF) -> np.ndarray:
    """Sort the corners of a convex polygon counter-clockwise from the lowest (then leftmost) one.

    Points on an edge between two corners do not change the shape and are left out.
    Raises ValueError: fewer than three points, the same point twice, no area, or a point inside the hull.
    """
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError("each corner is a pair [x, y]")
    if len(points) < 3:
        raise ValueError(f"a polygon needs at least 3 corners, found {len(points)}")
    gap = tolerance * size(points)
    order = np.lexsort((points[:, 0], points[:, 1]))
    _reject_duplicates(points, gap)
    hull = _hull(points[order], gap)
    if len(hull) < 3 or area(hull) <= gap * size(points):
        raise ValueError("the corners lie on one line: the polygon has no area")
    inside = _depth(points, hull) > gap
    if inside.any():
        k = int(np.argmax(inside))
        raise ValueError(
            f"corner {k + 1}, {_text(points[k])}, lies inside the polygon of the others; "
            "a block must be convex: split a concave one into convex parts"
        )
    return hull


def _reject_duplicates(points: np.ndarray, gap: float) -> None:
    distance = np.abs(points[:, None, :] - points[None, :, :]).max(axis=2)
    i, j = np.nonzero(np.triu(distance <= gap, 1))
    if len(i):
        place = _text(points[i[0]])
        raise ValueError(f"corners {i[0] + 1} and {j[0] + 1} are the same point, {place}; give each once")


def _hull(ordered: np.ndarray, gap: float) -> np.ndarray:
    """Compute the strict convex hull of points sorted by y then x; counter-clockwise."""
    return ordered[outline(ordered, gap)]


def outline(ordered: np.ndarray, gap: float) -> list[int]:
    """Find the corners of the strict convex hull of points (n, 2) sorted by y then x, by the monotone chain; returns
    their numbers.

    Counter-clockwise; points within `gap` [m] of the line between their neighbours are no corners.
    """

    def chain(numbers: range) -> list[int]:
        kept: list[int] = []
        for k in numbers:
            while len(kept) > 1 and _left_of(ordered[kept[-2]], ordered[k], ordered[kept[-1]]) >= -gap:
                kept.pop()
            kept.append(k)
        return kept[:-1]

    n = len(ordered)
    return chain(range(n)) + chain(range(n - 1, -1, -1))


def _left_of(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> float:
    """Distance of p from the line a -> b, positive to the left [m]."""
    x, y = b - a
    return float((x * (p[1] - a[1]) - y * (p[0] - a[0])) / np.hypot(x, y))


def _depth(points: np.ndarray, hull: np.ndarray) -> np.ndarray:
    """Distance of each point to the nearest edge of the hull, positive inside [m]."""
    edges = np.roll(hull, -1, axis=0) - hull
    normals = across(edges) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    return ((points[:, None, :] - hull[None, :, :]) * normals[None, :, :]).sum(axis=2).min(axis=1)


def _text(point: np.ndarray) -> str:
    return f"[{point[0]:g}, {point[1]:g}]"


def simplified(vertices: np.ndarray, tolerance: float = ROUND_OFF) -> np.ndarray:
    """Remove repeated corners and corners on straight edges from a polygon, (m, 2); order kept."""
    vertices = np.asarray(vertices, float)
    gap = tolerance * size(vertices)
    kept = vertices[np.hypot(*(vertices - np.roll(vertices, 1, axis=0)).T) > gap]
    if len(kept) < 3:
        return kept
    before, after = np.roll(kept, 1, axis=0), np.roll(kept, -1, axis=0)
    chord = after - before
    offset = chord[:, 0] * (kept[:, 1] - before[:, 1]) - chord[:, 1] * (kept[:, 0] - before[:, 0])
    return kept[np.abs(offset) > gap * np.hypot(chord[:, 0], chord[:, 1])]


def rectangle(x: float, y: float, width: float, height: float) -> np.ndarray:
    """Build the corners of a rectangle from its lower left corner, (4, 2)."""
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def upright_box(vertices: np.ndarray) -> tuple[float, float, float, float] | None:
    """Return left, bottom, right and top of a polygon that is exactly a level rectangle [m]; None where it is not."""
    (x0, y0), (x1, y1) = vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()
    at_sides = np.isin(vertices[:, 0], [x0, x1]) & np.isin(vertices[:, 1], [y0, y1])
    return (x0, y0, x1, y1) if len(vertices) == 4 and at_sides.all() else None


def moved(vertices: np.ndarray, angle: float, shift: Sequence[float]) -> np.ndarray:
    """Turn a polygon about the origin by angle [rad], then shift it [m]; an angle of 0 is exact."""
    vertices = np.asarray(vertices, float)
    if angle:
        vertices = turned_as_one(vertices, angle)
    return vertices + np.asarray(shift, float)
