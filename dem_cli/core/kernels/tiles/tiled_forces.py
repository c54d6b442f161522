"""Contact forces in fixed geometry, sixteen joints at a time (SIMD), for laws without branches.

The same sums in the same order as kernels/contact_forces.py, to the last bit. Each tile leaves the pushes of its joints
on their blocks; each block then gathers its own, in the order of the joints: whoever works on which tile, and on how
many at once, changes no bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.core.kernels.contact_forces import pressed_at
from dem_cli.core.kernels.contact_point import friction_work, plastic_slide
from dem_cli.core.kernels.deformation.pressed_faces import line_gaps
from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.kernels.joint_plane import (
    add_moment_at,
    centre_of,
    drawn_in,
    moment,
    opening_at,
    seen_from,
    seen_outside,
    sliding_at,
    sweep,
    torsion_of,
    torsion_share,
)
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.tiles.joint_tiles import N_TORSION, TILES_AHEAD, TILES_OF_CHUNK
from dem_cli.core.kernels.tiles.lanes import LANES, ROW, lowest_bit, put, take, take_frame
from dem_cli.core.kernels.vec import axpy, components, compose, load, norm, scale, store

ONE, TWO, TWO_POINTS = np.uint64(1), np.uint64(2), 2


class TiledForces(NamedTuple):
    """Compiled functions of the tiles that the stepping loop calls."""

    take_up: Callable  # into the tiles, before the first step
    press: Callable  # forces of some tiles; returns their friction work [J]
    give_back: Callable  # into the records of contacts, after the last step


@inline
def rows_of_torsion(like):
    """Count rows of `numbers` of a tile for torsion: none in the plane."""
    return 0 if len(like) == 2 else N_TORSION


@inline
def stride_of(like):
    """Compute the distance between the pushes of one tile and those of the next, a power of two."""
    return (np.uint64(4) if len(like) == 2 else np.uint64(16)) * ROW


@inline
def gather(tiles, forces, ring, first, last, back, like, like_rotation):
    """Sum the forces of the blocks from first to last over the pushes of their joints.

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
def _begin_of(tiles, tile, of_tile, of_slot):
    """Find where the numbers of a tile and the state of its points begin, and how many slots it has."""
    first, last = np.uint64(tiles.slots[np.uint64(tile)]), np.uint64(tiles.slots[np.uint64(tile) + ONE])
    return np.uint64(tile) * of_tile + first * of_slot, first * of_slot, last - first


@inline
def _move(tiles, velocities, tile, motion, like, like_rotation):
    """Compute the motion of the blocks of the joints of one tile: b against a, then both spins."""
    ends, moves, d = tiles.ends, tiles.moves, len(like)
    end, turns, R = np.uint64(tile) * TWO * ROW, motion + np.uint64(d) * ROW, np.uint64(len(like_rotation)) * ROW
    for i in range(LANES):
        lane = np.uint64(i)
        a, b = np.uint64(ends[end + lane]), np.uint64(ends[end + ROW + lane])
        put(moves, motion + lane, axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like)))
        put(moves, turns + lane, load(velocities, a, d, like_rotation))
        put(moves, turns + R + lane, load(velocities, b, d, like_rotation))


