"""Frusta: polyhedra between two loops of corners, as voussoirs, wedges, drums and skewed prisms are."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.polyhedron import Polyhedron, hull, newell, prism_faces


def frustum(low: np.ndarray, high: np.ndarray) -> Polyhedron:
    """The polyhedron between two plane loops of as many corners (n, 3), each joined to the one of the same number.

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
    """The prism from a plane face (n, 3) to where a shift [m] takes it; with a shift alike, neighbours stay so."""
    return frustum(face + shift, face)


def regular(radius: float, sides: int, height: float) -> np.ndarray:
    """Corners of a regular polygon about the z axis, at a height [m], counter-clockwise from above, (sides, 3).

    The sides are square to the axes where there are four: half a side is turned away from x.
    """
    angles = (2.0 * np.arange(sides) + 1.0) * (np.pi / sides)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(sides, height)])
