"""Benchmark structures as plain polygons, written apart from dem_cli.masonry.structures: lists of (n, 2) arrays."""

from __future__ import annotations

import numpy as np


def rectangle(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float)


def running_wall(n_blocks: int, n_courses: int, length: float = 0.04, height: float = 0.0175):
    """Running bond on a fixed course of full blocks; the first free course starts with half blocks."""
    polygons = [rectangle(i * length, -height, (i + 1) * length, 0.0) for i in range(n_blocks)]
    fixed = [True] * n_blocks
    for course in range(n_courses):
        y = course * height
        edges = np.arange(n_blocks + 1) * length
        if course % 2 == 0:
            edges = np.concatenate([[0.0], edges[:-1] + length / 2, [n_blocks * length]])
        for left, right in zip(edges[:-1], edges[1:], strict=True):
            polygons.append(rectangle(left, y, right, y + height))
            fixed.append(False)
    return polygons, fixed


def column(n_blocks: int, width: float, height: float):
    """Equal blocks on a fixed block of the same size."""
    polygons = [rectangle(0.0, (i - 1) * height, width, i * height) for i in range(n_blocks + 1)]
    return polygons, [True] + [False] * n_blocks


def ring(n_voussoirs: int, inner: float, outer: float, centre=(0.0, 0.0), start=180.0, end=0.0):
    """Voussoirs from the left springing to the right one; radial joints, straight intrados and extrados."""
    angles = np.radians(np.linspace(start, end, n_voussoirs + 1))
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    return [
        np.asarray(centre) + np.array([inner * p, outer * p, outer * q, inner * q])
        for p, q in zip(rays[:-1], rays[1:], strict=True)
    ]


def arch(n_voussoirs: int, radius: float, thickness: float):
    """Semicircular arch on two fixed springing blocks."""
    inner, outer = radius - thickness / 2, radius + thickness / 2
    depth = thickness / 2
    springings = [rectangle(-outer, -depth, -inner, 0.0), rectangle(inner, -depth, outer, 0.0)]
    return springings + ring(n_voussoirs, inner, outer), [True, True] + [False] * n_voussoirs


def portal():
    """Arch on two monolithic columns (thesis 6.2, geometry of the data book) on a fixed base."""
    base = rectangle(-0.4, -0.1, 0.4, 0.0)
    columns = [rectangle(-0.36, 0.0, -0.2, 0.32), rectangle(0.2, 0.0, 0.36, 0.32)]
    return [base, *columns, *ring(6, 0.2, 0.28, centre=(0.0, 0.32))], [True] + [False] * 8


def drums(n_drums: int, base: float, top: float, height: float, cap: float = 0.0):
    """Tapered column of equal drums, with a cap as wide as the top where `cap` > 0, on a fixed block."""
    levels = np.linspace(0.0, height, n_drums + 1)
    widths = np.linspace(base, top, n_drums + 1)
    polygons = [rectangle(-base, -0.5, base, 0.0)]
    for y0, y1, w0, w1 in zip(levels[:-1], levels[1:], widths[:-1], widths[1:], strict=True):
        polygons.append(np.array([[-w0 / 2, y0], [w0 / 2, y0], [w1 / 2, y1], [-w1 / 2, y1]]))
    if cap:
        polygons.append(rectangle(-top / 2, height, top / 2, height + cap))
    return polygons, [True] + [False] * (len(polygons) - 1)
