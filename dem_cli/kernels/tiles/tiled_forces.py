"""Contact forces of joints whose geometry does not move, sixteen joints at a time (SIMD), for laws without branches.

The same sums in the same order as kernels/contact_forces.py, to the last bit. Each tile leaves the pushes of its joints
on their blocks; each block then gathers its own, in the order of the joints: whoever works on which tile, and on how
many at once, changes no bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.kernels.contact_point import friction_work, plastic_slide
from dem_cli.kernels.jit import inline, named
from dem_cli.kernels.joint_plane import add_moment_at, moment, opening_at, seen_from, seen_outside, sliding_at, sweep
from dem_cli.kernels.tiles.joint_tiles import TILES_AHEAD, TILES_OF_CHUNK
from dem_cli.kernels.tiles.lanes import LANES, ROW, put, take, take_frame
from dem_cli.kernels.vec import axpy, components, compose, load, norm, scale, store

ONE, TWO = np.uint64(1), np.uint64(2)


class TiledForces(NamedTuple):
    """What `make_advance` closes over."""

    take_up: Callable  # into the tiles, before the first step
    press: Callable  # forces of some tiles; returns their friction work [J]
    give_back: Callable  # into the records of contacts, after the last step


@inline
def stride_of(like):
    """Numbers from the pushes of one tile to those of the next, a power of two."""
    return (np.uint64(4) if len(like) == 2 else np.uint64(16)) * ROW


@inline
def gather(tiles, forces, ring, first, last, back, like, like_rotation):
    """Forces of the blocks from first to last: the sums of what their joints push with.

    ring: of so many tiles, less one, the pushes are kept; back: rows of `forces` that stand so much before the block.
    """
    starts, sides, pushes = tiles.side_starts, tiles.sides, tiles.pushes
    d, r = len(like), len(like_rotation)
    D, R = np.uint64(d) * ROW, np.uint64(r) * ROW
    mask = (ring + ONE) * stride_of(like) - ONE
    for number in range(last - first):
        block = np.uint64(first) + np.uint64(number)
        row = np.uint64(first - back) + np.uint64(number)
        low, middle, high = starts[TWO * block], starts[TWO * block + ONE], starts[TWO * block + TWO]
        force, torque = scale(0.0, like), scale(0.0, like_rotation)
        for k in range(low, middle):
            place = np.uint64(sides[np.uint64(k)]) & mask
            force = axpy(1.0, force, take(pushes, place, like))
            torque = axpy(1.0, torque, take(pushes, place + D + R, like_rotation))
        for k in range(middle, high):
            place = np.uint64(sides[np.uint64(k)]) & mask
            force = axpy(-1.0, take(pushes, place, like), force)
            torque = axpy(-1.0, take(pushes, place + D, like_rotation), torque)
        store(forces, row, 0, force)
        store(forces, row, d, torque)


@inline
def _move(tiles, velocities, tile, motion, like, like_rotation):
    """How the blocks of the joints of one tile move: b against a, then both spins."""
    ends, moves, d = tiles.ends, tiles.moves, len(like)
    end, turns, R = np.uint64(tile) * TWO * ROW, motion + np.uint64(d) * ROW, np.uint64(len(like_rotation)) * ROW
    for i in range(LANES):
        lane = np.uint64(i)
        a, b = np.uint64(ends[end + lane]), np.uint64(ends[end + ROW + lane])
        put(moves, motion + lane, axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like)))
        put(moves, turns + lane, load(velocities, a, d, like_rotation))
        put(moves, turns + R + lane, load(velocities, b, d, like_rotation))


def make_tiled_forces(law: Callable, n_numbers: int) -> TiledForces:
    """Tiles for one law in its form for lanes (laws/law.py), which reads n_numbers parameters of a joint."""

    @inline
    def take_up(joints, contacts, first, last, like, like_rotation):
        """Constants and state of the tiles from first to last, from the records that everybody else reads."""
        tiles, d = joints.tiles, len(like)
        n_axes = joints.axes.shape[1]
        of_tile, of_slot = np.uint64(n_axes + 2 * d + n_numbers) * ROW, np.uint64(d + 1) * ROW
        ends, constants, springs, state = tiles.ends, tiles.constants, tiles.springs, tiles.state
        for t in range(first, last):
            for i in range(LANES):
                lane = np.uint64(i)
                joint = tiles.joints[np.uint64(t) * ROW + lane]
                end, row = np.uint64(t) * TWO * ROW + lane, np.uint64(t) * of_tile + lane
                start = count = 0
                if joint >= 0:
                    start, count = joints.starts[joint], joints.starts[joint + 1] - joints.starts[joint]
                    ends[end], ends[end + ROW] = joints.blocks[joint, 0], joints.blocks[joint, 1]
                    for k in range(n_axes):
                        constants[row + np.uint64(k) * ROW] = joints.axes[joint, k]
                    for k in range(2 * d):
                        constants[row + np.uint64(n_axes + k) * ROW] = joints.arms[joint, k]
                    for k in range(n_numbers):
                        constants[row + np.uint64(n_axes + 2 * d + k) * ROW] = joints.law[joint, k]
                for p in range(tiles.slots[t + 1] - tiles.slots[t]):
                    at = np.uint64(tiles.slots[t] + p) * of_slot + lane
                    if p >= count:  # there is none: it never touches
                        for k in range(d + 1):
                            springs[at + np.uint64(k) * ROW] = state[at + np.uint64(k) * ROW] = 0.0
                        state[at] = 1e300
                        continue
                    point = start + p
                    for k in range(d - 1):
                        springs[at + np.uint64(k) * ROW] = joints.places[point, k]
                        state[at + np.uint64(1 + k) * ROW] = contacts.shear[point, k]
                    springs[at + np.uint64(d - 1) * ROW] = joints.kn[point]
                    springs[at + np.uint64(d) * ROW] = joints.ks[point]
                    state[at] = contacts.gaps[point]
                    state[at + np.uint64(d) * ROW] = contacts.slip[point]

    @inline
    def give_back(joints, contacts, first, last, like):
        """The state of the tiles from first to last after a step, into the records."""
        tiles, state, d = joints.tiles, joints.tiles.state, len(like)
        of_slot = np.uint64(d + 1) * ROW
        for t in range(first, last):
            for i in range(LANES):
                lane = np.uint64(i)
                joint = tiles.joints[np.uint64(t) * ROW + lane]
                if joint < 0:
                    continue
                for p in range(joints.starts[joint + 1] - joints.starts[joint]):
                    at, point = np.uint64(tiles.slots[t] + p) * of_slot + lane, joints.starts[joint] + p
                    gap = state[at]
                    contacts.gaps[point] = gap
                    contacts.normal[point] = -joints.kn[point] * gap if gap < 0.0 else 0.0
                    for k in range(d - 1):
                        contacts.shear[point, k] = state[at + np.uint64(1 + k) * ROW]
                    contacts.slip[point] = state[at + np.uint64(d) * ROW]

    @inline
    def press_tile(tiles, tile, ring, motion, begin, befores, lost, dt, like, like_rotation):
        """Forces of one tile, left in `pushes`; adds its friction work to `lost` [J].

        motion, begin, befores: where its room begins in `moves`, `work` and `marks`.
        """
        d, r = len(like), len(like_rotation)
        D, R, T = np.uint64(d) * ROW, np.uint64(r) * ROW, np.uint64(d - 1) * ROW
        A = (TWO if d == 2 else np.uint64(9)) * ROW
        constants, springs, state, pushes = tiles.constants, tiles.springs, tiles.state, tiles.pushes
        moves, work, marks = tiles.moves, tiles.work, tiles.marks
        row = np.uint64(tile) * (A + TWO * D + np.uint64(n_numbers) * ROW)
        push = (np.uint64(tile) & ring) * stride_of(like)
        # Rows of work: opening, slide and spin of the joints, then their sums.
        turns, opening = motion + D, begin
        slides, spins = opening + ROW, opening + D
        sums = spins + R
        rubs, twists = sums + ROW, sums + D
        for i in range(LANES):
            lane = np.uint64(i)
            frame = take_frame(constants, row + lane, like)
            arm_a, arm_b = take(constants, row + A + lane, like), take(constants, row + A + D + lane, like)
            spin_a, spin_b = take(moves, turns + lane, like_rotation), take(moves, turns + R + lane, like_rotation)
            moved = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), take(moves, motion + lane, like))
            opens, slide = components(frame, scale(dt, moved))
            work[opening + lane] = opens
            put(work, slides + lane, slide)
            put(work, spins + lane, seen_from(frame, scale(dt, axpy(-1.0, spin_a, spin_b))))
            put(work, sums + lane, scale(0.0, like))
            put(work, twists + lane, scale(0.0, like_rotation))
        first, count = np.uint64(tiles.slots[tile]), np.uint64(tiles.slots[tile + 1] - tiles.slots[tile])
        lossy = 0
        for p in range(count):
            at, before = (first + np.uint64(p)) * (D + ROW), befores + np.uint64(p) * D
            for i in range(LANES):
                lane = np.uint64(i)
                place = take(springs, at + lane, like[1:])
                kn, ks = springs[at + T + lane], springs[at + D + lane]
                spin, old = take(work, spins + lane, like_rotation), take(state, at + ROW + lane, like[1:])
                gap = state[at + lane] + (work[opening + lane] + opening_at(spin, place))
                slide = sliding_at(take(work, slides + lane, like[1:]), spin, place)
                normal, shear, loses = law(gap, slide, old, kn, ks, constants, row + A + TWO * D + lane)
                state[at + lane] = gap
                put(state, at + ROW + lane, shear)
                put(marks, before + lane, old)
                marks[before + T + lane] = normal if loses else -1.0
                lossy |= 1 if loses else 0
                work[sums + lane] += normal
                put(work, rubs + lane, axpy(1.0, shear, take(work, rubs + lane, like[1:])))
                put(work, twists + lane, add_moment_at(place, normal, shear, take(work, twists + lane, like_rotation)))
        for i in range(LANES):
            lane = np.uint64(i)
            frame = take_frame(constants, row + lane, like)
            arm_a, arm_b = take(constants, row + A + lane, like), take(constants, row + A + D + lane, like)
            rub, twist = take(work, rubs + lane, like[1:]), take(work, twists + lane, like_rotation)
            force = compose(frame, work[sums + lane], rub, scale(0.0, like))
            couple = seen_outside(frame, twist)
            put(pushes, push + lane, force)
            put(pushes, push + D + lane, axpy(1.0, moment(arm_a, force), couple))
            put(pushes, push + D + R + lane, axpy(1.0, moment(arm_b, force), couple))
        if lossy:
            for i in range(LANES):
                lane = np.uint64(i)
                for p in range(count):
                    before = befores + np.uint64(p) * D + lane
                    normal = marks[before + T]
                    if normal < 0.0:
                        continue
                    at = (first + np.uint64(p)) * (D + ROW) + lane
                    place, ks = take(springs, at, like[1:]), springs[at + D]
                    slide = sliding_at(
                        take(work, slides + lane, like[1:]), take(work, spins + lane, like_rotation), place
                    )
                    old, shear = take(marks, before, like[1:]), take(state, at + ROW, like[1:])
                    plastic = plastic_slide(old, shear, slide, ks)
                    if normal > 0.0:
                        state[at + D] += norm(plastic)
                    lost += friction_work(old, shear, plastic)
        return lost

    @inline
    def press(tiles, velocities, ring, member, members, first, last, dt, like, like_rotation):
        """Forces of the tiles from first to last, by one thread of some; adds their friction work to `lost` [J]."""
        D, R = np.uint64(len(like)) * ROW, np.uint64(len(like_rotation)) * ROW
        begin, befores = np.uint64(member * (tiles.work.size // members)), member * (tiles.marks.size // members)
        motions, lost = np.uint64(member * (tiles.moves.size // members)), tiles.lost
        for some in range(first, last, TILES_AHEAD):
            count = min(TILES_AHEAD, last - some)
            for t in range(count):
                _move(tiles, velocities, some + t, motions + np.uint64(t) * (D + TWO * R), like, like_rotation)
            for t in range(count):
                part = (some + t) // TILES_OF_CHUNK
                motion = motions + np.uint64(t) * (D + TWO * R)
                lost[part] = press_tile(
                    tiles, some + t, ring, motion, begin, np.uint64(befores), lost[part], dt, like, like_rotation
                )

    return TiledForces(*(named(part, law) for part in (take_up, press, give_back)))
