"""Order of elimination of blocks that touch, and the dense fronts (supernodes) of the LU factors of their matrix.

The matrix has an n_dof × n_dof part wherever two free blocks touch. Its pattern is symmetric and stays, so that the
order (minimum degree), the fill and where each part of it goes are found once for all factorisations (multifrontal and
supernodal methods: Davis, Rajamanickam and Sid-Lakhdar, Acta Numer. 25, 2016, 383). Blocks that are eliminated one
after the other and leave the same others behind make a front: a dense square of their own, a strip below it and one
beside it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

DISSECTED = 2000  # blocks from which on they are ordered by nested dissection: a quarter to a half less work
UNDIVIDED = 12  # blocks of a part that is not divided any more
# Blocks of a front that may be joined to the one it goes into, and the share of zeros that this may bring.
JOINED = ((4, 0.5), (12, 0.15), (1_000_000_000, 0.05))


class Runs(NamedTuple):
    """Rows of fronts that belong to one other front, the one in whose square these blocks are, run by run."""

    first: np.ndarray  # first run of each front, (n_fronts + 1,)
    into: np.ndarray  # the front that a run goes into, (n_runs,)
    ends: np.ndarray  # its first row among those of its front, and the one after its last, (n_runs, 2)
    place_start: np.ndarray  # where its places begin, (n_runs + 1,)
    places: np.ndarray  # of the rows from its first one on, among blocks and rows of the front it goes into


class Fronts(NamedTuple):
    """Fronts in the order of elimination; blocks are numbered in that order, but in `order`."""

    order: np.ndarray  # free block that is eliminated as first, second ..., (n_blocks,)
    first: np.ndarray  # first block of each front, (n_fronts + 1,)
    row_start: np.ndarray  # where its rows begin, (n_fronts + 1,)
    row: np.ndarray  # blocks that a front leaves behind, ascending
    start: np.ndarray  # where its numbers begin: square, strip below (transposed), strip beside, (n_fronts + 1,)
    runs: Runs
    n_dof: int

    @property
    def widest(self) -> int:
        """Degrees of freedom that a front leaves behind at most."""
        return int(np.diff(self.row_start).max(initial=0)) * self.n_dof


@dataclass
class _Front:
    """Dense front during elimination; sorted by its last block."""

    blocks: list[int]
    rows: np.ndarray  # blocks left behind
    zeros: float = 0.0  # numbers that are kept and always nothing
    before: list[int] = field(default_factory=list)  # fronts that go into it


def fronts_of(pairs: np.ndarray, n_blocks: int, n_dof: int, places: np.ndarray | None = None) -> Fronts:
    """Build the fronts of free blocks that touch in pairs, (n_pairs, 2) numbers of free blocks, each pair once.

    places: of the blocks, for the order of many, (n_blocks, d).
    """
    many = places is not None and n_blocks >= DISSECTED
    order = _dissected(pairs, np.asarray(places)) if many else _minimum_degree(pairs, n_blocks)
    place = np.empty(n_blocks, np.int64)
    place[order] = np.arange(n_blocks)
    edges = np.sort(place[pairs], axis=1)
    edges = edges[np.lexsort((edges[:, 1], edges[:, 0]))]
    splits = np.searchsorted(edges[:, 0], np.arange(n_blocks + 1))
    fronts = _in_order(_joined([edges[a:b, 1] for a, b in zip(splits, splits[1:], strict=False)]))
    last = np.concatenate([np.zeros(0, np.int64), *(front.blocks for front in fronts)])
    place[last] = np.arange(n_blocks)
    first = np.concatenate([[0], np.cumsum([len(front.blocks) for front in fronts])]).astype(np.int64)
    rows = [np.sort(place[front.rows]) for front in fronts]
    row_start = np.concatenate([[0], np.cumsum([len(left) for left in rows])]).astype(np.int64)
    own, left = np.diff(first) * n_dof, np.diff(row_start) * n_dof
    start = np.concatenate([[0], np.cumsum(own * (own + 2 * left))]).astype(np.int64)
    row = np.concatenate([np.zeros(0, np.int64), *rows])
    return Fronts(order[last], first, row_start, row, start, _runs(first, rows), n_dof)


def _minimum_degree(pairs: np.ndarray, n_blocks: int) -> np.ndarray:
    """Order the blocks by minimum degree, which brings little fill."""
    from scipy.sparse import csc_matrix

    from dem_cli.core.limit.sparse_factors import factors_of

    own, (first, second) = np.arange(n_blocks), pairs.T
    where = np.concatenate([own, first, second]), np.concatenate([own, second, first])
    most = float(np.bincount(pairs.ravel(), minlength=n_blocks).max(initial=0)) + 1.0
    values = np.concatenate([np.full(n_blocks, most), np.full(2 * len(pairs), -1.0)])
    matrix = csc_matrix((values, where), shape=(n_blocks, n_blocks))
    return np.argsort(factors_of(matrix, "MMD_AT_PLUS_A", 0.0).perm_c)


def _dissected(pairs: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Order the blocks by nested dissection: halves by place, behind both the blocks of one that touch the other."""
    n_blocks = len(places)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], np.arange(n_blocks + 1))
    half, order, waiting = np.zeros(n_blocks, np.int64), [], [np.arange(n_blocks)]
    while waiting:
        part = waiting.pop()
        if len(part) <= UNDIVIDED:
            order.append(part)
            continue
        sides, between = _cut(part, places[part], both[:, 1], first, half)
        waiting += sides
        order.append(between)
    return np.concatenate(order)[::-1]  # the last separator first


