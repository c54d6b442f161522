"""Hidden surface removal by a depth buffer: the face of a convex part that each pixel of a picture shows.

Faces that look away are left out; the others are cut into rows of pixels between their left and right edges, and of all
that cover a pixel the nearest stays. Source: E. Catmull, A Subdivision Algorithm for Computer Display of Curved
Surfaces, 1974. Exact for any shapes and places, also for blocks that overlap, where sorting faces by depth is not.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.polygon import following

NOTHING = -1
_LEVELS = 1 << 38  # of depth; what is left of 63 bits counts faces
_AT_ONCE = 4_000_000  # pixels


class Window(NamedTuple):
    """Window of a picture: lower left corner, side of a pixel, and numbers of pixels."""

    low: np.ndarray  # [m], (2,)
    pixel: float  # [m]
    shape: tuple[int, int]  # rows and columns


class SeenSurface(NamedTuple):
    """Visible surface of a structure, row by row from below."""

    faces: np.ndarray  # face of each pixel, or NOTHING, (rows, columns)
    depths: np.ndarray  # towards the reader [m]; −∞ where there is nothing, (rows, columns)
    window: Window

    def shown(self, places: np.ndarray, tolerance: float) -> np.ndarray:
        """Test which points (n, 3) in picture coordinates are not hidden by more than a tolerance [m], (n,) bool."""
        rows, columns = self.faces.shape
        at = np.floor((places[:, :2] - self.window.low) / self.window.pixel).astype(np.int64)
        inside = (at >= 0).all(axis=1) & (at[:, 0] < columns) & (at[:, 1] < rows)
        column, row = np.where(inside[:, np.newaxis], at, 0).T
        return inside & (places[:, 2] >= self.depths[row, column] - tolerance)


class _Rings(NamedTuple):
    """Edges of all faces towards the viewer, in pixels."""

    starts: np.ndarray  # corners of each edge, (n_edges, 3)
    ends: np.ndarray
    owners: np.ndarray  # face of each edge, (n_edges,)
    planes: np.ndarray  # depth = a + b x + c y of each face, (n_faces, 3)


def window_of(low: np.ndarray, high: np.ndarray, most: int) -> Window:
    """Create a window with so many pixels along its longer side."""
    pixel = float((high - low).max()) / most
    columns, rows = np.maximum(1, np.ceil((high - low) / pixel - 1e-9)).astype(int)
    return Window(low, pixel, (int(rows), int(columns)))


def seen_surface(places: np.ndarray, starts: np.ndarray, corners: np.ndarray, window: Window) -> SeenSurface:
    """Find the visible surface of convex faces, which are counter-clockwise seen from outside.

    places: corners as the picture has them, to the right, upwards, towards the reader [m], (n, 3); face f has
    corners[starts[f]:starts[f + 1]].
    """
    rows, columns = window.shape
    depth = places[:, 2]
    far, near = (float(depth.min()), float(depth.max())) if len(depth) else (0.0, 0.0)
    step = (near - far or 1.0) / (_LEVELS - 1)
    keys = np.full(rows * columns, NOTHING, np.int64)
    n_faces = max(len(starts) - 1, 1)
    rings = _rings(places, starts, corners, window)
    for pixels, faces, depths in _covered(rings, rows, columns):
        level = np.clip((depths - far) / step, 0.0, _LEVELS - 1).astype(np.int64)
        np.maximum.at(keys, pixels, level * n_faces + faces)
    seen = keys != NOTHING
    faces = np.where(seen, keys % n_faces, NOTHING).reshape(rows, columns)
    depths = np.where(seen, far + step * (keys // n_faces), -np.inf).reshape(rows, columns)
    return SeenSurface(faces, depths, window)


def _rings(places: np.ndarray, starts: np.ndarray, corners: np.ndarray, window: Window) -> _Rings:
    at = places[corners]
    at = np.column_stack([(at[:, :2] - window.low) / window.pixel, at[:, 2]])
    after = at[following(starts)]
    owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    first = at[starts[:-1]]
    arms = at - first[owners], after - first[owners]
    normals = np.add.reduceat(np.cross(*arms), starts[:-1], axis=0)
    normals = np.where(normals[:, 2:] > 1e-9 * np.linalg.norm(normals, axis=1, keepdims=True), normals, 0.0)
    upright = np.where(normals[:, 2] > 0.0, normals[:, 2], 1.0)
    slopes = -normals[:, :2] / upright[:, np.newaxis]
    planes = np.column_stack([first[:, 2] - (slopes * first[:, :2]).sum(axis=1), slopes])
    front = normals[owners, 2] > 0.0
    return _Rings(at[front], after[front], owners[front], planes)


def _covered(rings: _Rings, rows: int, columns: int) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield the pixels that the faces cover, piece by piece: number of the pixel, face, depth."""
    edge, row = _crossings(rings, rows)
    a, b = rings.starts[edge], rings.ends[edge]
    x = a[:, 0] + (row + 0.5 - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    key, rises = rings.owners[edge] * rows + row, b[:, 1] > a[:, 1]
    left, right = (np.flatnonzero(side) for side in (~rises, rises))  # of a ring that runs counter-clockwise
    left, right = (side[np.lexsort((x[side], key[side]))] for side in (left, right))
    first, after = (np.clip(np.ceil(x[side] - 0.5), 0, columns).astype(np.int64) for side in (left, right))
    counts = np.maximum(after - first, 0)
    ends = np.cumsum(counts)
    pieces = np.searchsorted(ends, np.arange(_AT_ONCE, int(ends[-1]) if len(ends) else 0, _AT_ONCE))
    for low, high in zip([0, *pieces], [*pieces, len(counts)]):
        span = np.arange(low, high)
        n = counts[span]
        owner = np.repeat(span, n)
        column = np.arange(int(n.sum())) - np.repeat(np.cumsum(n) - n, n) + first[owner]
        line, face = row[left[owner]], rings.owners[edge[left[owner]]]
        plane = rings.planes[face]
        yield line * columns + column, face, plane[:, 0] + plane[:, 1] * (column + 0.5) + plane[:, 2] * (line + 0.5)


def _crossings(rings: _Rings, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges and the rows of pixels whose middle they cross."""
    heights = np.clip(np.ceil(np.stack([rings.starts[:, 1], rings.ends[:, 1]]) - 0.5), 0, rows).astype(np.int64)
    low, high = heights.min(axis=0), heights.max(axis=0)
    counts = high - low
    edge = np.repeat(np.arange(len(counts)), counts)
    return edge, np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts) + low[edge]