def make_tiled_forces(law: Callable, n_numbers: int, elastic: bool = False) -> TiledForces:
    """Make the functions of tiles for one law in its form for lanes (laws/law.py).

    n_numbers: numbers of a joint that the tiles keep: parameters that the law reads; elastic: in the plane, and last
    whether the pressure is integrated over the line (kernels/deformation/pressed_faces.py).
    """
    of_the_law = n_numbers - 1 if elastic else n_numbers

    @inline
    def take_up(joints, contacts, first, last, like, like_rotation):
        """Copy constants and state into the tiles from first to last, from the records that everybody else reads."""
        tiles, d = joints.tiles, len(like)
        n_axes, ends, numbers, state = joints.axes.shape[1], tiles.ends, tiles.numbers, tiles.state
        n_drawn = rows_of_torsion(like)
        of_tile, of_slot = np.uint64(n_axes + 2 * d + n_drawn + n_numbers) * ROW, np.uint64(d + 1) * ROW
        for t in range(first, last):
            begin, held, slots = _begin_of(tiles, t, of_tile, of_slot)
            for i in range(LANES):
                lane = np.uint64(i)
                joint = tiles.joints[np.uint64(t) * ROW + lane]
                end, row = np.uint64(t) * TWO * ROW + lane, begin + lane
                start = count = 0
                if joint >= 0:
                    start, count = joints.starts[joint], joints.starts[joint + 1] - joints.starts[joint]
                    ends[end], ends[end + ROW] = joints.blocks[joint, 0], joints.blocks[joint, 1]
                    for k in range(n_axes):
                        numbers[row + np.uint64(k) * ROW] = joints.axes[joint, k]
                    for k in range(2 * d):
                        numbers[row + np.uint64(n_axes + k) * ROW] = joints.arms[joint, k]
                    drawn = row + np.uint64(n_axes + 2 * d) * ROW
                    if n_drawn > 0:
                        centre = pressed_at(joints.places, contacts.normal, start, start + count, like, like_rotation)
                        numbers[drawn] = torsion_share(joints.torsion, joint, like)
                        put(numbers, drawn + ROW, centre)
                    for k in range(of_the_law):
                        numbers[drawn + np.uint64(n_drawn + k) * ROW] = joints.law[joint, k]
                    if elastic:
                        numbers[drawn + np.uint64(n_drawn + of_the_law) * ROW] = float(joints.integrated[joint])
                for p in range(slots):
                    at, now = row + of_tile + np.uint64(p) * of_slot, held + np.uint64(p) * of_slot + lane
                    if p >= count:  # there is none: it never touches
                        for k in range(d + 1):
                            numbers[at + np.uint64(k) * ROW] = state[now + np.uint64(k) * ROW] = 0.0
                        state[now] = 1e300
                        continue
                    point = start + p
                    for k in range(d - 1):
                        numbers[at + np.uint64(k) * ROW] = joints.places[point, k]
                        state[now + np.uint64(1 + k) * ROW] = contacts.shear[point, k]
                    numbers[at + np.uint64(d - 1) * ROW] = joints.kn[point]
                    numbers[at + np.uint64(d) * ROW] = joints.ks[point]
                    state[now] = contacts.gaps[point]
                    state[now + np.uint64(d) * ROW] = contacts.slip[point]

    @inline
    def give_back(joints, contacts, first, last, like):
        """Copy the state of the tiles from first to last back into the records after a step."""
        tiles, state, d = joints.tiles, joints.tiles.state, len(like)
        of_slot = np.uint64(d + 1) * ROW
        for t in range(first, last):
            for i in range(LANES):
                lane = np.uint64(i)
                joint = tiles.joints[np.uint64(t) * ROW + lane]
                if joint < 0:
                    continue
                low, high, whole = 0.0, 0.0, False
                if elastic:
                    now, whole = np.uint64(tiles.slots[t]) * of_slot + lane, joints.integrated[joint] == INTEGRATED
                    if whole:
                        low, high = line_gaps(state[now], state[now + of_slot])
                for p in range(joints.starts[joint + 1] - joints.starts[joint]):
                    now, point = np.uint64(tiles.slots[t] + p) * of_slot + lane, joints.starts[joint] + p
                    gap = state[now]
                    contacts.gaps[point] = gap
                    if whole:
                        gap = low if p == 0 else high
                    contacts.normal[point] = -joints.kn[point] * gap if gap < 0.0 else 0.0
                    for k in range(d - 1):
                        contacts.shear[point, k] = state[now + np.uint64(1 + k) * ROW]
                    contacts.slip[point] = state[now + np.uint64(d) * ROW]

    @inline
    def press_slots(tiles, begin, held, count, push, motion, room, marked, dt, like, like_rotation):
        """Compute forces of one tile with any number of slots, into `pushes`; returns the lanes that lost work, as
        bits.

        begin, held, push: where its numbers, the state of its points and its pushes begin; motion, room, marked: where
        there is room for it in `moves`, `work` and `marks`.
        """
        d, r = len(like), len(like_rotation)
        D, R, T = np.uint64(d) * ROW, np.uint64(r) * ROW, np.uint64(d - 1) * ROW
        A, S = (TWO if d == 2 else np.uint64(9)) * ROW, D + ROW
        drawn = begin + A + TWO * D
        of_joint = drawn + np.uint64(rows_of_torsion(like)) * ROW
        numbers, state, moves, work = tiles.numbers, tiles.state, tiles.moves, tiles.work
        marks, pushes = tiles.marks, tiles.pushes
        # Rows of work: opening, slide and spin of the joints, then their sums.
        turns, slides, spins = motion + D, room + ROW, room + D
        sums = spins + R
        rubs, twists, of_law = sums + ROW, sums + D, sums + D + R
        for i in range(LANES):
            lane = np.uint64(i)
            frame = take_frame(numbers, begin + lane, like)
            arm_a, arm_b = take(numbers, begin + A + lane, like), take(numbers, begin + A + D + lane, like)
            spin_a, spin_b = take(moves, turns + lane, like_rotation), take(moves, turns + R + lane, like_rotation)
            moved = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), take(moves, motion + lane, like))
            opens, slide = components(frame, scale(dt, moved))
            spin = seen_from(frame, scale(dt, axpy(-1.0, spin_a, spin_b)))
            if d == 3:
                slide, spin = drawn_in(slide, spin, take(numbers, drawn + ROW + lane, like[1:]), numbers[drawn + lane])
            work[room + lane] = opens
            put(work, slides + lane, slide)
            put(work, spins + lane, spin)
            put(work, sums + lane, scale(0.0, like))
            put(work, twists + lane, scale(0.0, like_rotation))
        for k in range(n_numbers):
            for i in range(LANES):
                work[of_law + np.uint64(k) * ROW + np.uint64(i)] = numbers[of_joint + np.uint64(k) * ROW + np.uint64(i)]
        lossy = 0
        for p in range(count):
            at, now = of_joint + np.uint64(n_numbers) * ROW + np.uint64(p) * S, held + np.uint64(p) * S
            before = marked + np.uint64(p) * D
            for i in range(LANES):
                lane = np.uint64(i)
                place = take(numbers, at + lane, like[1:])
                kn, ks = numbers[at + T + lane], numbers[at + D + lane]
                spin, old = take(work, spins + lane, like_rotation), take(state, now + ROW + lane, like[1:])
                gap = state[now + lane] + (work[room + lane] + opening_at(spin, place))
                shown = gap
                if elastic and p < TWO_POINTS and count >= TWO:
                    next_at, next_now = (at + S, now + S) if p == 0 else (at - S, now - S)
                    beside = state[next_now + lane]  # a point before is where it is now already
                    if p == 0:
                        beside += work[room + lane] + opening_at(spin, take(numbers, next_at + lane, like[1:]))
                    low, high = line_gaps(gap, beside) if p == 0 else line_gaps(beside, gap)
                    whole = work[of_law + np.uint64(of_the_law) * ROW + lane] > 0.0
                    shown = (low if p == 0 else high) if whole else gap
                slide = sliding_at(take(work, slides + lane, like[1:]), spin, place)
                normal, shear, loses = law(shown, slide, old, kn, ks, work, of_law + lane)
                state[now + lane] = gap
                put(state, now + ROW + lane, shear)
                put(marks, before + lane, old)
                marks[before + T + lane] = normal if loses else -1.0
                lossy |= (1 if loses else 0) << i
                work[sums + lane] += normal
                put(work, rubs + lane, axpy(1.0, shear, take(work, rubs + lane, like[1:])))
                put(work, twists + lane, add_moment_at(place, normal, shear, take(work, twists + lane, like_rotation)))
        for i in range(LANES):
            lane = np.uint64(i)
            frame = take_frame(numbers, begin + lane, like)
            arm_a, arm_b = take(numbers, begin + A + lane, like), take(numbers, begin + A + D + lane, like)
            rub, twist = take(work, rubs + lane, like[1:]), take(work, twists + lane, like_rotation)
            if d == 3:
                centre = centre_of(work[sums + lane], twist)
                twist = torsion_of(twist, rub, take(numbers, drawn + ROW + lane, like[1:]), numbers[drawn + lane])
                put(numbers, drawn + ROW + lane, centre)
            force = compose(frame, work[sums + lane], rub, scale(0.0, like))
            couple = seen_outside(frame, twist)
            put(pushes, push + lane, force)
            put(pushes, push + D + lane, axpy(1.0, moment(arm_a, force), couple))
            put(pushes, push + D + R + lane, axpy(1.0, moment(arm_b, force), couple))
        return lossy

    @inline
    def press_pairs(tiles, begin, held, push, motion, before, dt, like, like_rotation):
        """Compute the forces of press_slots for joints with two points, in one loop, so that they stay in registers."""
        d, r = len(like), len(like_rotation)
        D, R, T = np.uint64(d) * ROW, np.uint64(r) * ROW, np.uint64(d - 1) * ROW
        A, S = (TWO if d == 2 else np.uint64(9)) * ROW, D + ROW
        numbers, state, moves, marks, pushes = tiles.numbers, tiles.state, tiles.moves, tiles.marks, tiles.pushes
        turns, of_law, slides = motion + D, begin + A + TWO * D, before + TWO * D
        first, next_held = of_law + np.uint64(n_numbers) * ROW, held + S
        second = first + S
        lossy = 0
        for i in range(LANES):
            lane = np.uint64(i)
            frame = take_frame(numbers, begin + lane, like)
            arm_a, arm_b = take(numbers, begin + A + lane, like), take(numbers, begin + A + D + lane, like)
            spin_a, spin_b = take(moves, turns + lane, like_rotation), take(moves, turns + R + lane, like_rotation)
            moved = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), take(moves, motion + lane, like))
            opens, slide = components(frame, scale(dt, moved))
            spin = seen_from(frame, scale(dt, axpy(-1.0, spin_a, spin_b)))
            put(marks, slides + lane, slide)
            put(marks, slides + T + lane, spin)
            p, old_p = take(numbers, first + lane, like[1:]), take(state, held + ROW + lane, like[1:])
            q, old_q = take(numbers, second + lane, like[1:]), take(state, next_held + ROW + lane, like[1:])
            gap_p = state[held + lane] + (opens + opening_at(spin, p))
            gap_q = state[next_held + lane] + (opens + opening_at(spin, q))
            lump_p, lump_q = gap_p, gap_q
            if elastic:
                whole = numbers[of_law + np.uint64(of_the_law) * ROW + lane] > 0.0
                at_p, at_q = line_gaps(gap_p, gap_q)
                lump_p, lump_q = at_p if whole else gap_p, at_q if whole else gap_q
            kn, ks, slid = numbers[first + T + lane], numbers[first + D + lane], sliding_at(slide, spin, p)
            push_p, rub_p, loses_p = law(lump_p, slid, old_p, kn, ks, numbers, of_law + lane)
            kn, ks, slid = numbers[second + T + lane], numbers[second + D + lane], sliding_at(slide, spin, q)
            push_q, rub_q, loses_q = law(lump_q, slid, old_q, kn, ks, numbers, of_law + lane)
            state[held + lane], state[next_held + lane] = gap_p, gap_q
            put(state, held + ROW + lane, rub_p)
            put(state, next_held + ROW + lane, rub_q)
            put(marks, before + lane, old_p)
            put(marks, before + D + lane, old_q)
            marks[before + T + lane] = push_p if loses_p else -1.0
            marks[before + D + T + lane] = push_q if loses_q else -1.0
            lossy |= (1 if loses_p | loses_q else 0) << i
            twist = add_moment_at(q, push_q, rub_q, add_moment_at(p, push_p, rub_p, scale(0.0, like_rotation)))
            rub = axpy(1.0, rub_q, axpy(1.0, rub_p, scale(0.0, like[1:])))
            force = compose(frame, (0.0 + push_p) + push_q, rub, scale(0.0, like))
            couple = seen_outside(frame, twist)
            put(pushes, push + lane, force)
            put(pushes, push + D + lane, axpy(1.0, moment(arm_a, force), couple))
            put(pushes, push + D + R + lane, axpy(1.0, moment(arm_b, force), couple))
        return lossy

    @inline
    def wear(tiles, lossy, first, held, count, before, moved, slides, lost, like, like_rotation):
        """Update slip paths of one tile in the lanes where work is lost; adds that to `lost` [J].

        first, held, before: where `numbers`, `state` and `marks` of its slots begin; moved[slides:]: slide and spin.
        """
        d, numbers, state, marks = len(like), tiles.numbers, tiles.state, tiles.marks
        D, T = np.uint64(d) * ROW, np.uint64(d - 1) * ROW
        while lossy != 0:
            lane = np.uint64(lowest_bit(lossy))
            lossy &= lossy - 1
            for p in range(count):
                mark = before + np.uint64(p) * D + lane
                normal = marks[mark + T]
                if normal < 0.0:
                    continue
                at, now = first + np.uint64(p) * (D + ROW) + lane, held + np.uint64(p) * (D + ROW) + lane
                place, ks = take(numbers, at, like[1:]), numbers[at + D]
                slide = take(moved, slides + lane, like[1:])
                slide = sliding_at(slide, take(moved, slides + T + lane, like_rotation), place)
                old, shear = take(marks, mark, like[1:]), take(state, now + ROW, like[1:])
                plastic = plastic_slide(old, shear, slide, ks)
                if normal > 0.0:
                    state[now + D] += norm(plastic)
                lost += friction_work(old, shear, plastic)
        return lost

    @inline
    def press_tile(tiles, tile, ring, motion, room, marked, lost, dt, like, like_rotation):
        """Compute forces of one tile, into `pushes`; adds its friction work to `lost` [J].

        motion, room, marked: where its room begins in `moves`, `work` and `marks`.
        """
        d, D = len(like), np.uint64(len(like)) * ROW
        of_tile = (TWO if d == 2 else np.uint64(9)) * ROW + TWO * D
        of_tile += np.uint64(rows_of_torsion(like) + n_numbers) * ROW
        begin, held, count = _begin_of(tiles, tile, of_tile, D + ROW)
        push = (np.uint64(tile) & ring) * stride_of(like)
        if d == 2 and count == TWO:
            lossy = press_pairs(tiles, begin, held, push, motion, marked, dt, like, like_rotation)
            moved, slides = tiles.marks, marked + TWO * D
        else:
            lossy = press_slots(tiles, begin, held, count, push, motion, room, marked, dt, like, like_rotation)
            moved, slides = tiles.work, room + ROW
        if lossy != 0:
            first = begin + of_tile
            lost = wear(tiles, lossy, first, held, count, marked, moved, slides, lost, like, like_rotation)
        return lost

    @inline
    def press(tiles, velocities, ring, member, members, first, last, dt, like, like_rotation):
        """Forces of the tiles from first to last, by one thread of several; adds their friction work to `lost` [J]."""
        of_motion = np.uint64(len(like) + 2 * len(like_rotation)) * ROW
        motions, lost = np.uint64(member * (tiles.moves.size // members)), tiles.lost
        room, marked = member * (tiles.work.size // members), member * (tiles.marks.size // members)
        for some in range(first, last, TILES_AHEAD):
            count = min(TILES_AHEAD, last - some)
            for t in range(count):
                _move(tiles, velocities, some + t, motions + np.uint64(t) * of_motion, like, like_rotation)
            for t in range(count):
                part, motion = (some + t) // TILES_OF_CHUNK, motions + np.uint64(t) * of_motion
                lost[part] = press_tile(
                    tiles,
                    some + t,
                    ring,
                    motion,
                    np.uint64(room),
                    np.uint64(marked),
                    lost[part],
                    dt,
                    like,
                    like_rotation,
                )

    return TiledForces(*(named(part, law, *["elastic"] * elastic) for part in (take_up, press, give_back)))
