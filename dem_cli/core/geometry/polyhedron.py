"""Convex polyhedra in space: corners and faces, the hull of points, faces that are given, prisms and boxes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.rotation import beside, turned_as_one

ROUND_OFF = 1e-9  # relative to the size of the polyhedron: what counts as the same point
COPLANAR = 1e-6  # relative to the same: points that close to a plane lie on it; faces touch that close (contact.start)


class Polyhedron(NamedTuple):
    """Convex polyhedron: its corners and its faces."""

    vertices: np.ndarray  # corners [m], (n, 3)
    faces: tuple[np.ndarray, ...]  # of each face the numbers of its corners, counter-clockwise seen from outside


def size(vertices: np.ndarray) -> float:
    """Compute the diagonal of the bounding box of a polyhedron [m]."""
    return float(norm(np.ptp(np.asarray(vertices, float), axis=0)))


def hull(points: Sequence | np.ndarray) -> Polyhedron:
    """Build the convex polyhedron whose corners are these points (n, 3), in any order.

    Points on a face or an edge of the others do not change the shape and are left out.
    Raises ValueError: fewer than four points, the same point twice, no volume, or a point inside the hull.
    """
    points = _checked(points)
    gap = COPLANAR * size(points)
    normals, heights = _planes(points, gap)
    depth = (heights[None, :] - product(points, normals.T)).min(axis=1)
    if (depth > gap).any():
        k = int(depth.argmax())
        raise ValueError(
            f"corner {k + 1}, {_text(points[k])}, lies inside the polyhedron of the others; "
            "a block must be convex: split a concave one into convex parts"
        )
    loops = []
    for normal, height in zip(normals, heights, strict=True):
        loop = _outline(points, np.flatnonzero(np.abs(product(points, normal) - height) <= gap), normal, gap)
        if len(loop) > 2:
            loops.append(loop)
    if _open_edge(loops) is not None:
        raise ValueError("some corners lie almost, but not quite, on one plane: its faces cannot be told apart")
    return _numbered(points, loops)


def from_faces(points: Sequence | np.ndarray, loops: Sequence[Sequence[int]]) -> Polyhedron:
    """Build the convex polyhedron with given corners (n, 3) and faces: loops of numbers of corners, from 0.

    Faces may run either way round; those that lie in one plane become one. Raises ValueError, with the face or corner:
    fewer than four of them, numbers that are no corner, not plane, not convex, not closed, no volume.
    """
    points = _checked(points)
    faces = [_loop_checked(points, loop, number) for number, loop in enumerate(loops, 1)]
    if len(faces) < 4:
        raise ValueError(f"a polyhedron needs at least 4 faces, found {len(faces)}")
    unused = np.setdiff1d(np.arange(len(points)), np.concatenate(faces))
    if len(unused):
        raise ValueError(f"corner {unused[0] + 1}, {_text(points[unused[0]])}, belongs to no face")
    faces = [_outwards(points, loop, number) for number, loop in enumerate(faces, 1)]
    edge = _open_edge(faces)
    if edge is not None:
        i, j = edge
        raise ValueError(
            f"the faces do not close: the edge from {_text(points[i])} to {_text(points[j])} must belong to two faces, "
            f"and belongs to {sum(_has_edge(loop, i, j) for loop in faces)}"
        )
    found = hull(points)  # with faces of one plane merged and without corners that are none
    if len(found.faces) == len(faces) and len(found.vertices) == len(points):
        return Polyhedron(points, tuple(faces))
    return found


def prism(corners: np.ndarray, low: float, high: float) -> Polyhedron:
    """Extrude a convex polygon (n, 2) in x and z from y = low to high [m]."""
    return prisms([corners], low, high)[0]


def prisms(polygons: Sequence[np.ndarray], low: np.ndarray | float, high: np.ndarray | float) -> list[Polyhedron]:
    """Extrude convex polygons (n, 2) in x and z, each from its y = low to high [m], or all from the same.

    Face k goes along edge k of the polygon; then come the one at y = low and that at y = high. Polygons that run
    clockwise are turned round.
    """
    if not len(polygons):
        return []
    counts = np.array([len(each) for each in polygons])
    areas = polygon.properties_of_all(np.concatenate(polygons), np.concatenate([[0], np.cumsum(counts)])).area
    flat = np.concatenate([each if area > 0.0 else each[::-1] for each, area in zip(polygons, areas, strict=True)])
    ends = np.repeat(
        np.broadcast_to(np.stack(np.broadcast_arrays(low, high), axis=-1), (len(counts), 2)), counts, axis=0
    )
    starts = np.concatenate([[0], np.cumsum(2 * counts)])
    first = np.arange(len(flat)) + np.repeat(np.cumsum(counts) - counts, counts)
    corners = np.empty((2 * len(flat), 3))
    for side, at in enumerate((first, first + np.repeat(counts, counts))):
        corners[at, 0], corners[at, 1], corners[at, 2] = flat[:, 0], ends[:, side], flat[:, 1]
    return [
        Polyhedron(corners[i:j], prism_faces(int(n))) for i, j, n in zip(starts[:-1], starts[1:], counts, strict=True)
    ]


def box(low: Sequence[float], high: Sequence[float]) -> Polyhedron:
    """Build a box with edges along the axes, between two opposite corners [m], (3,)."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return prism(np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]], float), y0, y1)


