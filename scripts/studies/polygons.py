"""Polygons of blocks, by their corners counter-clockwise."""

from __future__ import annotations


def rectangle(left: float, bottom: float, right: float, top: float) -> list[list[float]]:
    """Upright, [[x, y], ...] [m]."""
    return [[left, bottom], [right, bottom], [right, top], [left, top]]
