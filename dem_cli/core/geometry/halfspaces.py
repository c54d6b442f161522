"""Cuts of convex polyhedra by planes: both halves have the same corners, to the last bit, on their common cut."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.polyhedron import ROUND_OFF, Polyhedron, size


class Halves(NamedTuple):
    """Two halves of a polyhedron cut by a plane; None for a side with nothing, or with no more than a face."""

    behind: Polyhedron | None  # where the normal points away from
    beyond: Polyhedron | None  # where it points to


def halves(solid: Polyhedron, normal: Sequence[float] | np.ndarray, height: float) -> Halves:
    """Cut a polyhedron by the plane {x: normal · x = height} [m]; normal: of length one, (3,).

    Corners that lie on the plane but for round-off stay where they are, and belong to both.
    """
    heights = product(solid.vertices, np.asarray(normal, float)) - height
    heights[np.abs(heights) <= ROUND_OFF * size(solid.vertices)] = 0.0
    if (heights <= 0.0).all():
        return Halves(solid, None)
    if (heights >= 0.0).all():
        return Halves(None, solid)
    vertices, crossings = _with_crossings(solid, heights)
    full = np.concatenate([heights, np.zeros(len(vertices) - len(heights))])
    loops = [_with_corners(face, crossings) for face in solid.faces]
    return Halves(_half(vertices, loops, full), _half(vertices, loops, -full))


def behind_all(solid: Polyhedron, planes: Sequence[tuple[np.ndarray, float]]) -> Polyhedron | None:
    """Cut a polyhedron down to the part behind every plane (normal, height); None where nothing is left."""
    left: Polyhedron | None = solid
    for normal, height in planes:
        if left is None:
            break
        left = halves(left, normal, height).behind
    return left


def _with_crossings(solid: Polyhedron, heights: np.ndarray) -> tuple[np.ndarray, dict[tuple[int, int], int]]:
    """Add the corners on the cut to those of a solid; returns the number of the new corner on each edge {(i, j): k}, i
    < j.
    """
    found: dict[tuple[int, int], int] = {}
    places = [solid.vertices]
    for face in solid.faces:
        for i, j in zip(face.tolist(), np.roll(face, -1).tolist(), strict=True):
            if i < j and heights[i] * heights[j] < 0.0:  # each edge runs once either way
                share = heights[i] / (heights[i] - heights[j])
                found[i, j] = len(heights) + len(places) - 1
                places.append((solid.vertices[i] + share * (solid.vertices[j] - solid.vertices[i]))[None])
    return np.concatenate(places), found


def _with_corners(face: np.ndarray, crossings: dict[tuple[int, int], int]) -> list[int]:
    """Insert the corners that a cut adds into the loop of a face."""
    loop = []
    for i, j in zip(face.tolist(), np.roll(face, -1).tolist(), strict=True):
        loop.append(i)
        between = crossings.get((min(i, j), max(i, j)))
        if between is not None:
            loop.append(between)
    return loop


def _half(vertices: np.ndarray, loops: list[list[int]], heights: np.ndarray) -> Polyhedron:
    """Build the part of a polyhedron where heights are not positive, closed by a face on the cut."""
    kept = [[k for k in loop if heights[k] <= 0.0] for loop in loops]
    kept = [loop for loop in kept if len(loop) > 2 and any(heights[k] < 0.0 for k in loop)]
    after: dict[int, int] = {}  # around the cut, against the direction of the faces beside it
    for loop in kept:
        for i, j in zip(loop, loop[1:] + loop[:1], strict=True):
            if heights[i] == 0.0 and heights[j] == 0.0:
                after[j] = i
    cap = [next(iter(after))]
    while after[cap[-1]] != cap[0]:
        cap.append(after[cap[-1]])
    used, numbers = np.unique(np.concatenate([*kept, cap]), return_inverse=True)
    faces = np.split(numbers, np.cumsum([len(loop) for loop in (*kept, cap)])[:-1])
    return Polyhedron(vertices[used], tuple(face.astype(np.int64) for face in faces))
