"""Scales of a structure for tolerances and "auto" joints: lengths, weights and depth."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.model.model import Model

REMOTE_BLOCKS = 1e3  # times the extent of the blocks that can move: from there on coordinates count from among them
DOUBTFUL_CLOSURE = 0.01  # energy error over the largest energy above which a run is to be doubted
DOUBTFUL_OVERLAP = 0.01  # the same, of the largest overlap in smallest edges
DOUBTFUL_REWEIGHTING = 0.01  # the same, of energy that changed with the areas of contact points
WEIGHTLESS = 1e-9  # of the mean weight: forces of blocks that are lighter are lost in round-off


def origin_of(model: Model) -> np.ndarray:
    """Choose the origin of coordinates [m], (d,): [0, 0], but for a structure far from there among its blocks.

    A coordinate has 16 digits; of a block that is 1e5 times its size away, too few are left to see joints close.
    """
    free = model.centroids[~model.fixed]
    middle = free.mean(axis=0) if len(free) else np.zeros(model.dimension)
    low, high = (limit(free, axis=0) if len(free) else middle for limit in (np.min, np.max))
    size = float((high - low).max()) + smallest_edge(model)
    return middle if np.abs(middle).max() > REMOTE_BLOCKS * size else np.zeros(model.dimension)


def smallest_edge(model: Model) -> float:
    """Shortest edge of a block that can move [m]; of any block where none can."""
    edges, free = model.shapes.edges, ~model.fixed
    return float((edges[free] if free.any() else edges).min())


def own_weights(dead: np.ndarray, live: np.ndarray, dimension: int) -> np.ndarray:
    """Dead force on each block [N]; where there is next to none, WEIGHTLESS of the mean, (n_blocks,)."""
    weights = np.sqrt((dead[:, :dimension] ** 2).sum(axis=1))
    return np.maximum(weights, WEIGHTLESS * mean_weight(dead[weights > 0.0], live, dimension))


def mean_weight(dead: np.ndarray, live: np.ndarray, dimension: int) -> float:
    """Mean dead force on a free block [N]; the mean live one where there is no dead load."""
    for loads in (dead, live):
        mean = float(np.sqrt((loads[:, :dimension] ** 2).sum(axis=1)).mean()) if len(loads) else 0.0
        if mean > 0.0:
            return mean
    return 1.0


def stiffness_scale(model: Model) -> float:
    """kn [Pa/m] at which a mean block, resting on a joint of its own size, sinks by the smallest edge."""
    free = ~model.fixed
    if not free.any():
        return 1.0
    weight = mean_weight(model.dead_loads[free], model.live_loads[free], model.dimension)
    sides = functions.power(
        model.shapes.volumes[free], (model.dimension - 1.0) / model.dimension
    )  # in space already the area
    joint = float(sides.mean() * model.thickness[free].mean())
    return weight / (joint * smallest_edge(model))


def levels(joints: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Count the joints between each block and the supports; −1: not connected. joints: (n, 2) blocks; (n_blocks,)
    int64."""
    level, at = np.where(fixed, 0, -1), 0
    while True:
        a, b = level[joints].T
        new = np.concatenate([joints[(a == at) & (b < 0), 1], joints[(b == at) & (a < 0), 0]])
        if not len(new):
            return level
        at += 1
        level[new] = at


def depth(joints: np.ndarray, fixed: np.ndarray) -> int:
    """Count the joints between the supports and the block furthest from them; joints: (n, 2) blocks."""
    return int(levels(joints, fixed).max(initial=0))


def structures(joints: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Label the connected structure of each block by the number of its first block; −1: a support, (n_blocks,).

    Supports connect nothing: two walls on one base are two structures.
    """
    label = np.arange(len(fixed))
    inner = joints[~fixed[joints].any(axis=1)]
    while True:
        lowest = label[inner].min(axis=1, initial=len(fixed))
        smaller = label.copy()
        np.minimum.at(smaller, inner.ravel(), np.repeat(lowest, 2))
        smaller = smaller[smaller]
        if np.array_equal(smaller, label):
            return np.where(fixed, -1, label)
        label = smaller


def largest_structure(joints: np.ndarray, fixed: np.ndarray) -> int:
    """Count the free blocks of the largest structure (`structures`); joints: (n, 2) blocks."""
    return int(np.bincount(structures(joints, fixed)[~fixed]).max(initial=0))
