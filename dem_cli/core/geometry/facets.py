"""Flat sides (facets) of polyhedral surfaces and outlines: triangles of one plane taken together; any dimension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry.polyhedron import newell


class Facets(NamedTuple):
    """Flat sides of one solid, or edges of one polygon in the plane."""

    points: np.ndarray  # corners [m], (n, d)
    loops: Sequence[np.ndarray]  # of each piece of the surface its corners, outwards; in the plane both ends of an edge
    sides: np.ndarray  # flat side that each piece belongs to, (m,)
    normals: np.ndarray  # outward and unit, of each side, (k, d)
    heights: np.ndarray  # of each side over the origin [m], (k,)

    @property
    def corners(self) -> list[np.ndarray]:
        """Numbers of the corners of each flat side, each corner once."""
        flat, owners = np.concatenate(self.loops), np.repeat(self.sides, [len(loop) for loop in self.loops])
        owners, flat = np.divmod(np.unique(owners * len(self.points) + flat), len(self.points))
        ends = np.cumsum(np.bincount(owners, minlength=len(self.normals)))[:-1]
        return np.split(flat, ends)

    def over(self) -> np.ndarray:
        """Compute the height of each corner in front of the plane of each side [m], (n, k)."""
        return product(self.points, self.normals.T) - self.heights

    def triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """Triangulate the surface of a solid by fans of its pieces; returns triangles and the side of each."""
        fans = [((loop[0], a, b), k) for loop, k in zip(self.loops, self.sides) for a, b in zip(loop[1:-1], loop[2:])]
        return np.array([fan for fan, _ in fans]), np.array([k for _, k in fans])


def facets_of_outline(points: np.ndarray) -> Facets:
    """Make facets of the edges of a polygon (n, 2), counter-clockwise."""
    n = len(points)
    loops = np.column_stack([np.arange(n), (np.arange(n) + 1) % n])
    along = points[loops[:, 1]] - points[loops[:, 0]]
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    return Facets(points, list(loops), np.arange(n), normals, (points * normals).sum(axis=1))


def facets_of_surface(points: np.ndarray, loops: Sequence[np.ndarray], gap: float) -> Facets:
    """Group the faces of a closed surface into flat sides: faces with all corners within `gap` [m] of one plane.

    Faces that are not plane to that are cut into triangles first. The largest face says where a plane is.
    """
    loops = [piece for loop in loops for piece in _flat(points, loop, gap)]
    areas = _areas(points, loops)
    sizes = np.linalg.norm(areas, axis=1)
    normals = areas / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    starts = np.concatenate([[0], np.cumsum([len(loop) for loop in loops])])
    flat = points[np.concatenate(loops)]
    sides = np.full(len(loops), -1)
    found: list[np.ndarray] = []
    heights: list[float] = []
    for k in np.argsort(-sizes, kind="stable"):
        if sides[k] >= 0:
            continue
        height = float(product(points[loops[k]], normals[k]).mean())
        off = np.maximum.reduceat(np.abs(product(flat, normals[k]) - height), starts[:-1])
        own = (sides < 0) & (off <= gap) & ((product(normals, normals[k]) > 0.5) | (sizes == 0.0))
        own[k] = True
        sides[own] = len(found)
        found.append(normals[k])
        heights.append(height)
    return Facets(points, loops, sides, np.array(found), np.array(heights))


def _areas(points: np.ndarray, loops: Sequence[np.ndarray]) -> np.ndarray:
    """Compute the areas of faces times their normals [m²], (n, 3)."""
    if any(len(loop) != 3 for loop in loops):
        return np.array([newell(points[loop]) for loop in loops])
    a, b, c = np.moveaxis(points[np.array(loops)], 1, 0)
    return 0.5 * np.cross(b - a, c - a)


def _flat(points: np.ndarray, loop: np.ndarray, gap: float) -> list[np.ndarray]:
    """Return a plane face as it is, or the triangles of a face that is not plane within `gap` [m]."""
    if len(loop) == 3:
        return [loop]
    area = newell(points[loop])
    length = float(norm(area))
    off = np.abs(product(points[loop] - points[loop].mean(axis=0), area)).max()
    if off <= gap * length:
        return [loop]
    return [np.array([loop[0], a, b]) for a, b in zip(loop[1:-1], loop[2:])]