def moved(vertices: np.ndarray, angle: float, shift: Sequence[float]) -> np.ndarray:
    """Turn corners (n, 3) about the z axis by angle [rad], then shift them [m]; an angle of 0 is exact."""
    vertices = np.asarray(vertices, float)
    if angle:
        vertices = np.column_stack([turned_as_one(vertices[:, :2], angle), vertices[:, 2]])
    return vertices + np.asarray(shift, float)


def all_moved(solids: Sequence[Polyhedron], angle: float, shift: Sequence[float]) -> list[Polyhedron]:
    """Turn and shift many polyhedra at once, as `moved` does one."""
    if not solids:
        return []
    corners = moved(np.concatenate([solid.vertices for solid in solids]), angle, shift)
    ends = np.cumsum([len(solid.vertices) for solid in solids])
    pieces = np.split(corners, ends[:-1])
    return [Polyhedron(piece, solid.faces) for piece, solid in zip(pieces, solids, strict=True)]


def newell(loop: np.ndarray) -> np.ndarray:
    """Area times normal of a face from its corners (n, 3) [m²]: exact where it is plane, else the mean normal."""
    arms = loop - loop[0]
    return 0.5 * np.cross(arms, np.roll(arms, -1, axis=0)).sum(axis=0)


@cache
def prism_faces(n: int) -> tuple[np.ndarray, ...]:
    """List the faces of a prism between two loops of n corners, the second loop after the first.

    The n around, then the first loop, seen from outside counter-clockwise, and the second one.
    """
    around = [np.array([(i + 1) % n, i, n + i, n + (i + 1) % n]) for i in range(n)]
    return (*around, np.arange(n), np.arange(2 * n - 1, n - 1, -1))


def _checked(points: Sequence | np.ndarray) -> np.ndarray:
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError("each corner is a triple [x, y, z]")
    if len(points) < 4:
        raise ValueError(f"a polyhedron needs at least 4 corners, found {len(points)}")
    from scipy.spatial import cKDTree

    pairs = sorted(cKDTree(points).query_pairs(ROUND_OFF * size(points), p=np.inf))
    if pairs:
        i, j = pairs[0]
        raise ValueError(f"corners {i + 1} and {j + 1} are the same point, {_text(points[i])}; give each once")
    return points


