"""Pressures, fill and falling loads on polygons in the plane, edge by edge: the oracle for [[pressure]] and [[fill]].

Force and moment of a linear pressure on an edge by Simpson's rule, which is exact for them. No roofs: what stands over
an edge up to a level lies on it. Faces look +x or -x within 60 degrees, or up.
"""

from __future__ import annotations

from math import cos, radians, sin, sqrt

import numpy as np

CLOSE = 1e-9  # m: edges on one line


def free_edges(polygons: list[np.ndarray], own: int) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Start, end and outward normal of what no other polygon covers of the edges of one (counter-clockwise)."""
    found = []
    corners = polygons[own]
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        length = np.hypot(*(end - start))
        along = (end - start) / length
        normal = np.array([along[1], -along[0]])
        taken = []
        for k, other in enumerate(polygons):
            for a, b in zip(other, np.roll(other, -1, axis=0)):
                on_line = max(abs((a - start) @ normal), abs((b - start) @ normal)) < CLOSE
                if k != own and on_line and (b - a) @ along < 0.0:
                    taken.append(((b - start) @ along, (a - start) @ along))
        at = 0.0
        for low, high in sorted(taken):
            if low > at + CLOSE and at < length - CLOSE:
                found.append((start + at * along, start + min(low, length) * along, normal))
            at = max(at, high)
        if at < length - CLOSE:
            found.append((start + at * along, end, normal))
    return found


def below(start: np.ndarray, end: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray] | None:
    """The part of an edge below a level; None: nothing."""
    if min(start[1], end[1]) >= level:
        return None
    if max(start[1], end[1]) <= level:
        return start, end
    cut = start + (level - start[1]) / (end[1] - start[1]) * (end - start)
    return (start, cut) if start[1] < level else (cut, end)


def wrench(start, end, per_length, about) -> np.ndarray:
    """fx, fy and moment of a force per length (a linear function of the point) along an edge."""
    points = np.array([start, (start + end) / 2, end])
    forces = np.array([per_length(point) for point in points]) * np.hypot(*(end - start))
    weights = np.array([1.0, 4.0, 1.0]) / 6.0
    arms = points - about
    moments = arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]
    return np.array([*(weights @ forces), weights @ moments])


def soil(table: dict) -> tuple[float, float]:
    """Weight per depth over gravity, horizontal over vertical stress: of a fluid, of earth (Rankine) or of a fill."""
    if "fluid" in table:
        return table["fluid"].get("density", 1000.0), 1.0
    if "earth" in table:
        slip = sin(radians(table["earth"]["friction_angle_deg"]))
        return table["earth"]["density"], (1.0 - slip) / (1.0 + slip)
    return table["density"], 1.0 - sin(radians(table["friction_angle_deg"])) if "friction_angle_deg" in table else 0.0


def surface_load(polygons: list[np.ndarray], own: int, about: np.ndarray, table: dict, gravity: float) -> np.ndarray:
    """What a pressure or a fill does to a polygon: fx, fy and the moment about a point."""
    density, sideways = soil(table)
    level = (table.get("fluid") or table.get("earth") or table)["level"]
    total = np.zeros(3)
    for start, end, normal in free_edges(polygons, own):
        if "face" in table:
            looks = normal[0] * {"+x": 1.0, "-x": -1.0}[table["face"]] >= cos(radians(60.0)) - 1e-9
        else:
            looks = normal[1] > 1e-9
        edge = below(start, end, level)
        if not looks or edge is None:
            continue
        lies = normal[1] if "fluid" in table else max(normal[1], 0.0)
        direction = -np.array([sideways * normal[0], lies])
        total += wrench(*edge, lambda p, d=direction: density * gravity * (level - p[1]) * d, about)
    return total


def upper_sides(polygons: list[np.ndarray]) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Polygon, right and left end of every side that looks up: counter-clockwise, it runs to the left."""
    sides = [(k, a, b) for k, corners in enumerate(polygons) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    return [(k, a, b) for k, a, b in sides if b[0] < a[0]]


def height(x: float, start: np.ndarray, end: np.ndarray) -> float:
    return start[1] + (x - start[0]) / (end[0] - start[0]) * (end[1] - start[1])


def falling(polygons: list[np.ndarray], at: np.ndarray, spread: float = 0.0) -> list[tuple[int, np.ndarray, float]]:
    """Polygons, points and shares of a load that falls on the sides that lie highest under a point; not above a joint.

    With a spread, evenly on so much of the depth to either side, where one side alone lies over each place.
    """
    sides = upper_sides(polygons)
    hits = [(height(at[0], a, b), k) for k, a, b in sides if b[0] < at[0] < a[0]]
    top, own = max(hit for hit in hits if hit[0] <= at[1] + sqrt(CLOSE))
    if not spread:
        return [(own, np.array([at[0], top]), 1.0)]
    reach, found = spread * (at[1] - top), []
    highest = {k: max(height((a[0] + b[0]) / 2, a, b) for n, a, b in sides if n == k) for k, _, _ in sides}
    for k, a, b in sides:
        low, high = max(b[0], at[0] - reach), min(a[0], at[0] + reach)
        if high > low and height((a[0] + b[0]) / 2, a, b) == highest[k]:
            middle = (low + high) / 2
            found.append((k, np.array([middle, height(middle, a, b)]), (high - low) / (2.0 * reach)))
    return found
