"""Edges that face each other: their corners, their lengths, and where they overlap; 2D."""

from __future__ import annotations

import numpy as np

from dem_cli.contact.joints import Faces
from dem_cli.model.model import Model


def edges_of(model: Model, faces: Faces) -> np.ndarray:
    """Corners (a0, a1, b0, b1) of the two edges of each pair, (n, 4) int64."""
    return model.topology.ends[faces.faces].reshape(-1, 4)


def lengths_of(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Lengths of both edges of each pair [m], (n, 2)."""
    ends = corners[edges]
    return np.sqrt(((ends[:, [1, 3]] - ends[:, [0, 2]]) ** 2).sum(axis=2))


def overlap_lengths(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Length of the overlap of two edges along the first [m], (n,); negative: they miss each other."""
    low, high = overlap_ends(edges, corners)
    return high - low


def overlap_ends(edges: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the overlap of two edges begins and ends, along the first edge from its start [m], (n,) each."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = a1 - a0
    length = np.sqrt((along**2).sum(axis=1))
    along /= length[:, None]
    low, high = ((b1 - a0) * along).sum(axis=1), ((b0 - a0) * along).sum(axis=1)
    return np.maximum(low, 0.0), np.minimum(high, length)
