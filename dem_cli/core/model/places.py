"""Places of blocks in the undeformed structure: corners, and search of the block that contains a point."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.model.model import Model


def undeformed(model: Model) -> np.ndarray:
    """Return all corners before anything moved [m], (n_vertices, d)."""
    return model.vertices + model.centroids[model.vertex_blocks]


def block_at(model: Model, point: np.ndarray) -> int | None:
    """Number of the block that contains a point of the undeformed structure (edges count), or None."""
    found = blocks_at(model, point)
    return int(found[0]) if len(found) else None


def blocks_at(model: Model, point: np.ndarray) -> np.ndarray:
    """Numbers of all blocks that contain a point of the undeformed structure (edges count), each once, ascending."""
    return blocks_at_all(model, np.array([point]))[0]


def blocks_at_all(model: Model, points: np.ndarray) -> list[np.ndarray]:
    """Find all blocks that contain each of many points (n, d), one array of block numbers per point."""
    inside: list[list[int]] = [[] for _ in points]
    for part, found in _points_in_parts(model, points):
        for point in found.tolist():
            inside[point].append(part)
    return [np.unique(model.part_blocks[np.array(parts, np.int64)]) for parts in inside]


def inside_blocks(model: Model, points: np.ndarray) -> np.ndarray:
    """Test whether points (n, d) lie in a block of the undeformed structure, as `block_at` has it, (n,) bool."""
    found = np.zeros(len(points), bool)
    for _, inside in _points_in_parts(model, points):
        found[inside] = True
    return found


def _points_in_parts(model: Model, points: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Find parts with points inside, and which of many (n, d) these are; compared are those within their width
    alone."""
    vertices, first_faces = undeformed(model), model.topology.part_faces
    normals, on_faces = _normals(model, vertices), vertices[_on_faces(model)]
    slack, order = _slack(model), np.argsort(points[:, 0], kind="stable")
    sorted_points, room = points[order], 1e3 * slack  # room: a sharp corner reaches further than its faces
    low = np.minimum.reduceat(vertices, model.part_starts[:-1], axis=0) - room
    high = np.maximum.reduceat(vertices, model.part_starts[:-1], axis=0) + room
    begins = np.searchsorted(sorted_points[:, 0], low[:, 0], "left")
    ends = np.searchsorted(sorted_points[:, 0], high[:, 0], "right")
    for part in np.flatnonzero(ends > begins):
        near = sorted_points[begins[part] : ends[part]]
        in_box = np.flatnonzero(((low[part] <= near) & (near <= high[part])).all(axis=1))
        own = slice(first_faces[part], first_faces[part + 1])
        depths = ((on_faces[own] - near[in_box, None]) * normals[own]).sum(axis=2)
        yield int(part), order[begins[part] + in_box[depths.min(axis=1) >= -slack]]


def _on_faces(model: Model) -> np.ndarray:
    """Return a corner of each face, (n_faces,)."""
    return model.topology.face_corners[model.topology.face_starts[:-1]]


def _normals(model: Model, vertices: np.ndarray) -> np.ndarray:
    """Outward unit normals of all faces, (n_faces, d)."""
    return shapes_of(vertices).normals(vertices, model.topology)


def _slack(model: Model) -> float:
    """Return the distance outside of a block at which a point still counts as on its edge [m]."""
    return 1e-9 * float(model.parts.sizes.max())