def _planes(points: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute outward normals (m, 3) and heights over the origin (m,) of the faces of a hull, one for each plane.

    The largest facet of each plane says where it is: Qhull leaves slivers of no area, whose planes are arbitrary.
    """
    from scipy.spatial import ConvexHull, QhullError

    middle = points.mean(axis=0)
    try:
        found = ConvexHull(points - middle)
    except QhullError:
        raise ValueError("the corners lie in one plane: the polyhedron has no volume") from None
    if found.volume <= gap * size(points) ** 2:
        raise ValueError("the corners lie in one plane: the polyhedron has no volume")
    corners = found.points[found.simplices]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    waiting = np.ones(len(areas), bool)
    normals, heights = [], []
    for k in np.argsort(-areas, kind="stable"):
        if not waiting[k]:
            continue
        normal = found.equations[k, :3]
        height = float(product(corners[k], normal).mean())
        waiting &= (np.abs(product(corners, normal) - height) > gap).any(axis=1)
        waiting[k] = False
        normals.append(normal)
        heights.append(height + float(product(middle, normal)))
    return np.array(normals), np.array(heights)


def _outline(points: np.ndarray, on: np.ndarray, normal: np.ndarray, gap: float) -> np.ndarray:
    """Sort the points on the plane of a face around its outward normal; returns the numbers of its corners."""
    first = beside(normal[None])[0]
    flat = product(points[on], np.column_stack([first, np.cross(normal, first)]))
    order = np.lexsort((flat[:, 0], flat[:, 1]))
    return on[order[polygon.outline(flat[order], gap)]] if len(on) > 2 else on


def _numbered(points: np.ndarray, loops: Sequence[np.ndarray]) -> Polyhedron:
    """Build a polyhedron from only the corners that belong to a face, in the order in which they were given."""
    used = np.unique(np.concatenate(loops))
    return Polyhedron(points[used], tuple(np.searchsorted(used, loop) for loop in loops))


def _loop_checked(points: np.ndarray, loop: Sequence[int], number: int) -> np.ndarray:
    """Check that a face has at least three corners, each once. Raises ValueError."""
    corners = np.asarray(loop)
    if corners.ndim != 1 or len(corners) < 3 or corners.dtype.kind not in "iu":
        raise ValueError(f"face {number} needs at least 3 numbers of corners")
    wrong = (corners < 0) | (corners >= len(points))
    if wrong.any():
        raise ValueError(f"face {number} names corner {corners[wrong][0]}; corners count from 0 to {len(points) - 1}")
    if len(np.unique(corners)) < len(corners):
        raise ValueError(f"face {number} names a corner twice")
    return corners.astype(np.int64)


def _outwards(points: np.ndarray, loop: np.ndarray, number: int) -> np.ndarray:
    """Orient a face counter-clockwise seen from outside. Raises ValueError: not plane, not convex."""
    gap = COPLANAR * size(points)
    area = newell(points[loop])
    length = float(norm(area))
    if length <= gap * size(points[loop]):
        raise ValueError(f"face {number} has no area")
    normal = area / length
    heights = product(points - points[loop].mean(axis=0), normal)
    off = np.abs(heights[loop])
    if off.max() > gap:
        k = loop[off.argmax()]
        raise ValueError(
            f"face {number} is not plane: corner {k + 1}, {_text(points[k])}, lies {off.max():.3g} m off its plane"
        )
    if heights.max() > gap and heights.min() < -gap:
        k = int(heights.argmin() if -heights.min() < heights.max() else heights.argmax())
        raise ValueError(
            f"corner {k + 1}, {_text(points[k])}, lies on the other side of face {number} than the rest; "
            "a block must be convex: split a concave one into convex parts"
        )
    if heights.max() > gap:
        loop, normal = loop[::-1], -normal
    edges = np.roll(points[loop], -1, axis=0) - points[loop]
    turns = product(np.cross(edges, np.roll(edges, -1, axis=0)), normal)
    if turns.min() < -gap * size(points[loop]):
        k = np.roll(loop, -1)[turns.argmin()]
        raise ValueError(f"face {number} is not convex at corner {k + 1}, {_text(points[k])}")
    return loop


def _open_edge(loops: Sequence[np.ndarray]) -> tuple[int, int] | None:
    """Find an edge (two corners) that is not in two faces, once each way; None where the faces close."""
    starts, ends = np.concatenate(loops), np.concatenate([np.roll(loop, -1) for loop in loops])
    n = int(starts.max()) + 1
    there, back = np.sort(starts * n + ends), np.sort(ends * n + starts)
    twice = np.flatnonzero(np.diff(there) == 0)
    single = np.setdiff1d(there, back)
    wrong = there[twice[:1]] if len(twice) else single[:1]
    return (int(wrong[0]) // n, int(wrong[0]) % n) if len(wrong) else None


def _has_edge(loop: np.ndarray, i: int, j: int) -> bool:
    """Test whether a face has the edge between corners i and j, in either direction."""
    after = np.roll(loop, -1)
    return bool((((loop == i) & (after == j)) | ((loop == j) & (after == i))).any())


def _text(point: np.ndarray) -> str:
    return "[" + ", ".join(f"{x:g}" for x in point) + "]"
