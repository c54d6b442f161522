"""Edges that face each other: their corners, lengths and overlaps; 2D."""

from __future__ import annotations

import numpy as np

from dem_cli.core.contact.joints import Faces
from dem_cli.core.geometry.rotation import cross
from dem_cli.core.model.model import Model


def edges_of(model: Model, faces: Faces) -> np.ndarray:
    """List the corners (a0, a1, b0, b1) of the two edges of each pair, (n, 4) int64."""
    return model.topology.ends[faces.faces].reshape(-1, 4)


def lengths_of(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Compute the lengths of both edges of each pair [m], (n, 2)."""
    ends = corners[edges]
    return np.sqrt(((ends[:, [1, 3]] - ends[:, [0, 2]]) ** 2).sum(axis=2))


def overlap_lengths(edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Compute the length of the overlap of two edges along the first [m], (n,); negative where they miss each other."""
    low, high = overlap_ends(edges, corners)
    return high - low


def overlap_ends(edges: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the beginning and end of the overlap of two edges, along the first edge from its start [m], (n,) each."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = a1 - a0
    length = np.sqrt((along**2).sum(axis=1))
    along /= length[:, None]
    low, high = ((b1 - a0) * along).sum(axis=1), ((b0 - a0) * along).sum(axis=1)
    return np.maximum(low, 0.0), np.minimum(high, length)


def widest_gaps(edges: np.ndarray, corners: np.ndarray, steepest: float, bare: float) -> np.ndarray:
    """Compute the largest gap of each pair of edges that face each other [m], (n,); 0 where they do not, or overlap.

    steepest: slope of one against the other; bare: share of the shorter one that they have to face each other over. A
    wedge touches at one end of the joint and is open at the other.
    """
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along, across = a1 - a0, b0 - b1
    length = np.hypot(*along.T)
    along /= length[:, None]
    start, run, rise = ((b1 - a0) * along).sum(axis=1), (across * along).sum(axis=1), cross(across, along)
    facing = (run > 0.0) & (np.abs(rise) < steepest * run)  # rise: of b's face from b1 to b0, away from a
    run = np.where(facing, run, 1.0)
    low, high = np.maximum(start, 0.0), np.minimum(start + run, length)
    first = cross(b1 - a0, along)  # to the right of a: outside, as corners go counter-clockwise
    gaps = [first + rise * (place - start) / run for place in (low, high)]
    return np.where(facing & (high - low > bare * np.minimum(run, length)), np.maximum(*gaps), 0.0).clip(0.0)
