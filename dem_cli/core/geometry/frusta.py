"""Frusta: polyhedra between two loops of corners, as voussoirs, wedges, drums and skewed prisms are."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.polyhedron import Polyhedron, hull, newell, prism_faces


def frustum(low: np.ndarray, high: np.ndarray) -> Polyhedron:
    """Build the polyhedron between two plane loops with equally many corners (n, 3), corner k joined to corner k.

    The faces between them must be plane. They may run either way round; where corners of both loops coincide, it is
    the wedge or pyramid that is left.
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    if product(newell(low + high), (high - low).mean(axis=0)) > 0.0:
        low, high = low[::-1], high[::-1]
    corners = np.concatenate([low, high])
    different = list(dict.fromkeys(map(tuple, corners.tolist())))
    return hull(different) if len(different) < len(corners) else Polyhedron(corners, prism_faces(len(low)))


def skewed(face: np.ndarray, shift: np.ndarray) -> Polyhedron:
    """Build a skewed prism from a plane face (n, 3) and a shift [m]; neighbours with one shift keep their common
    face.
    """
    return frustum(face + shift, face)


def regular(radius: float, sides: int, height: float) -> np.ndarray:
    """Compute the corners of a regular polygon about the z axis at a height [m], counter-clockwise from above, (sides,
    3).

    The sides are square to the axes where there are four: half a side is turned away from x.
    """
    angles = (2.0 * np.arange(sides) + 1.0) * (np.pi / sides)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(sides, height)])
