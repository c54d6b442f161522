"""Convex polyhedra in space: corners and faces, the hull of points, faces that are given, prisms of polygons."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Polyhedron(NamedTuple):
    """One convex polyhedron."""

    vertices: np.ndarray  # corners [m], (n, 3)
    faces: tuple[np.ndarray, ...]  # of each face the numbers of its corners, counter-clockwise seen from outside
