"""Time steps in one compiled call as in kernels/advance.py, with joints in tiles and threads that share the work.

For many blocks whose geometry does not move. Each thread has tiles and chunks of blocks of its own. Sums over all
blocks are those of the chunks in their order, so that any number of threads finds the same bits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.advance import (
    along_live_load,
    book,
    carry,
    driven_flow,
    is_carried,
    kick,
    largest_unbalanced,
    mobility,
    powers,
    steered_flow,
    steering,
)
from dem_cli.core.kernels.jit import inline, kernel, named
from dem_cli.core.kernels.records import (
    CREEP,
    DAMP,
    DAMP_CHANGE,
    DEAD_FACTOR,
    FIRE,
    FRICTION,
    GUIDED,
    LIVE_FACTOR,
    MEAN_LOAD,
    N_CONTROL,
    N_LEDGER,
    RATE,
    TILT_CREEP,
    TILT_GUIDED,
    UNBALANCED,
)
from dem_cli.core.kernels.tiles.joint_tiles import BLOCKS_OF_CHUNK, TILES_OF_CHUNK
from dem_cli.core.kernels.tiles.team import join, wait
from dem_cli.core.kernels.tiles.tiled_forces import TiledForces, gather
from dem_cli.core.kernels.vec import axpy, in_a_row, load, store

# Columns of `books` behind those of the ledger.
ALONG, POWER, SPEED, FORCE, FLOW = N_LEDGER, N_LEDGER + 1, N_LEDGER + 2, N_LEDGER + 3, N_LEDGER + 4

ALL_TILES = np.uint64(2**40 - 1)


@inline
def _share(n, member, members):
    """Divide n things in a row among threads: the first of one thread and the one behind its last."""
    each = (n + members - 1) // members
    return min(member * each, n), min((member + 1) * each, n)


@inline
def _total(books, column):
    """Sum a column over all chunks of blocks, in their order."""
    total = 0.0
    for chunk in range(books.shape[0]):
        total += books[chunk, column]
    return total


@inline
def _together(tiles, members, met):
    """Wait for the other threads, where there are some."""
    return wait(tiles.team, members, met) if members > 1 else met


@inline
def _owner(tiles, chunk, members):
    """Find the thread that works on a chunk of blocks, and whether nobody else works on its joints."""
    n_parts = tiles.lost.size
    each = ((n_parts + members - 1) // members) * TILES_OF_CHUNK
    first = tiles.begins[chunk] // each
    if tiles.begins[chunk] < tiles.ready[chunk] <= (first + 1) * each:
        return first, True
    return chunk * members // tiles.books.shape[0], False


@inline
def _open(tiles, ledger, member, low, high):
    """Put the ledger of the steps before into the first chunk and the first part, and zero into all others."""
    for part in range(low, high):
        tiles.lost_before[part] = ledger[FRICTION] if part == 0 else 0.0
    if member == 0:
        for chunk in range(tiles.books.shape[0]):
            for k in range(N_LEDGER):
                tiles.books[chunk, k] = ledger[k] if chunk == 0 else 0.0


@inline
def _close(tiles, ledger):
    """Add the sums of all chunks and parts, in their order, into the ledger."""
    for k in range(N_LEDGER):
        ledger[k] = _total(tiles.books, k)
    ledger[FRICTION] = 0.0
    for part in range(tiles.lost.size):
        ledger[FRICTION] += tiles.lost_before[part]


@inline
def _add_up(flat, books, control, mode, first, last, dt):
    """Sum the powers and the flow that steer all blocks, over the degrees of freedom from first to last."""
    velocities, forces, previous, dead_loads, live_loads, inverse_masses, _ = flat
    i, j, dead, live = first, last, control[DEAD_FACTOR], control[LIVE_FACTOR]
    if mode in (GUIDED, TILT_GUIDED, FIRE):
        books[POWER], books[SPEED], books[FORCE] = powers(
            velocities[i:j], forces[i:j], dead_loads[i:j], live_loads[i:j], inverse_masses[i:j], dead, live
        )
    if mode in (GUIDED, TILT_GUIDED):
        books[FLOW] = steered_flow(velocities[i:j], live_loads[i:j])
    elif mode in (CREEP, TILT_CREEP):
        books[FLOW] = driven_flow(
            velocities[i:j], forces[i:j], previous[i:j], dead_loads[i:j], live_loads[i:j], inverse_masses[i:j],
            dead, live, control[DAMP], control[DAMP_CHANGE], dt,
        )  # fmt: skip


@inline
def _drift(bodies, first, last, dt, like, like_rotation):
    """Update positions and rotation vectors of some blocks from velocities; to first order rotations add up."""
    positions, orientations, velocities, d = bodies.positions, bodies.orientations, bodies.velocities, len(like)
    for number in range(last - first):
        i = np.uint64(first) + np.uint64(number)
        store(positions, i, 0, axpy(dt, load(velocities, i, 0, like), load(positions, i, 0, like)))
        turned = axpy(dt, load(velocities, i, d, like_rotation), load(orientations, i, 0, like_rotation))
        store(orientations, i, 0, turned)


@inline
def _settle(
    bodies, flat, means, drags, books, control, first, last, keep, steer, impulse, dt, carried, back, free,
    like, like_rotation,
):  # fmt: skip
    """Update velocities, energy sums and places of the blocks from first to last.

    flat: arrays by degrees of freedom; back: their forces stand so many rows before them; free: all speed limits are
    the same, so that one chunk has those of another.
    """
    velocities, forces, previous, dead_loads, live_loads, inverse_masses, speed_limits = flat
    n_dof = bodies.velocities.shape[1]
    i, j, f = first * n_dof, last * n_dof, (first - back) * n_dof
    limits = speed_limits[: j - i] if free else speed_limits[i:j]
    pushed = forces[f : f + j - i]
    dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
    kick(
        velocities[i:j], pushed, previous[i:j], dead_loads[i:j], live_loads[i:j], inverse_masses[i:j],
        limits, means, drags, dead, live, control[DAMP], control[DAMP_CHANGE], keep, steer, impulse, dt,
    )  # fmt: skip
    book(
        pushed, dead_loads[i:j], live_loads[i:j], inverse_masses[i:j], means, drags, dead, live, impulse, dt,
        carried, books,
    )  # fmt: skip
    _drift(bodies, first, last, dt, like, like_rotation)


def make_tiled_advance(tiled_forces: TiledForces, link_forces: Callable | None = None) -> Callable:
    """Make the compiled stepping loop for one law in tiles and the links of the model.

    Its arguments are those of `make_advance`; as many threads have to call it as the team of the tiles has members.
    """
    take_up, press, give_back = tiled_forces
    linked, pull = link_forces is not None, link_forces or press  # what is not called is compiled away

    @kernel
    def advance(
        n_steps, mode, dt, bodies, shape, joints, geometry, contacts, links, loads, common, ledger, like,
        like_rotation,
    ):  # fmt: skip
        """Advance by n_steps; returns n_steps."""
        tiles = joints.tiles
        books, n_tiles, n_blocks = tiles.books, tiles.slots.size - 1, bodies.velocities.shape[0]
        n_chunks, of_chunk = books.shape[0], BLOCKS_OF_CHUNK * bodies.velocities.shape[1]
        velocities, forces = in_a_row(bodies.velocities), in_a_row(bodies.forces)
        previous = in_a_row(bodies.unbalanced)
        dead_loads, live_loads = in_a_row(loads.dead), in_a_row(loads.live)
        inverse_masses, force_scales = in_a_row(loads.inverse_masses), in_a_row(loads.force_scales)
        n_dof = bodies.velocities.shape[1]
        flat = (velocities, forces, previous, dead_loads, live_loads, inverse_masses, in_a_row(loads.speed_limits))
        guided = mode in (GUIDED, TILT_GUIDED)
        creeps = guided or mode in (CREEP, TILT_CREEP)
        stiffness = mobility(live_loads, inverse_masses) if creeps else 0.0
        carried, free = is_carried(velocities, inverse_masses), True
        for i in range(velocities.size):
            free = free and flat[6][i] == np.inf
        member, members = join(tiles.team)
        met = 0
        control = tiles.controls[member]
        for k in range(N_CONTROL):
            control[k] = common[k]
        part_low, part_high = _share(tiles.lost.size, member, members)
        low, high = part_low * TILES_OF_CHUNK, min(part_high * TILES_OF_CHUNK, n_tiles)
        # Mean velocities and damping forces of one chunk at a time, each thread where nobody else writes.
        own = min(member * BLOCKS_OF_CHUNK, n_blocks)
        means, drags, steps_work = bodies.means[own * n_dof :], bodies.drags[own * n_dof :], tiles.lost_before
        _open(tiles, ledger, member, part_low, part_high)
        if n_steps > 0:
            take_up(joints, contacts, low, high, like, like_rotation)
        mean_load = 0.0
        # Without sums over all blocks a chunk moves on as soon as its joints have pressed, while it is in the cache.
        at_once = not (creeps or linked or mode == FIRE)
        ring = tiles.ring[0] if members == 1 else ALL_TILES
        met = _together(tiles, members, met)
        for step in range(n_steps):
            for part in range(part_low, part_high):
                tiles.lost[part] = 0.0
            keep, steer, impulse = 1.0, 0.0, 0.0
            dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
            pressed = low
            for alone in (True, False):
                for wave in range(n_chunks):
                    chunk = tiles.waves[wave]
                    owner, private = _owner(tiles, chunk, members)
                    if owner != member or private != alone:
                        continue
                    if alone and pressed < tiles.ready[chunk]:
                        press(
                            tiles, bodies.velocities, ring, member, members, pressed, tiles.ready[chunk], dt, like,
                            like_rotation,
                        )  # fmt: skip
                        pressed = tiles.ready[chunk]
                    first, last = chunk * BLOCKS_OF_CHUNK, min((chunk + 1) * BLOCKS_OF_CHUNK, n_blocks)
                    # Forces of each chunk have the same room, but in the last step, so that less goes to memory.
                    back = first - own if at_once and step < n_steps - 1 else 0
                    gather(tiles, bodies.forces, ring, first, last, back, like, like_rotation)
                    if at_once:
                        _settle(
                            bodies, flat, means, drags, books[chunk], control, first, last, keep, steer, impulse, dt,
                            carried, back, free, like, like_rotation,
                        )  # fmt: skip
                if alone:
                    press(tiles, bodies.velocities, ring, member, members, pressed, high, dt, like, like_rotation)
                    met = _together(tiles, members, met)
            for part in range(part_low, part_high):
                steps_work[part] += tiles.lost[part]
            if at_once:
                mean_load += live
                met = _together(tiles, members, met)
                continue
            if linked:
                met = _together(tiles, members, met)
                if member == 0:
                    steps_work[0] += pull(links, bodies, like, like_rotation)
                met = _together(tiles, members, met)
            if creeps:
                for chunk in range(n_chunks):
                    if _owner(tiles, chunk, members)[0] == member:
                        i, j = chunk * of_chunk, min((chunk + 1) * of_chunk, forces.size)
                        books[chunk, ALONG] = along_live_load(
                            forces[i:j], dead_loads[i:j], live_loads[i:j], inverse_masses[i:j], dead
                        )
                met = _together(tiles, members, met)
                carry(_total(books, ALONG), stiffness, mode in (TILT_CREEP, TILT_GUIDED), control)
                dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
            if creeps or mode == FIRE:
                for chunk in range(n_chunks):
                    if _owner(tiles, chunk, members)[0] == member:
                        i, j = chunk * of_chunk, min((chunk + 1) * of_chunk, forces.size)
                        _add_up(flat, books[chunk], control, mode, i, j, dt)
                met = _together(tiles, members, met)
                if guided or mode == FIRE:
                    keep, steer = steering(_total(books, POWER), _total(books, SPEED), _total(books, FORCE), control)
                if creeps:
                    impulse = (control[RATE] - keep * _total(books, FLOW)) / stiffness
            for chunk in range(n_chunks):
                if _owner(tiles, chunk, members)[0] == member:
                    _settle(
                        bodies, flat, means, drags, books[chunk], control, chunk * BLOCKS_OF_CHUNK,
                        min((chunk + 1) * BLOCKS_OF_CHUNK, n_blocks), keep, steer, impulse, dt, carried, 0, free, like,
                        like_rotation,
                    )  # fmt: skip
            mean_load += live
            met = _together(tiles, members, met)
        if n_steps > 0:
            give_back(joints, contacts, low, high, like)
        met = _together(tiles, members, met)
        if member == 0:
            _close(tiles, ledger)
            for k in range(N_CONTROL):
                common[k] = control[k]
            common[UNBALANCED] = largest_unbalanced(previous, force_scales)
            common[MEAN_LOAD] = mean_load / n_steps
        return n_steps

    named(advance.py_func, press, *(part for part in (link_forces,) if part is not None))
    return advance
