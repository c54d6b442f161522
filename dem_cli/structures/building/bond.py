"""Bond of a course: where its head joints are, given those that it must not continue, without short blocks.

Of all ways to lay a run in blocks between a quarter and the whole of the given length, the one of least cost: blocks
are as long as they may be, heads lie in the middle of the blocks above and below, and away from what is fixed there:
faces of walls that pass, jambs. A shortest path over a few hundred places.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

SHORTEST = 0.25  # of the length of a block: no piece is shorter, and no head nearer to a joint above or below it
SAME = 1e-6  # of the length of a block: the same place
CUT, OFF, OVER = 1.0, 2.0, 40.0  # cost of cut blocks, of heads off their place, of heads near joints above and below


class RunEnds(NamedTuple):
    """Ends of a run [m]: the middle of each, and half of what it is askew."""

    start: float
    stop: float
    start_askew: float = 0.0
    stop_askew: float = 0.0

    @property
    def length(self) -> float:
        """From middle to middle [m]."""
        return self.stop - self.start


class Laid(NamedTuple):
    """A run in blocks."""

    heads: np.ndarray  # head joints between its ends [m], (n,)
    cost: float


def laid(ends: RunEnds, length: float, first: float, avoid: Iterable[float]) -> Laid:
    """A run in blocks of a length [m]; heads belong to `first` + k `length`, away from `avoid` [m]."""
    near = {x for x in avoid if ends.start - length < x < ends.stop + length}
    return _laid(ends, length, first % length, tuple(sorted(near)))


@lru_cache(maxsize=4096)
def _laid(ends: RunEnds, length: float, first: float, near: tuple[float, ...]) -> Laid:
    """The same; courses repeat each other."""
    avoid = np.array(near)
    if ends.length <= length * (1.0 + SAME):
        return Laid(np.zeros(0), CUT * (1.0 - ends.length / length) ** 2)
    low = ends.start + ends.start_askew + SHORTEST * length
    high = ends.stop - ends.stop_askew - SHORTEST * length
    places = _places(ends, length, first, avoid)
    places = places[(places >= low - SAME * length) & (places <= high + SAME * length)]
    found = _shortest(ends, length, places, _costs(places, length, first, avoid))
    if found is None:
        count = math.ceil(ends.length / length - SAME)
        return Laid(ends.start + ends.length * np.arange(1, count) / count, OVER)
    return found


def _places(ends: RunEnds, length: float, first: float, avoid: np.ndarray) -> np.ndarray:
    """Where heads may be [m], in order, each once."""
    count = math.ceil(ends.length / length) + 1
    steps = np.arange(-1, count + 1) * length
    begun = first + math.floor((ends.start - first) / length) * length + steps
    quarters = np.array([SHORTEST, 0.5, 0.75, 1.0]) * length
    shifts = np.concatenate([-quarters, quarters])
    near = [ends.start + ends.start_askew + quarters, ends.stop - ends.stop_askew - quarters]
    equal = [ends.start + ends.length * np.arange(1, n) / n for n in (count - 1, count)]
    beside = (avoid[:, None] + shifts[[0, 1, 4, 5]]).ravel()
    every = np.unique(np.concatenate([begun, *near, *equal, beside]))
    every = every[(every > ends.start) & (every < ends.stop)]
    return every[np.concatenate([[True], np.diff(every) > SAME * length])] if len(every) else every


def _costs(places: np.ndarray, length: float, first: float, avoid: np.ndarray) -> np.ndarray:
    """Of a head at each place."""
    off = (places - first) / length
    cost = OFF * np.abs(off - np.rint(off))
    if len(avoid):
        away = np.abs(places[:, None] - avoid[None, :]).min(axis=1) / length
        cost += OVER * np.maximum(SHORTEST - away, 0.0) ** 2
    return cost


def _shortest(ends: RunEnds, length: float, places: np.ndarray, costs: np.ndarray) -> Laid | None:
    """The cheapest sequence of heads, pieces between SHORTEST and the whole of a block; None: there is none."""
    nodes = np.concatenate([[ends.start], places, [ends.stop]])
    costs = np.concatenate([[0.0], costs, [0.0]])
    least, most = SHORTEST * length * (1.0 - 2 * SAME), length * (1.0 + SAME)
    total, before = np.full(len(nodes), np.inf), np.zeros(len(nodes), np.int64)
    total[0] = 0.0
    for k in range(1, len(nodes)):
        askew = ends.start_askew + ends.stop_askew  # the first and the last block may be longer by that
        begin = np.searchsorted(nodes, nodes[k] - most - askew)
        pieces = nodes[k] - nodes[begin:k]
        extra = np.where(np.arange(begin, k) == 0, ends.start_askew, 0.0)
        extra += ends.stop_askew if k == len(nodes) - 1 else 0.0
        allowed = (pieces >= least + extra) & (pieces <= most + extra)
        through = np.where(allowed, total[begin:k] + CUT * (1.0 - pieces / length) ** 2, np.inf)
        if len(through) and np.isfinite(through.min()):
            before[k] = begin + int(through.argmin())
            total[k] = through.min() + costs[k]
    if not np.isfinite(total[-1]):
        return None
    heads, k = [], int(before[-1])
    while k:
        heads.append(nodes[k])
        k = int(before[k])
    return Laid(np.array(heads[::-1]), float(total[-1]))
