"""Split the surfaces of a file into closed solids by their shared corners, and orient faces outwards.

Corners that are the same point are merged. Where an edge belongs to four faces or more, because solids touch, each face
goes on in the next one around the edge on its inner side. Open surfaces are refused, with the edge.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.connected_groups import connected_groups
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry.polyhedron import newell, size
from dem_cli.masonry.imports.contents import FileBody, FileProblem

SAME_POINT = 1e-6  # of the size of a body: corners that close are one
SAME_PLACE = 1e-3  # rad: faces of two solids that lie against each other, as files round them


class Shell(NamedTuple):
    """Closed surface of one solid."""

    points: np.ndarray  # corners [m], (n, 3)
    faces: tuple[np.ndarray, ...]  # numbers of their corners, counter-clockwise seen from outside

    @property
    def triangles(self) -> np.ndarray:
        """Triangle fans of all faces, (m, 3): signed sums over them are right also for concave faces."""
        return np.array([(loop[0], a, b) for loop in self.faces for a, b in zip(loop[1:-1], loop[2:])])

    @property
    def volume(self) -> float:
        """Volume [m3], negative where the faces look inwards."""
        a, b, c = (self.points[self.triangles[:, i]] - self.points.mean(axis=0) for i in range(3))
        return float((a * np.cross(b, c)).sum() / 6.0)


def shells_of(body: FileBody) -> list[Shell]:
    """Split a body into closed solids. Raises FileProblem: an open surface, or one without a clear inside."""
    loops = [loop for loop in map(_tidy, body.faces) if len(loop) > 2]
    if body.indexed and loops:
        edges = _Edges(loops)
        if (edges.counts == 2).all():
            return _solids(body.points, loops, edges.pairs())
    points, numbers = _merged(body.points)
    loops = [loop for loop in (_tidy(numbers[loop]) for loop in body.faces) if len(loop) > 2]
    loops = [loop for loop in loops if norm(newell(points[loop])) > (SAME_POINT * size(points[loop])) ** 2]
    if not loops:
        raise FileProblem("its faces have no area")
    edges = _Edges(loops)
    odd = np.flatnonzero(edges.counts % 2)
    if len(odd):
        raise FileProblem(_open_words(points, edges, odd))
    _refuse_twice(points, loops)
    many = np.flatnonzero(edges.counts > 2)
    around = [_around(points, loops, edges, int(k)) for k in many]
    return _solids(points, loops, np.concatenate([edges.pairs(), *around]))


class _Edges:
    """Edges of a surface: for each side of a face its ends, its face, and its edge."""

    def __init__(self, loops: list[np.ndarray]):
        start, end = np.concatenate(loops), np.concatenate([np.roll(loop, -1) for loop in loops])
        self.ends = np.column_stack([start, end])
        self.faces = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
        keys, self.numbers, self.counts = np.unique(
            np.sort(self.ends, axis=1), axis=0, return_inverse=True, return_counts=True
        )
        self.numbers = self.numbers.ravel()
        self.keys = keys
        self.order = np.argsort(self.numbers, kind="stable")
        self.starts = np.concatenate([[0], np.cumsum(self.counts)])

    def sides(self, edge: int) -> np.ndarray:
        """Return the sides of faces that run along an edge."""
        return self.order[self.starts[edge] : self.starts[edge + 1]]

    def pairs(self) -> np.ndarray:
        """Return the two faces of each edge shared by two, and whether both run the same way, (n, 3)."""
        two = self.starts[:-1][self.counts == 2]
        first, second = self.order[two], self.order[two + 1]
        same = (self.ends[first] == self.ends[second]).all(axis=1)
        return np.column_stack([self.faces[first], self.faces[second], same])


def _tidy(loop: np.ndarray) -> np.ndarray:
    """Remove repeated consecutive corners from a face."""
    return loop[loop != np.roll(loop, 1)] if len(loop) else loop


def _merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge coinciding points; returns the distinct ones and the index of each point among them."""
    from scipy.spatial import cKDTree

    exact, numbers = np.unique(points, axis=0, return_inverse=True)
    pairs = cKDTree(exact).query_pairs(SAME_POINT * size(points), output_type="ndarray")
    group = connected_groups(pairs, len(exact))
    _, first, which = np.unique(group, return_index=True, return_inverse=True)
    return exact[first], which[numbers.ravel()]


def _open_words(points: np.ndarray, edges: _Edges, odd: np.ndarray) -> str:
    a, b = points[edges.keys[odd[0]]]
    count = edges.counts[odd[0]]
    faces = "1 face" if count == 1 else f"{count} faces"
    more = f", and {len(odd) - 1} more such edges" if len(odd) > 1 else ""
    where = f"the edge from {_text(a)} to {_text(b)} belongs to {faces}"
    return f"the surface is not closed: {where} instead of two{more}"


