"""Tiles of joints in fixed geometry: which joint is in which lane, and work space of a step.

LANES joints make a tile, those with equally many points together; a joint with fewer points than its tile has slots
holds points there that never touch. Room holds nothing from one compiled call to the next.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.kernels.tiles.lanes import LANES
from dem_cli.core.kernels.tiles.team import new_team

TILES_AHEAD = 8  # whose motion is collected before their forces are: what was just written number by number cannot be
# read as a row for some time
BLOCKS_OF_CHUNK = 512  # that are worked on together, while they are in the cache; their sums are by themselves
N_SUMS = 16  # the ledger and some more; the control vector
N_TORSION = 3  # rows of `numbers` of a tile in space: torsion, centre of pressure
TILES_OF_CHUNK = 256  # whose friction work is summed by itself, whoever works on them


class JointTiles(NamedTuple):
    """Layout and work space of the tiles; none where the law has no form for lanes (laws/law.py)."""

    joints: np.ndarray  # of each lane, −1: none, (n_tiles·LANES,)
    slots: np.ndarray  # a tile has the slots slots[t]:slots[t + 1], each a point of every lane, (n_tiles + 1,)
    # Where the pushes on each block stand in `pushes`, in the order of the joints: of block i where it is block b of
    # its joint sides[side_starts[2 i]:side_starts[2 i + 1]], then where it is block a.
    side_starts: np.ndarray  # (2 n_blocks + 1,)
    sides: np.ndarray  # (2 n_joints,) uint32
    # Chunk c, of BLOCKS_OF_CHUNK blocks, has joints in tiles from begins[c] on and none any more from ready[c] on;
    # waves are the chunks in the order in which they are ready.
    begins: np.ndarray  # (n_chunks,)
    ready: np.ndarray  # (n_chunks,)
    waves: np.ndarray  # (n_chunks,)
    ring: np.ndarray  # one thread, in waves, needs the pushes of so many tiles: a power of two, less one, (1,)
    ends: np.ndarray  # room, two rows a tile: blocks a and b, int32
    # Before each loop the compiler has to ask of any two arrays whether they overlap: few, then, and in none of them
    # something whose distance from the rest depends on the slot.
    numbers: np.ndarray  # room, rows of a tile: axes, both arms, in space torsion and centre of pressure, those of the
    # law; then of each slot: place, kn, ks
    state: np.ndarray  # room, rows of a slot: gap, shear, slip path
    pushes: np.ndarray  # room, 4 rows of a tile, 16 in space: force on b (against a), moments of it about a and about b
    moves: np.ndarray  # room of each thread, rows of TILES_AHEAD tiles: motion of b against a, spins of a and of b
    work: np.ndarray  # room of each thread, rows of one tile: opening, slide, spin of joints; push, rub, twist; law
    marks: np.ndarray  # room of each thread, rows of one tile: of each slot shear before and normal force where work is
    # lost; slide and spin of joints with two points
    lost: np.ndarray  # friction work of each TILES_OF_CHUNK tiles in a step, at least one [J]
    lost_before: np.ndarray  # and in the steps before it
    books: np.ndarray  # sums of each BLOCKS_OF_CHUNK blocks (tiled_steps.py), (n_chunks, N_SUMS)
    controls: np.ndarray  # `control` of each thread, (n_threads, N_SUMS)
    team: np.ndarray  # of threads (team.py)


def rows_of(d: int, n_numbers: int) -> tuple[int, int, int]:
    """Count rows of `numbers` of a tile without its slots, of a slot there and in `state`, and of the motion of a
    tile.
    """
    r = d * (d - 1) // 2
    return (2 if d == 2 else 9 + N_TORSION) + 2 * d + n_numbers, d + 1, d + 2 * r


NO_TILES = JointTiles(
    *(np.zeros(0, np.int64),) * 3, np.zeros(0, np.uint32), *(np.zeros(0, np.int64),) * 3, np.zeros(1, np.uint64),
    np.zeros(0, np.int32), *(np.zeros(0),) * 6, np.zeros(1), np.zeros(1), np.zeros((1, 0)), np.zeros((1, 0)),
    new_team(),
)  # fmt: skip


def tiled(
    blocks: np.ndarray, starts: np.ndarray, n_blocks: int, d: int, n_numbers: int, threads: int = 1
) -> JointTiles:
    """Arrange joints with these blocks, (n_joints, 2), and points, as FixedJoints has them, in tiles.

    n_numbers: numbers of a joint that the law reads; threads: that may work on them.
    """
    n, r, counts = len(blocks), d * (d - 1) // 2, np.diff(starts)
    n_tiles = -(-n // LANES)
    n_parts = max(-(-n_tiles // TILES_OF_CHUNK), 1)
    order = np.argsort(counts, kind="stable")
    joints = np.full(n_tiles * LANES, -1)
    joints[:n] = order
    of_lanes = np.zeros(n_tiles * LANES, dtype=np.int64)
    of_lanes[:n] = counts[order]
    heights = of_lanes.reshape(n_tiles, LANES).max(axis=1, initial=0)
    slots = np.concatenate([[0], np.cumsum(heights)]).astype(np.int64)
    of_tile, of_slot, of_motion = rows_of(d, n_numbers)
    lane_of = np.empty(n, dtype=np.int64)
    lane_of[order] = np.arange(n)
    n_chunks, chunks = -(-n_blocks // BLOCKS_OF_CHUNK), np.asarray(blocks) // BLOCKS_OF_CHUNK
    begins, ready = np.full(n_chunks, n_tiles), np.zeros(n_chunks, dtype=np.int64)
    np.minimum.at(begins, chunks, lane_of[:, None] // LANES)
    np.maximum.at(ready, chunks, lane_of[:, None] // LANES + 1)
    stride = (4 if d == 2 else 16) * LANES
    ring = 1 << int(max((ready - begins).max(initial=0) - 1, 0)).bit_length()
    place = lane_of // LANES * stride + lane_of % LANES
    side = 2 * np.concatenate([blocks[:, 1], blocks[:, 0]]) + np.repeat([0, 1], n)
    return JointTiles(
        joints, slots, np.concatenate([[0], np.cumsum(np.bincount(side, minlength=2 * n_blocks))]),
        np.tile(place, 2)[np.argsort(side, kind="stable")].astype(np.uint32), begins, ready,
        np.argsort(ready, kind="stable"), np.array([ring - 1], np.uint64), np.zeros(n_tiles * 2 * LANES, np.int32),
        np.zeros((n_tiles * of_tile + slots[-1] * of_slot) * LANES), np.zeros(slots[-1] * of_slot * LANES),
        np.zeros(n_tiles * stride),
        np.zeros(threads * TILES_AHEAD * of_motion * LANES),
        np.zeros(threads * (2 * (d + r) + n_numbers) * LANES),
        np.zeros(threads * (d - 1 + r + heights.max(initial=0) * d) * LANES),
        np.zeros(n_parts), np.zeros(n_parts),
        np.zeros((n_chunks, N_SUMS)), np.zeros((threads, N_SUMS)), new_team(threads),
    )  # fmt: skip
