"""Lay blocks as a mason does: side by side from left to right, then set down from the lowest up.

Who lies on whom is read from the structure without errors; how far everybody moves is one pass through that order,
because the clearance of two blocks that only rise and sink changes by the difference of their lifts.
"""

from __future__ import annotations

from collections.abc import Sequence
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.detect import find_joints
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.clearance import clearances
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed

MIRROR = np.array([[0.0, 1.0], [1.0, 0.0]])  # x and y change places: beside becomes above


class Interlocked(ValueError):
    """Pairs of blocks that block each other's way, above and below or left and right; `blocks` are their numbers."""

    def __init__(self, blocks: Sequence[int]):
        super().__init__("blocks that hold each other")
        self.blocks = tuple(blocks)


class Order(NamedTuple):
    """Order of laying: convex parts in pairs (the later one, the earlier one), (n, 2) int64."""

    beside: np.ndarray  # the later one lies to the right
    above: np.ndarray  # the later one lies above, or may come to


def neighbours(model: Model, reach: float) -> np.ndarray:
    """Find pairs of parts of different blocks that are closer than `reach` [m], each once, (n, 2)."""
    return np.unique(find_joints(model, undeformed(model), reach).parts, axis=0)


def order_of(model: Model, corners: np.ndarray, pairs: np.ndarray) -> Order:
    """Determine the order in which neighbouring parts are laid, from `corners` without errors (n_vertices, 2) [m]."""
    starts = model.part_starts
    later, earlier = np.concatenate([pairs, pairs[:, ::-1]]).T
    small = _small(model, later, earlier)
    heights = clearances(later, earlier, corners, starts, small)
    above = np.isfinite(heights) & (heights >= -small)
    low = np.minimum.reduceat(corners[:, 1], starts[:-1])
    high = np.maximum.reduceat(corners[:, 1], starts[:-1])
    above |= np.isinf(heights) & (low[later] >= high[earlier] - small)  # blocks that touch at corners
    either = above | np.roll(above, len(pairs))
    widths = clearances(later, earlier, product(corners, MIRROR), starts, small)
    beside = ~either & np.isfinite(widths) & (widths >= -small)
    both = np.stack([later, earlier], axis=1)
    return Order(both[beside], both[above])


def lay(model: Model, corners: np.ndarray, order: Order, movable: np.ndarray) -> np.ndarray:
    """Compute how far each block of wrong size moves to the right and up when laid [m], (n_blocks, 2).

    corners   of all parts, with errors [m], (n_vertices, 2)
    movable   blocks that are laid; all others stay and are in the way, (n_blocks,) bool
    First every block is pushed to the right until no neighbour on its left is in its way; never to the left. Then it
    is lifted or lowered until it rests on the highest point of what lies below; without anything below it stays.
    Raises Interlocked.
    """
    moves = np.zeros((model.n_blocks, 2))
    moves[:, 0] = np.maximum(_moves(model, product(corners, MIRROR), order.beside, movable, 0.0), 0.0)
    pushed = corners + moves[model.vertex_blocks]
    moves[:, 1] = _moves(model, pushed, order.above, movable, -np.inf)
    return moves


def _moves(model: Model, corners: np.ndarray, pairs: np.ndarray, movable: np.ndarray, least: float) -> np.ndarray:
    """Compute the upward moves that clear every movable block of the earlier ones, at least `least` [m],
    (n_blocks,).
    """
    pairs = pairs[movable[model.part_blocks[pairs[:, 0]]]]
    small = _small(model, pairs[:, 0], pairs[:, 1])
    gaps = clearances(pairs[:, 0], pairs[:, 1], corners, model.part_starts, small)
    gaps[np.abs(gaps) <= small] = 0.0  # what is not disturbed stays exactly where it is
    near = np.isfinite(gaps)
    blocks = model.part_blocks[pairs[near]].tolist()
    below: dict[int, list[tuple[int, float]]] = {}
    for (later, earlier), gap in zip(blocks, gaps[near].tolist()):
        below.setdefault(later, []).append((earlier, gap))
    moves = [0.0] * model.n_blocks
    sorter = TopologicalSorter({later: [k for k, _ in supports] for later, supports in below.items()})
    try:
        for i in sorter.static_order():
            if i in below:
                moves[i] = max(least, *(moves[k] - gap for k, gap in below[i]))
    except CycleError as error:
        raise Interlocked(error.args[1][:-1]) from None
    return np.array(moves)


def _small(model: Model, later: np.ndarray, earlier: np.ndarray) -> np.ndarray:
    """Return the distance between two parts that counts as zero [m], (n,)."""
    sizes = model.parts.sizes
    return polygon.ROUND_OFF * np.minimum(sizes[later], sizes[earlier])