def _refuse_twice(points: np.ndarray, loops: list[np.ndarray]) -> None:
    """Raise FileProblem where the same face occurs twice with the same orientation."""
    seen: dict[tuple[int, ...], int] = {}
    for number, loop in enumerate(loops):
        first = int(loop.argmin())
        key = tuple(np.roll(loop, -first).tolist())
        if key in seen:
            raise FileProblem(f"two solids are in the same place: the face around {_text(points[loop].mean(axis=0))}"
                              " is there twice")  # fmt: skip
        seen[key] = number


def _around(points: np.ndarray, loops: list[np.ndarray], edges: _Edges, edge: int) -> np.ndarray:
    """Pair the faces of one solid around an edge at which four or more faces meet, (n, 3)."""
    start, end = edges.keys[edge]
    along = points[end] - points[start]
    along = along / norm(along)
    sides = edges.sides(edge)
    forward = edges.ends[sides, 0] == start
    if forward.sum() * 2 != len(sides):
        a, b = points[edges.keys[edge]]
        raise FileProblem(
            f"{len(sides)} faces meet in the edge from {_text(a)} to {_text(b)}, and some look the wrong way: what is "
            "inside cannot be told; export each block as an object of its own"
        )
    normals = np.array([newell(points[loops[face]]) for face in edges.faces[sides]])
    inwards = np.cross(normals, along) * np.where(forward, 1.0, -1.0)[:, None]  # from the edge into the face
    axis = inwards[0] - product(inwards[0], along) * along
    axis = axis / norm(axis)
    angles = functions.arctan2(product(inwards, np.cross(along, axis)), product(inwards, axis))
    found = []
    for k in np.flatnonzero(forward):  # what is inside lies clockwise about the edge of a face that runs along it
        away = (angles[k] - angles) % (2.0 * np.pi)
        away = np.where(away < SAME_PLACE, 2.0 * np.pi, away)
        away[forward] = np.inf
        found.append((edges.faces[sides[k]], edges.faces[sides[int(away.argmin())]], 0))
    if len({second for _, second, _ in found}) < len(found):
        a, b = points[edges.keys[edge]]
        raise FileProblem(f"faces cross each other at the edge from {_text(a)} to {_text(b)}")
    return np.array(found)


def _solids(points: np.ndarray, loops: list[np.ndarray], pairs: np.ndarray) -> list[Shell]:
    """Group connected faces to shells, in the order of their first faces."""
    group = connected_groups(pairs[:, :2], len(loops))
    count = int(group.max(initial=-1)) + 1
    mended = np.unique(group[pairs[pairs[:, 2] != 0, 0]])
    turned = _turned(len(loops), pairs, group, mended) if len(mended) else np.zeros(len(loops), bool)
    order = np.argsort(group, kind="stable")
    ends = np.cumsum(np.bincount(group, minlength=count))[:-1]
    return [_shell(points, [loops[k][::-1] if turned[k] else loops[k] for k in own]) for own in np.split(order, ends)]


def _turned(n: int, pairs: np.ndarray, group: np.ndarray, mended: np.ndarray) -> np.ndarray:
    """Find the faces to flip so that neighbours run opposite ways, (n,) bool. Raises FileProblem if impossible."""
    near: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for a, b, same in pairs[np.isin(group[pairs[:, 0]], mended)].tolist():
        near[a].append((b, same))
        near[b].append((a, same))
    found = np.full(n, -1)
    for root in np.flatnonzero(np.isin(group, mended)).tolist():
        if found[root] >= 0:
            continue
        found[root], waiting = 0, [root]
        for face, state in _walk(waiting, near, found):
            if found[face] != state:
                raise FileProblem("its surface has one side only, like a Möbius strip: nothing is inside")
    return found > 0


def _walk(waiting: list[int], near: list[list[tuple[int, int]]], found: np.ndarray) -> Iterator[tuple[int, int]]:
    """Walk over neighbouring faces and propagate their orientation; yields each neighbour and its required state."""
    while waiting:
        face = waiting.pop()
        for other, same in near[face]:
            state = int(found[face]) ^ same
            if found[other] < 0:
                found[other] = state
                waiting.append(other)
            yield other, state


def _shell(points: np.ndarray, loops: list[np.ndarray]) -> Shell:
    used, numbers = np.unique(np.concatenate(loops), return_inverse=True)
    ends = np.cumsum([len(loop) for loop in loops])[:-1]
    found = Shell(points[used], tuple(np.split(numbers.ravel(), ends)))
    volume = found.volume
    if abs(volume) <= 1e-9 * size(found.points) ** 3:
        raise FileProblem(f"a solid around {_text(found.points.mean(axis=0))} has no volume")
    return found if volume > 0.0 else Shell(found.points, tuple(loop[::-1] for loop in found.faces))


def _text(point: np.ndarray) -> str:
    return "[" + ", ".join(f"{x:.6g}" for x in point) + "]"
