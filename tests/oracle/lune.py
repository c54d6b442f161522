"""Least thickness of a dome of plane facets under its own weight: forces between stones of a lune, a linear program.

A lune is what lies between two meridians. At each bed it has a normal force at the inner and one at the outer edge and
a friction force, at its heads (with `hoops`) hoop compression at four corners; by symmetry all lunes are alike and no
friction acts on heads. Written apart from `dem`: volumes and centroids are those of pyramids from the centre over
trapezia with corners on the unit sphere. Heyman (1967), "On shell solutions for masonry domes", Int. J. Solids
Structures 3, finds 0.042 of the radius for the hemisphere of thin lunes without hoops.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog


class FacetedDome(NamedTuple):
    """A dome of mean radius 1 that one stone closes, half a course in angle."""

    courses: int
    facets: int
    friction: float
    springing: float = np.pi / 2.0  # from the crown [rad]
    hoops: bool = True  # whether heads carry compression

    @property
    def angles(self) -> np.ndarray:
        """Bed joints from the springing up [rad]."""
        return np.linspace(self.springing, self.springing / (2 * self.courses + 1), self.courses + 1)


def least_thickness(dome: FacetedDome, low: float = 0.01, high: float = 0.3, width: float = 1e-6) -> float:
    """The least thickness over mean radius with which forces in equilibrium exist; nan: none up to `high`."""
    if not stands(dome, high):
        return float("nan")
    while high - low > width:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(dome, middle) else (middle, high)
    return high


def stands(dome: FacetedDome, thickness: float) -> bool:
    """Whether forces in equilibrium exist."""
    beta, angles = np.pi / dome.facets, dome.angles
    radii = (1.0 - thickness / 2.0, 1.0 + thickness / 2.0)
    cubes, fourths = (radii[1] ** p - radii[0] ** p for p in (3, 4))
    beds, heads = 3 * len(angles), 4 if dome.hoops else 0
    n = beds + heads * dome.courses
    balance, weights = [], []
    for k, (low, high) in enumerate(zip(angles[:-1], angles[1:], strict=True)):
        volume, face = _pyramid(low, high, beta)
        centre = 0.75 * face * fourths / cubes
        rows = np.zeros((3, n))
        for j, sign in ((k, 1.0), (k + 1, -1.0)):
            out, down = _axes(angles[j], beta)
            for i, radius in enumerate(radii):
                _add(rows, 3 * j + i, radius * _along(angles[j], beta) - centre, -sign * down)
            _add(rows, 3 * j + 2, _along(angles[j], beta) - centre, sign * out)
        if dome.hoops:
            corners = [
                radius * np.array([np.sin(a) * np.cos(beta), np.cos(a)]) for a in (low, high) for radius in radii
            ]
            for i, corner in enumerate(corners):
                _add(rows, beds + heads * k + i, corner - centre, np.array([2.0 * np.sin(beta), 0.0]))
        balance += list(rows)
        weights += [0.0, volume * cubes, 0.0]
    out, down = _axes(angles[-1], beta)
    cap = np.zeros(n)  # what the stone at the crown weighs, by facet; by symmetry it is in balance otherwise
    cap[beds - 3 : beds] = [-down[1], -down[1], out[1]]
    balance.append(cap)
    weights.append(np.sin(2.0 * beta) / 6.0 * np.sin(angles[-1]) ** 2 * np.cos(angles[-1]) * cubes)
    cones = np.zeros((2 * len(angles), n))
    for k in range(len(angles)):
        cones[2 * k : 2 * k + 2, 3 * k : 3 * k + 2] = -dome.friction
        cones[2 * k : 2 * k + 2, 3 * k + 2] = 1.0, -1.0
    bounds = [(0.0, None), (0.0, None), (None, None)] * len(angles) + [(0.0, None)] * (heads * dome.courses)
    found = linprog(
        np.zeros(n), cones, np.zeros(len(cones)), np.array(balance), np.array(weights) / sum(weights), bounds
    )
    return found.status == 0


def _along(angle: float, beta: float) -> np.ndarray:
    """Middle of a bed on the unit sphere, in the plane of symmetry of its lune: outwards and up, (2,)."""
    return np.array([np.sin(angle) * np.cos(beta), np.cos(angle)])


def _axes(angle: float, beta: float) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors in a bed joint, outwards, and square to it, downwards."""
    out = _along(angle, beta) / np.linalg.norm(_along(angle, beta))
    return out, np.array([out[1], -out[0]])


def _pyramid(low: float, high: float, beta: float) -> tuple[float, np.ndarray]:
    """Volume of the pyramid from the centre over a facet of the unit sphere, and the centroid of that facet."""
    a, b = _along(low, beta), _along(high, beta)
    wide, narrow = 2.0 * np.sin(low) * np.sin(beta), 2.0 * np.sin(high) * np.sin(beta)
    volume = (wide + narrow) / 6.0 * abs(a[0] * b[1] - a[1] * b[0])
    return float(volume), a + (b - a) * (wide + 2.0 * narrow) / (3.0 * (wide + narrow))


def _add(rows: np.ndarray, column: int, arm: np.ndarray, force: np.ndarray) -> None:
    rows[:2, column] += force
    rows[2, column] += arm[0] * force[1] - arm[1] * force[0]
