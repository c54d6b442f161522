"""Compounds of convex polygons: edges that other parts of the same block cover, so that nothing else can touch them."""

from __future__ import annotations

import numpy as np

from dem_cli.geometry.topology import Topology

INNER = 1e-3  # of a part: edges of one block that face each other closer than that lie inside it


def inner_edges(vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Edges inside a block of several parts, (n_faces,) bool; sizes: of the parts [m], (n_parts,)."""
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
