"""Compounds of convex parts: edges and faces that other parts of a block cover, so that nothing else can touch them."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.rotation import beside, cross
from dem_cli.core.geometry.solids import unit_vectors
from dem_cli.core.geometry.topology import Topology

INNER = 1e-3  # of a part: edges of one block that face each other closer than that lie inside it


def inner_edges(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Find the edges inside a block of several parts, (n_faces,) bool; sizes: of the parts [m], (n_parts,)."""
    inner = np.zeros(topology.n_faces, bool)
    parts_of_block = np.bincount(part_blocks)
    if not (parts_of_block > 1).any():
        return inner
    after, part = topology.ends[:, 1], topology.face_parts
    block = part_blocks[part]
    for i in np.flatnonzero(parts_of_block[block] > 1):
        others = np.flatnonzero((block == block[i]) & (part != part[i]))
        edge, theirs = vertices[[i, after[i]]], vertices[np.stack([others, after[others]])]
        inner[i] = _covered(edge, theirs, INNER * sizes[part[i]])
    return inner


def _covered(edge: np.ndarray, others: np.ndarray, reach: float) -> bool:
    """Test whether opposite edges (2 ends, n, 2) within `reach` [m] cover an edge (2 ends, 2) completely."""
    along = edge[1] - edge[0]
    length = float(np.hypot(*along))
    along = along / length
    arms = others - edge[0]
    places, heights = product(arms, along), product(arms, np.array([along[1], -along[0]]))
    near = (np.abs(heights) <= reach).all(axis=0) & (places[1] < places[0])
    end = 1e-6 * length
    for k in np.argsort(places[1]):
        if near[k] and places[1, k] <= end:
            end = max(end, places[0, k] + 1e-6 * length)
    return end >= length


def covered_faces(
    vertices: np.ndarray, topology: Topology, areas: np.ndarray, part_blocks: np.ndarray, sizes: np.ndarray
) -> np.ndarray:
    """Find the faces in space inside a block of several parts, (n_faces,) bool: other parts lie against all of their
    area.

    areas: of the faces times their outward normals [m²], (n_faces, 3); sizes: of the parts [m], (n_parts,).
    """
    inner = np.zeros(topology.n_faces, bool)
    parts_of_block = np.bincount(part_blocks)
    part = topology.face_parts
    block = part_blocks[part]
    corner = vertices[topology.face_corners[topology.face_starts[:-1]]]
    size = np.linalg.norm(areas, axis=1)
    normals = unit_vectors(areas, size)
    for i in np.flatnonzero(parts_of_block[block] > 1):
        others = np.flatnonzero((block == block[i]) & (part != part[i]))
        reach = INNER * sizes[part[i]]
        against = (product(normals[others], normals[i]) < -1.0 + INNER) & (
            np.abs(product(corner[others] - corner[i], normals[i])) <= reach
        )
        flat = _face(vertices, topology, i)
        axes = np.column_stack([(first := beside(normals[[i]])[0]), np.cross(normals[i], first)])
        shared = [
            clipped(product(flat, axes), product(_face(vertices, topology, j), axes)[::-1]) for j in others[against]
        ]
        inner[i] = sum(map(_area, shared)) >= (1.0 - INNER) * size[i]
    return inner


def clipped(polygon: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Intersect two convex polygons (n, 2), both counter-clockwise, (m, 2); Sutherland and Hodgman 1974."""
    for start, end in zip(by, np.roll(by, -1, axis=0), strict=True):
        if not len(polygon):
            break
        left = cross(end - start, polygon - start)
        after, left_after = np.roll(polygon, -1, axis=0), np.roll(left, -1)
        kept = []
        for k in range(len(polygon)):
            if left[k] >= 0.0:
                kept.append(polygon[k])
            if (left[k] < 0.0) != (left_after[k] < 0.0):
                kept.append(polygon[k] + left[k] / (left[k] - left_after[k]) * (after[k] - polygon[k]))
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def _face(vertices: np.ndarray, topology: Topology, face: np.integer) -> np.ndarray:
    return vertices[topology.face_corners[topology.face_starts[face] : topology.face_starts[face + 1]]]


def _area(polygon: np.ndarray) -> float:
    arms = polygon - polygon[:1]
    return 0.5 * float(cross(arms, np.roll(arms, -1, axis=0)).sum())
