"""Detection: which faces of which blocks touch or may soon touch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.kernels.neighbours import find_pairs, place_corners
from dem_cli.kernels.records import BlockShapes
from dem_cli.model.model import Model

INNER = 1e-3  # of a piece: edges of one block that face each other closer than that lie inside it


class Faces(NamedTuple):
    """Pairs of faces of convex parts, ordered by parts."""

    parts: np.ndarray  # the two parts a < b, (n, 2) int64
    edges: np.ndarray  # 2D: corners (a0, a1, b0, b1) of the two edges, (n, 4) int64
    separation: np.ndarray  # distance along the best separating axis [m], negative: overlap, (n,)


def block_shape(model: Model) -> BlockShapes:
    """The constant geometry that the kernels read."""
    return BlockShapes(model.vertex_blocks, np.ascontiguousarray(model.vertices), model.shapes.radii)


def world_corners(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Corners of all parts in place [m], (n_vertices, d)."""
    corners = np.empty_like(shape.corner_arms)
    place_corners(positions, orientations, shape.corner_blocks, shape.corner_arms, corners)
    return corners


def inner_edges(model: Model) -> np.ndarray:
    """Edges that other pieces of the same block cover, so that nothing else can touch them, (n_vertices,) bool; 2D."""
    inner = np.zeros(len(model.vertices), bool)
    if model.n_parts == model.n_blocks:
        return inner
    after, part = model.topology.ends[:, 1], model.topology.face_parts
    block = model.part_blocks[part]
    for i in np.flatnonzero(np.bincount(model.part_blocks)[block] > 1):
        others = np.flatnonzero((block == block[i]) & (part != part[i]))
        inner[i] = _covered(model.vertices[[i, after[i]]], model.vertices[np.stack([others, after[others]])],
                            INNER * model.parts.sizes[part[i]])  # fmt: skip
    return inner


def _covered(edge: np.ndarray, others: np.ndarray, reach: float) -> bool:
    """Whether other edges (2 ends, n, 2) that run the other way within `reach` [m] cover an edge (2 ends, 2)."""
    along = edge[1] - edge[0]
    length = float(np.hypot(*along))
    along = along / length
    arms = others - edge[0]
    places, heights = arms @ along, arms @ np.array([along[1], -along[0]])
    near = (np.abs(heights) <= reach).all(axis=0) & (places[1] < places[0])
    end = 1e-6 * length
    for k in np.argsort(places[1]):
        if near[k] and places[1, k] <= end:
            end = max(end, places[0, k] + 1e-6 * length)
    return end >= length


def find_joints(model: Model, corners: np.ndarray, reach: float, inner: np.ndarray | None = None) -> Faces:
    """All pairs of faces of different blocks that are closer than `reach` [m].

    corners: world coordinates of all corners [m], (n_vertices, d), see `world_corners`; inner: `inner_edges`,
    where they are known already. Two fixed blocks have no joint. Two convex parts have one, and more where they
    meet corner to corner: those that may come to touch next.
    """
    inner = inner_edges(model) if inner is None else inner
    starts = model.part_starts
    low = np.minimum.reduceat(corners, starts[:-1], axis=0)
    high = np.maximum.reduceat(corners, starts[:-1], axis=0)
    boxes = np.ascontiguousarray(np.column_stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]]))
    order = np.argsort(boxes[:, 0], kind="stable")
    capacity = 8 * model.n_parts + 16
    while True:
        parts = np.empty((capacity, 2), np.int64)
        edges = np.empty((capacity, 2), np.int64)
        separation = np.empty(capacity)
        n = find_pairs(order, boxes, corners, starts, model.part_blocks, model.fixed, reach, parts, edges, separation)
        if n <= capacity:
            break
        capacity = n
    # Where a piece touches another block with an inner edge only, it is at a corner that another piece has too.
    by_part = np.lexsort((edges[:n, 1], edges[:n, 0], parts[:n, 1], parts[:n, 0]))
    by_part = by_part[~inner[edges[by_part]].any(axis=1)]
    parts, edges = parts[by_part], edges[by_part]
    ends = model.topology.ends
    four = np.column_stack([ends[edges[:, 0]], ends[edges[:, 1]]])
    return Faces(parts, four, separation[by_part])