def _cut(
    part: np.ndarray, places: np.ndarray, touching: np.ndarray, first: np.ndarray, half: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Separate a part into two sides by the fewest blocks, cut across its longest or next direction.

    touching, first: blocks that touch each block; half: room, zeros.
    """
    counts = first[part + 1] - first[part]
    owner = np.repeat(np.arange(len(part)), counts)
    others = touching[np.arange(counts.sum()) + np.repeat(first[part] - np.cumsum(counts) + counts, counts)]
    best: np.ndarray | None = None
    for along in np.argsort(-np.ptp(places, axis=0), kind="stable")[:2]:
        rank = np.argsort(np.argsort(places[:, along], kind="stable"), kind="stable")
        own = 1 + (2 * rank >= len(part))
        half[part] = own
        across = half[others] == 3 - own[owner]
        for side in (1, 2):
            found = np.where(np.bincount(owner, across & (own[owner] == side), len(part)) > 0, 0, own)
            if best is None or (found == 0).sum() < (best == 0).sum():
                best = found
    half[part] = 0
    assert best is not None
    return [part[best == 1], part[best == 2]], part[best == 0]


def _joined(later: list[np.ndarray]) -> dict[int, _Front]:
    """Fronts by their last block; later: for each block those that touch it and are eliminated later."""
    fronts: dict[int, _Front] = {}
    waiting: list[list[int]] = [[] for _ in later]  # fronts whose next block this is
    for block, touching in enumerate(later):
        rows = np.unique(np.concatenate([touching, *(fronts[before].rows for before in waiting[block])]))
        front = _Front([block], rows[rows > block])
        for before in sorted(waiting[block], key=lambda one: len(fronts[one].rows), reverse=True):
            _join(front, fronts, before)
        fronts[block] = front
        if len(front.rows):
            waiting[front.rows[0]].append(block)
    return fronts


def _join(front: _Front, fronts: dict[int, _Front], before: int) -> None:
    """Takes a front that goes into this one into it, if that brings few zeros."""
    other, left = fronts[before], len(front.rows)
    count = len(front.blocks) + len(other.blocks)
    zeros = 2.0 * len(other.blocks) * (len(front.blocks) + left - len(other.rows)) + front.zeros + other.zeros
    if any(count <= most and zeros <= share * count * (count + 2.0 * left) for most, share in JOINED):
        front.blocks, front.zeros = other.blocks + front.blocks, zeros
        front.before += fronts.pop(before).before
    else:
        front.before.append(before)


def _in_order(fronts: dict[int, _Front]) -> list[_Front]:
    """Sort fronts so that each comes after those that go into it, near to them."""
    found: list[_Front] = []
    waiting = [(block, False) for block, front in reversed(fronts.items()) if not len(front.rows)]
    while waiting:
        block, ready = waiting.pop()
        if ready:
            found.append(fronts[block])
            continue
        waiting.append((block, True))
        waiting += [(before, False) for before in reversed(fronts[block].before)]
    return found


def _runs(first: np.ndarray, rows: list[np.ndarray]) -> Runs:
    """Find the runs of rows that each front passes to later fronts."""
    owner = np.repeat(np.arange(len(rows)), np.diff(first))
    runs, into, ends, places = [0], [], [], [np.zeros(0, np.int64)]
    for left in rows:
        owners = owner[left]
        starts = np.flatnonzero(np.diff(owners, prepend=-1))
        for begin, end in zip(starts, np.append(starts, len(left))[1:], strict=True):
            target, tail = owners[begin], left[begin:]
            own = first[target + 1] - first[target]
            inside = np.arange(len(tail)) < end - begin
            places.append(np.where(inside, tail - first[target], own + np.searchsorted(rows[target], tail)))
            into.append(target)
            ends.append((begin, end))
        runs.append(len(into))
    sizes = np.concatenate([[0], np.cumsum([len(part) for part in places[1:]])])
    return Runs(
        np.array(runs, np.int64), np.array(into, np.int64), np.array(ends, np.int64).reshape(-1, 2),
        sizes.astype(np.int64), np.concatenate(places),
    )  # fmt: skip


def parts_of(fronts: Fronts, pairs: np.ndarray) -> np.ndarray:
    """Find the places of matrix parts in the fronts: first number, steps to the next row and to the next column,
    (n_pairs, 3). Parts of fixed blocks (negative numbers) have −1.

    pairs: numbers of free blocks, row and column of the part, (n_pairs, 2); blocks touch or are the same.
    """
    found = np.full((len(pairs), 3), -1, np.int64)
    used = (pairs >= 0).all(axis=1)
    n, n_dof = len(fronts.order), fronts.n_dof
    place = np.empty(n, np.int64)
    place[fronts.order] = np.arange(n)
    row, column = place[pairs[used]].T
    front = np.searchsorted(fronts.first, np.minimum(row, column), side="right") - 1
    begin, end = fronts.first[front], fronts.first[front + 1]
    own = (end - begin) * n_dof
    left = (fronts.row_start[front + 1] - fronts.row_start[front]) * n_dof
    keys = np.repeat(np.arange(len(fronts.first) - 1), np.diff(fronts.row_start)) * n + fronts.row
    behind = (np.searchsorted(keys, front * n + np.maximum(row, column)) - fronts.row_start[front]) * n_dof
    below, beside = fronts.start[front] + own * own, fronts.start[front] + own * (own + left)
    inner_row, inner_column, one = (row - begin) * n_dof, (column - begin) * n_dof, np.ones_like(row)
    in_square = np.stack([fronts.start[front] + inner_row * own + inner_column, own, one], axis=1)
    in_beside = np.stack([beside + inner_row * left + behind, left, one], axis=1)
    in_below = np.stack([below + inner_column * left + behind, one, left], axis=1)
    square = (row < end) & (column < end)
    found[used] = np.where(square[:, None], in_square, np.where((row < column)[:, None], in_beside, in_below))
    return found
