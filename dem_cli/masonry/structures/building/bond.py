"""Place the head joints of a course: clear of those below, as the bond has them, without short blocks.

Of all ways to lay a run in blocks between a quarter and the whole of the given length, the one of least cost: blocks
are as long as the bond has them there, heads lie where it has them, and away from what is fixed above and below: faces
of walls that pass, jambs, heads that were moved. A shortest path over a few hundred places.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dem_cli.masonry.structures.courses import LEAST_PIECE, Pattern

SHORTEST = LEAST_PIECE  # of the length of a block: no head is nearer to a joint above or below it
SAME = 1e-6  # of the length of a block: the same place
CUT, OFF, OVER = 1.0, 2.0, 40.0  # cost of cut blocks, of heads off their place, of heads near joints above and below
CLOSER = 0.6  # cost of a quarter at the very end of a bond with headers: it lies behind the first one


class RunEnds(NamedTuple):
    """Ends of a run of masonry [m]: the middle of each, and half of its skew."""

    start: float
    stop: float
    start_askew: float = 0.0
    stop_askew: float = 0.0

    @property
    def length(self) -> float:
        """Length of the run from middle to middle [m]."""
        return self.stop - self.start


class Laid(NamedTuple):
    """Run of a course divided into blocks."""

    heads: np.ndarray  # head joints between its ends [m], (n,)
    cost: float


class CourseBond(NamedTuple):
    """Periodic bond of a course: units and head joints."""

    pattern: Pattern
    length: float  # of a full block [m]
    first: float  # where the first unit of the pattern begins [m]

    @property
    def shares(self) -> np.ndarray:
        """Lengths of the units of the bond, in full blocks, (n,)."""
        return np.array([unit.length for unit in self.pattern.units])

    @property
    def period(self) -> float:
        """Period of the bond [m]."""
        return float(self.shares.sum()) * self.length

    @property
    def steps(self) -> np.ndarray:
        """Starts of the units within a period [m], (n,)."""
        return np.concatenate([[0.0], np.cumsum(self.shares)[:-1]]) * self.length

    @property
    def has_headers(self) -> bool:
        """Tell whether some units are headers."""
        return any(unit.header for unit in self.pattern.units)

    def units_at(self, places: np.ndarray) -> np.ndarray:
        """Return the unit of the bond at each place [m], (n,)."""
        within = np.mod(places - self.first, self.period)
        return np.searchsorted(self.steps, within + SAME * self.length, side="right") - 1

    def off(self, places: np.ndarray) -> np.ndarray:
        """Return the distance of places from the nearest head joint of the bond, in full blocks, (n,)."""
        off = (places[:, None] - self.first - self.steps) / self.period
        share: np.ndarray = np.abs(off - np.rint(off)).min(axis=1) * (self.period / self.length)
        return share


def clearance(one: Pattern, other: Pattern) -> float:
    """Return the least overlap of moved head joints with those below, in full blocks: as the bond has it, up to a
    quarter.

    Nothing where the bond has them half a block apart: then blocks and jambs that are fixed leave them enough.
    """
    span = 3.0  # every bond repeats itself after that
    heads = []
    for pattern in (one, other):
        shares = np.array([unit.length for unit in pattern.units])
        repeated = np.tile(shares, round(span / shares.sum()))
        heads.append(pattern.start + np.concatenate([[0.0], np.cumsum(repeated)[:-1]]))
    away = np.abs(heads[0][:, None] - heads[1][None, :]) % span
    least = float(np.minimum(away, span - away).min())
    return 0.0 if least > 0.5 - SAME else min(least, SHORTEST)


def laid(
    ends: RunEnds, bond: CourseBond, fixed: Iterable[float], heads: Iterable[float] = (), apart: float = 0.0
) -> Laid:
    """Divide a run into blocks with head joints away from `fixed` joints above and below, and from `heads` below [m].

    apart: how far heads of both courses are from each other, in full blocks.
    """
    length = bond.length
    near, below = (
        tuple(sorted({x for x in given if ends.start - length < x < ends.stop + length})) for given in (fixed, heads)
    )
    return _laid(ends, bond._replace(first=bond.first % bond.period), near, below if apart > SAME else (), apart)


@lru_cache(maxsize=4096)
def _laid(ends: RunEnds, bond: CourseBond, near: tuple[float, ...], below: tuple[float, ...], apart: float) -> Laid:
    """Divide a run into blocks, cached for courses that repeat each other."""
    fixed, heads, length = np.array(near), np.array(below), bond.length
    if ends.length <= length * (1.0 + SAME):
        return Laid(np.zeros(0), CUT * (1.0 - ends.length / length) ** 2)
    low = ends.start + ends.start_askew + SHORTEST * length
    high = ends.stop - ends.stop_askew - SHORTEST * length
    places = _places(ends, bond, fixed)
    places = places[(places >= low - SAME * length) & (places <= high + SAME * length)]
    costs = OFF * bond.off(places)
    for others, reach in ((fixed, SHORTEST), (heads, apart)):
        if len(others):
            away = np.abs(places[:, None] - others[None, :]).min(axis=1) / length
            costs += OVER * np.maximum(reach - away, 0.0) ** 2
    found = _shortest(ends, bond, places, costs)
    if found is None:
        count = math.ceil(ends.length / length - SAME)
        return Laid(ends.start + ends.length * np.arange(1, count) / count, OVER)
    return found


def _places(ends: RunEnds, bond: CourseBond, avoid: np.ndarray) -> np.ndarray:
    """Return the possible places of head joints [m], in order, each once."""
    length, first, period = bond.length, bond.first, bond.period
    count = math.ceil(ends.length / length) + 1
    steps = np.arange(-1, math.ceil(ends.length / period) + 2) * period
    begun = first + math.floor((ends.start - first) / period) * period + steps
    begun = (begun[:, None] + bond.steps).ravel()
    quarters = np.array([SHORTEST, 0.5, 0.75, 1.0]) * length
    shifts = np.concatenate([-quarters, quarters])
    near = [ends.start + ends.start_askew + quarters, ends.stop - ends.stop_askew - quarters]
    equal = [ends.start + ends.length * np.arange(1, n) / n for n in (count - 1, count)]
    beside = (avoid[:, None] + shifts[[0, 1, 4, 5]]).ravel()
    every = np.unique(np.concatenate([begun, *near, *equal, beside]))
    every = every[(every > ends.start) & (every < ends.stop)]
    return every[np.concatenate([[True], np.diff(every) > SAME * length])] if len(every) else every


def _shortest(ends: RunEnds, bond: CourseBond, places: np.ndarray, costs: np.ndarray) -> Laid | None:
    """Find the cheapest sequence of head joints with pieces between SHORTEST and a whole block; None: there is none."""
    length, shares, headers = bond.length, bond.shares, bond.has_headers
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
        wanted = shares[bond.units_at(nodes[k] - 0.5 * pieces)] if len(shares) > 1 else shares[0]
        through = np.where(allowed, total[begin:k] + CUT * (wanted - pieces / length) ** 2, np.inf)
        if headers:
            outer = (np.arange(begin, k) == 0) | (k == len(nodes) - 1)
            through += np.where(outer & (pieces - extra < 2.0 * least), CLOSER, 0.0)
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
