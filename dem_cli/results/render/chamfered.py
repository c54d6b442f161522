"""Surfaces of polyhedra with narrow chamfers, as dressed stones have, which catch the light.

Every face draws back from its edges by the chamfer; between two faces lies a strip, and around every corner a polygon.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry import spatial_parts
from dem_cli.core.model.model import Model
from dem_cli.results.post import frame_measures

_CHAMFER = 0.04  # of the narrowest side of an ordinary block
_LARGEST_CHAMFER = 0.006  # of the size of the structure
_WIDEST_CHAMFER = 0.12  # of the narrowest side of the block itself


class Surface(NamedTuple):
    """Surface of all blocks as faces."""

    points: np.ndarray  # from the centroid of their block [m], (n, 3)
    owners: np.ndarray  # block of each point, (n,)
    faces: np.ndarray  # as VTK has them: number of corners, then the corners, face after face
    face_owners: np.ndarray  # block of each face, (n_faces,)
    edges: np.ndarray  # sharp edges, between two points each, (n_edges, 2)


class _Sides(NamedTuple):
    """Sides of all faces of polyhedra, in order around each face."""

    corners: np.ndarray  # where it starts, (n,)
    faces: np.ndarray  # (n,)
    before: np.ndarray  # side before it on the same face, (n,)
    after: np.ndarray  # side after it, (n,)
    twins: np.ndarray  # the same edge as the other face has it, (n,)


def sharp(model: Model) -> Surface:
    """Create the faces and edges of all blocks in space, without faces between parts of one block."""
    topology, outer = model.topology, ~model.inner_faces
    corners = topology.face_corners
    faces = [_listed(corners[rows]) for rows in _rings(topology.face_starts, outer)]
    owners = model.part_blocks[topology.face_parts]
    sizes = np.diff(topology.face_starts)
    ordered = [owners[outer & (sizes == count)] for count in np.unique(sizes[outer])]
    edges = topology.edges[outer[topology.edges[:, 2:]].all(axis=1), :2]
    return Surface(model.vertices, model.vertex_blocks, np.concatenate(faces), np.concatenate(ordered), edges)


def chamfered(model: Model) -> Surface:
    """Create the chamfered faces of all blocks in space, without faces between parts of one block."""
    topology, sides = model.topology, _sides(model)
    owners = model.part_blocks[topology.face_parts]
    outer = ~model.inner_faces
    meet = ~outer[sides.faces] | ~outer[sides.faces[sides.twins]]  # no edge: the block goes on behind it
    places = _drawn_back(model, sides, np.where(meet, 0.0, _chamfers(model)[sides.faces]))
    strips = np.flatnonzero((np.arange(len(sides.twins)) < sides.twins) & ~meet)
    twins = sides.twins[strips]
    ends = np.column_stack([sides.after[strips], strips, sides.after[twins], twins])
    rings = [*_rings(topology.face_starts, outer), *_around_corners(sides)]
    middles = 0.5 * np.stack([places[strips] + places[ends[:, 2]], places[ends[:, 0]] + places[twins]], axis=1)
    n = len(places)
    faces = [_listed(np.arange(n)[rows]) for rows in rings] + [_listed(ends)]
    face_owners = [owners[sides.faces[rows[:, 0]]] for rows in rings] + [owners[sides.faces[strips]]]
    return Surface(
        points=np.concatenate([places, middles.reshape(-1, 3)]),
        owners=np.concatenate([owners[sides.faces], np.repeat(owners[sides.faces[strips]], 2)]),
        faces=np.concatenate(faces),
        face_owners=np.concatenate(face_owners),
        edges=n + np.arange(2 * len(strips)).reshape(-1, 2),
    )


def _sides(model: Model) -> _Sides:
    topology = model.topology
    start, end, faces = topology.sides.T
    n = len(start)
    after = np.arange(1, n + 1)
    after[topology.face_starts[1:] - 1] = topology.face_starts[:-1]
    before = np.empty(n, np.int64)
    before[after] = np.arange(n)
    there, back = np.lexsort((end, start)), np.lexsort((start, end))
    twins = np.empty(n, np.int64)
    twins[there] = back
    return _Sides(start, faces, before, after, twins)


def _chamfers(model: Model) -> np.ndarray:
    """Compute the chamfer of each face [m], (n_faces,)."""
    topology = model.topology
    widths = spatial_parts.widths(model.vertices, model.part_starts, topology)
    usual = min(_CHAMFER * float(np.median(widths)), _LARGEST_CHAMFER * frame_measures.size(model))
    return np.minimum(usual, _WIDEST_CHAMFER * widths)[topology.face_parts]


def _drawn_back(model: Model, sides: _Sides, distances: np.ndarray) -> np.ndarray:
    """Move the corners of faces inwards by given distances from both sides [m], (n_sides, 3)."""
    corners = model.vertices[sides.corners]
    along = corners[sides.after] - corners
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    normals = spatial_parts.normals(model.vertices, model.topology)[sides.faces]
    incoming = along[sides.before]
    sine = np.einsum("nk,nk->n", np.cross(incoming, along), normals)
    move = distances[sides.before, np.newaxis] * along - distances[:, np.newaxis] * incoming
    return corners + move / np.maximum(sine, 1e-6)[:, np.newaxis]


def _rings(starts: np.ndarray, kept: np.ndarray) -> list[np.ndarray]:
    """Group the sides of the kept faces by their number of corners, (n, count) each."""
    counts = np.diff(starts)
    return [starts[:-1][kept & (counts == count), np.newaxis] + np.arange(count) for count in np.unique(counts[kept])]


def _around_corners(sides: _Sides) -> list[np.ndarray]:
    """Group the sides around each corner in order, by their number, (n, count) each."""
    following = sides.twins[sides.before]
    _, first = np.unique(sides.corners, return_index=True)
    counts = np.bincount(sides.corners)[sides.corners[first]]
    found = []
    for count in np.unique(counts):
        ring = [first[counts == count]]
        while len(ring) < count:
            ring.append(following[ring[-1]])
        found.append(np.stack(ring, axis=1))
    return found


def _listed(rows: np.ndarray) -> np.ndarray:
    """Convert faces with equally many corners (n, count) to VTK form."""
    return np.column_stack([np.full(len(rows), rows.shape[1]), rows]).ravel()
