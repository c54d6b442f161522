"""Viscous joints of time histories: dashpots solved within the step, and Maxwell elements.

A dashpot beside each spring resists its mean rate over the step, J = −c dt (w₀ + w)/2, together with all others: two
symmetric Gauss–Seidel sweeps over the impulses J, warm from the step before, leave the largest stable step that of
the springs alone, however stiff the dashpots. Spring and dashpot together do not pull (J_n ≥ −N dt); points that
slip have no dashpot along the joint, and open ones none at all. Where points have met, further sweeps go over the
joints of those blocks whose impulses still change. In 3D, where a point has two tangents, its three
impulses are solved at once (spatial_dashpots.py).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.deformation.strain_dashpots import (
    arm_of,
    give_pushes,
    mobility_along,
    plus_modes,
    push_modes,
    put_motions,
)
from dem_cli.core.kernels.jit import always_inline, inline, named, overload
from dem_cli.core.kernels.joint_plane import load_mobility, rates_at, reach_of, spun, torque_at
from dem_cli.core.kernels.records import DASHPOT, MAXWELL, SUPPORT
from dem_cli.core.kernels.vec import add_at, axpy, compose, dot, load, load_frame, scale, store

OPEN, STICKS, SLIPS, STARTS = 0, 1, 2, 3


# Columns of Dampers.gains in the plane, of the points that touch: normal, levers about both centroids; across and along
# the joint an impulse J becomes KEEP J − GAIN (rate after) − GIVEN with GIVEN = GAIN × rate before, and J itself; the
# least impulse across. Along a joint that slips all of them are 0.
NORMAL, LEVERS_A, LEVERS_B, KEEP, GAIN, GIVEN, IMPULSE, LEAST = 0, 2, 4, 6, 8, 10, 12, 14
WIDTH = 16  # of which the last is empty: two lines of the cache


@always_inline
def _put_turn(rows, row, k, levers, masses, turning, viscous, rate, more):
    """Store how an impulse relaxes in one sweep, columns k of KEEP, GAIN and GIVEN: by J/(1 + C K) + C (w₀ + w)/(1 + C
    K).

    viscous: C, half of damping × step [kg]; K: rates by impulses at the point [1/kg], of the masses (sum of both
    inverses), of turning, of both blocks by their levers, and what more there is of modes.
    """
    inverse = masses
    inverse += turning[0] * (levers[0] * levers[0]) + turning[1] * (levers[1] * levers[1])
    inverse += more
    gain = viscous / (1.0 + viscous * inverse)
    rows[row, KEEP + k], rows[row, GAIN + k], rows[row, GIVEN + k] = gain * inverse, gain, gain * rate


@always_inline
def least_of(normal, dt):
    """Compute the least impulse across a joint: spring and dashpot together do not pull, but for what is bonded."""
    return -normal * dt if normal >= 0.0 else -np.inf


@always_inline
def forget(states, memory, point, first):
    """Clear the impulse and the Maxwell forces of an open point."""
    states[point] = OPEN
    for k in range(first, memory.shape[1]):
        memory[point, k] = 0.0


@always_inline
def touch(states, seen, slips, point):
    """Record whether a point sticks or slips; where it has met, the share of the step before that it was closed."""
    before = states[point]
    states[point] = STICKS if slips[point] == seen[point] else SLIPS
    seen[point] = slips[point]
    return before == OPEN, 0.0 if before == STARTS else 1.0


@always_inline
def closed_share(gap, opening, dt):
    """Share of the step before in which a point that has met was closed, at the speed at which it closed."""
    return min(max(gap / (opening * dt), 0.0), 1.0)


@always_inline
def begin_joint(dampers, joint, n_rows):
    """Mark where the rows of a joint begin, if it gets any."""
    dampers.packed[joint], dampers.met[joint] = n_rows, 0


@always_inline
def end_joint(dampers, joint, n_rows, n_active):
    """Add a joint with rows to the joints to sweep; returns how many joints there are to sweep."""
    if n_rows > dampers.packed[joint]:
        dampers.active[n_active] = joint
        n_active += 1
    return n_active


@always_inline
def stir(dampers, joint, a, b, turn, change):
    """Record the sweep in which a joint changed its impulses by so much [N s] that its neighbours are affected.

    At first only where points have met, then wherever it spreads to.
    """
    if turn > 1 or dampers.met[joint] != 0:
        if change > dampers.trifles[a]:
            dampers.stirred[a] = turn
        if change > dampers.trifles[b]:
            dampers.stirred[b] = turn


@inline
def waken(joints, dampers, n_active, turn):
    """Find the joints to sweep after the first turn: those of blocks stirred in the turn before. Returns how many."""
    blocks, active, awake, stirred = joints.blocks, dampers.active, dampers.awake, dampers.stirred
    found = 0
    for i in range(n_active):
        joint = np.uint64(active[i])
        if stirred[blocks[joint, 0]] == turn - 1 or stirred[blocks[joint, 1]] == turn - 1:
            awake[found] = joint
            found += 1
    return found


@inline
def meet_in_plane(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation):
    """Determine states of all points before the kick; rows of `gains` for those that touch, of joint j from packed[j]
    on.

    Puts the impulses of the step before, as far as they may go on, into `pushes`, and adds the forces of Maxwell
    elements to `forces`. Returns how many points have met.
    """
    blocks, starts, kns, kss, frames = joints.blocks, joints.starts, joints.kn, joints.ks, joints.frames
    normals, memory, slips = contacts.normal, contacts.memory, contacts.slip
    positions, velocities = bodies.positions, bodies.velocities
    viscosity, rates, rows, holders = dampers.viscosity, dampers.rates, dampers.gains, dampers.holders
    states, seen, first, pushes = dampers.states, dampers.slips, dampers.first, dampers.pushes
    motions, lifts = dampers.motions, dampers.lifts
    pushes[:] = 0.0
    elements, d, n_met, n_rows, n_active = dampers.elements, len(like), 0, 0, 0
    for number in range(blocks.shape[0]):
        joint = np.uint64(number)
        begin_joint(dampers, joint, n_rows)
        low, high, touched = starts[joint], starts[number + 1], False
        for p in range(low, high):
            point = np.uint64(p)
            if normals[point] != 0.0:
                touched = True
            elif states[point] != OPEN:
                forget(states, memory, point, first)
        if not touched:
            continue
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        half, masses = 0.5 * viscosity[joint] * dt, inverse_masses[a, 0] + inverse_masses[b, 0]
        turning = (bodies.mobilities[a, 0], bodies.mobilities[b, 0])
        xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
        spin_a, spin_b = load(velocities, a, d, like_rotation), load(velocities, b, d, like_rotation)
        relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
        pushed_a, pushed_b = load(pushes, a, 0, like), load(pushes, b, 0, like)
        turned_a, turned_b = load(pushes, a, d, like_rotation), load(pushes, b, d, like_rotation)
        for p in range(low, high):
            point = np.uint64(p)
            if normals[point] == 0.0:
                continue
            met, closed = touch(states, seen, slips, point)
            slipping = states[point] == SLIPS
            frame = load_frame(frames, point, like)
            reach_a, reach_b = reach_of(joints, point, 0, xa, like), reach_of(joints, point, 1, xb, like)
            put_motions(motions, lifts, dampers.strained, bodies, point, 0, a, arm_of(frame, reach_a))
            put_motions(motions, lifts, dampers.strained, bodies, point, 1, b, arm_of(frame, reach_b))
            moved = plus_modes(motions, velocities, point, a, b, relative)
            opening, sliding = rates_at(frame, reach_a, reach_b, moved, spin_a, spin_b)
            share = 1.0
            if met:
                n_met += 1
                dampers.met[joint] = 1
            if met and opening * dt < 0.0:  # it closed a while ago, and acts for half a step from now
                closed = closed_share(contacts.gaps[point], opening, dt)
                share = 0.5 + closed
            if half > 0.0:
                weight, least = share * half, least_of(normals[point], dt)
                row = np.uint64(n_rows)
                n_rows += 1
                holders[row] = point
                store(rows, row, NORMAL, frame[0])
                rows[row, LEVERS_A], rows[row, LEVERS_A + 1] = reach_a[0][0], reach_a[1][0]
                rows[row, LEVERS_B], rows[row, LEVERS_B + 1] = reach_b[0][0], reach_b[1][0]
                levers, more = (reach_a[0][0], reach_b[0][0]), mobility_along(motions, lifts, point, frame[0], 0.0)
                _put_turn(rows, row, 0, levers, masses, turning, weight * kns[point], opening, more)
                levers, more = (reach_a[1][0], reach_b[1][0]), mobility_along(motions, lifts, point, frame[1], 0.0)
                aside = 0.0 if slipping else weight * kss[point]
                _put_turn(rows, row, 1, levers, masses, turning, aside, sliding[0], more)
                push = max(memory[point, first], least)
                along = scale(0.0 if slipping else 1.0, load(memory, point, first + 1, sliding))
                rows[row, IMPULSE] = push
                store(rows, row, IMPULSE + 1, along)
                rows[row, LEAST] = least
                force = compose(frame, push, along, scale(0.0, like))
                pushed_a, pushed_b = axpy(-1.0, force, pushed_a), axpy(1.0, force, pushed_b)
                turned_a = axpy(-1.0, torque_at(reach_a, force, push, along), turned_a)
                turned_b = axpy(1.0, torque_at(reach_b, force, push, along), turned_b)
                push_modes(motions, pushes, point, a, b, force)
            if elements.shape[0] > 0:
                rates[point, 0] = opening
                store(rates, point, 1, sliding)
                stiffness, reaches = (kns[point], kss[point]), (reach_a, reach_b)
                pull(elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like)
        store(pushes, a, 0, pushed_a)
        store(pushes, a, d, turned_a)
        store(pushes, b, 0, pushed_b)
        store(pushes, b, d, turned_b)
        n_active = end_joint(dampers, joint, n_rows, n_active)
    dampers.packed[blocks.shape[0]], dampers.active[blocks.shape[0]] = n_rows, n_active
    return n_met


def pull(elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like):
    """Add forces of the Maxwell elements of a point after the step before to its blocks; none: not compiled."""
    if elements.ndim > 1:
        _pull(elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like)


@overload(pull)
def _pulled(elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like):
    if elements.ndim > 1:
        return _pull
    return lambda elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like: None


@inline
def _pull(elements, contacts, bodies, dampers, a, b, point, frame, reaches, stiffness, closed, like):
    """Add forces of the Maxwell elements of a point after the step before to those of its blocks."""
    first, memory, forces, d = dampers.first, contacts.memory, bodies.forces, len(like)
    state, pressed = dampers.states[point], contacts.normal[point]
    _relax(memory, dampers.rates, elements, state, pressed, stiffness, closed, point, first, d)
    normal, shear = 0.0, scale(0.0, like[1:])
    for e in range(elements.shape[0]):
        column = first + d * (e + 1)
        normal += memory[point, column]
        shear = axpy(1.0, load(memory, point, column + 1, shear), shear)
    force = compose(frame, normal, shear, scale(0.0, like))
    add_at(forces, a, 0, force, -1.0)
    add_at(forces, b, 0, force, 1.0)
    add_at(forces, a, d, torque_at(reaches[0], force, normal, shear), -1.0)
    add_at(forces, b, d, torque_at(reaches[1], force, normal, shear), 1.0)
    push_modes(dampers.motions, forces, point, a, b, force)


@inline
def _relax(memory, rates, elements, state, pressed, stiffness, closed, point, first, d):
    """Relax the Maxwell forces of a point over a step at constant rates; with its own force they do not pull.

    closed: share of the step in which the point was closed; what has just met or begun held nothing before.
    """
    total = 0.0
    for e in range(elements.shape[0]):
        keep, gain = elements[e, 0], closed * elements[e, 1]
        column = first + d * (e + 1)
        for k in range(d):
            held = keep * memory[point, column + k] - gain * stiffness[min(k, 1)] * rates[point, k]
            # Friction carries what slips: an element that held on to its force could push it on.
            memory[point, column + k] = 0.0 if k > 0 and state == SLIPS else held
        total += memory[point, column]
    if total < -pressed and pressed >= 0.0:
        for e in range(elements.shape[0]):
            memory[point, first + d * (e + 1)] *= -pressed / total


@inline
def _sweep(joints, contacts, bodies, inverse_masses, dampers, swept, n, turn, backwards, like, like_rotation):
    """Relax the impulses of n joints in one sweep; backwards: which are then kept with the points, too."""
    blocks, velocities, mobilities, memory = joints.blocks, bodies.velocities, bodies.mobilities, contacts.memory
    rows, packed, holders, first = dampers.gains, dampers.packed, dampers.holders, dampers.first
    d, motions = len(like), dampers.motions
    for i in range(n):
        number = swept[n - 1 - i if backwards else i]
        joint = np.uint64(number)
        low, high, change = packed[joint], packed[number + 1], 0.0
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        mass_a, mass_b = inverse_masses[a, 0], inverse_masses[b, 0]
        turning_a, turning_b = mobilities[a, 0], mobilities[b, 0]
        va, vb = load(velocities, a, 0, like), load(velocities, b, 0, like)
        spin_a, spin_b = velocities[a, d], velocities[b, d]
        for j in range(high - low):
            row = np.uint64(high - 1 - j if backwards else low + j)
            x, y = rows[row, NORMAL], rows[row, NORMAL + 1]
            across_a, along_a = rows[row, LEVERS_A], rows[row, LEVERS_A + 1]
            across_b, along_b = rows[row, LEVERS_B], rows[row, LEVERS_B + 1]
            push, shear = rows[row, IMPULSE], rows[row, IMPULSE + 1]
            # What needs no velocity comes first, so that little is left to wait for from one point to the next.
            held = rows[row, KEEP] * push - rows[row, GIVEN]
            held_along = rows[row, KEEP + 1] * shear - rows[row, GIVEN + 1]
            u, v = plus_modes(motions, velocities, holders[row], a, b, axpy(-1.0, va, vb))
            opening = (x * u + y * v) + (across_b * spin_b - across_a * spin_a)
            sliding = (x * v - y * u) + (along_b * spin_b - along_a * spin_a)
            new = max(held - rows[row, GAIN] * opening, rows[row, LEAST])
            new_along = held_along - rows[row, GAIN + 1] * sliding
            rows[row, IMPULSE], rows[row, IMPULSE + 1] = new, new_along
            if backwards:
                point = np.uint64(holders[row])
                memory[point, first], memory[point, first + 1] = new, new_along
            more, more_along = new - push, new_along - shear
            change = max(change, max(abs(more), abs(more_along)))
            va = (
                (va[0] + mass_a * y * more_along) - mass_a * x * more,
                (va[1] - mass_a * x * more_along) - mass_a * y * more,
            )
            vb = (
                (vb[0] - mass_b * y * more_along) + mass_b * x * more,
                (vb[1] + mass_b * x * more_along) + mass_b * y * more,
            )
            spin_a = (spin_a - turning_a * along_a * more_along) - turning_a * across_a * more
            spin_b = (spin_b + turning_b * along_b * more_along) + turning_b * across_b * more
            force = (x * more - y * more_along, y * more + x * more_along)
            push_modes(dampers.lifts, velocities, holders[row], a, b, force)
        store(velocities, a, 0, va)
        velocities[a, d] = spin_a
        store(velocities, b, 0, vb)
        velocities[b, d] = spin_b
        stir(dampers, joint, a, b, turn, change)


def make_turns(sweep: Callable) -> Callable:
    """Make the solver of all impulses by one kind of sweep, each to and fro; after the first where impulses still
    change.
    """

    @inline
    def take_turns(joints, contacts, bodies, inverse_masses, dampers, turns, like, like_rotation):
        """Sweep all impulses up to so many times, on the velocities after the kick."""
        dampers.stirred[:] = 0
        swept, n_active = dampers.active, dampers.active[-1]
        n = n_active
        for turn in range(1, turns + 1):
            if turn > 1:
                swept, n = dampers.awake, waken(joints, dampers, n_active, turn)
            if n == 0:
                break
            sweep(joints, contacts, bodies, inverse_masses, dampers, swept, n, turn, False, like, like_rotation)
            sweep(joints, contacts, bodies, inverse_masses, dampers, swept, n, turn, True, like, like_rotation)

    return named(take_turns, sweep)


turns_in_plane = make_turns(_sweep)


@inline
def resist_in_plane(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation):
    """Apply the impulses of all dashpots in the plane to the velocities after the kick."""
    velocities, mobilities, pushes, d = bodies.velocities, bodies.mobilities, dampers.pushes, len(like)
    for block in range(velocities.shape[0]):
        for k in range(d):
            velocities[block, k] += inverse_masses[block, k] * pushes[block, k]
        push = load(pushes, block, d, like_rotation)
        add_at(velocities, block, d, spun(load_mobility(mobilities, block, like), push), 1.0)
        give_pushes(dampers.motions, dampers.strained, velocities, pushes, block)
    turns_in_plane(joints, contacts, bodies, inverse_masses, dampers, turns, like, like_rotation)


def book_elements(elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation):
    """Add the work of Maxwell elements in this step to the ledger, by the mean rates over it; none: not compiled."""
    if elements.ndim > 1:
        _book_elements(elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation)


@overload(book_elements)
def _booked(elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation):
    if elements.ndim > 1:
        return _book_elements
    return lambda elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation: None


@inline
def _book_elements(elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation):
    """Add the work of Maxwell elements in this step to the ledger."""
    blocks, starts, frames, memory = joints.blocks, joints.starts, joints.frames, contacts.memory
    positions, velocities = bodies.positions, bodies.velocities
    rates, states, first, n_elements = dampers.rates, dampers.states, dampers.first, elements.shape[0]
    d, taken = len(like), 0.0
    for number in range(blocks.shape[0]):
        joint = np.uint64(number)
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        for p in range(starts[joint], starts[number + 1]):
            point = np.uint64(p)
            if states[point] == OPEN:
                continue
            spin_a, spin_b = load(velocities, a, d, like_rotation), load(velocities, b, d, like_rotation)
            relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
            relative = plus_modes(dampers.motions, velocities, point, a, b, relative)
            reach_a = reach_of(joints, point, 0, load(positions, a, 0, like), like)
            reach_b = reach_of(joints, point, 1, load(positions, b, 0, like), like)
            opening, sliding = rates_at(load_frame(frames, point, like), reach_a, reach_b, relative, spin_a, spin_b)
            opening = 0.5 * (opening + rates[point, 0])
            sliding = scale(0.5, axpy(1.0, load(rates, point, 1, sliding), sliding))
            for e in range(n_elements):
                column = first + d * (e + 1)
                taken -= memory[point, column] * opening + dot(load(memory, point, column + 1, sliding), sliding)
    ledger[MAXWELL] += dt * taken


@inline
def book_supports(joints, contacts, bodies, old, inverse_masses, dampers, ledger, like, like_rotation):
    """Add the work of moving supports through dashpots to the ledger: theirs, and what is lost there. old: velocities
    before the step.
    """
    blocks, starts, frames, memory = joints.blocks, joints.starts, joints.frames, contacts.memory
    positions, velocities = bodies.positions, bodies.velocities
    states, first, d, work = dampers.states, dampers.first, len(like), 0.0
    for number in range(blocks.shape[0]):
        joint = np.uint64(number)
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        if inverse_masses[a, 0] != 0.0 and inverse_masses[b, 0] != 0.0:
            continue
        support = a if inverse_masses[a, 0] == 0.0 else b
        moved = axpy(1.0, load(old, support, 0, like), load(velocities, support, 0, like))
        turned = axpy(1.0, load(old, support, d, like_rotation), load(velocities, support, d, like_rotation))
        none = scale(0.0, turned)
        relative = scale(-0.5 if support == a else 0.5, moved)
        spin_a, spin_b = (scale(0.5, turned), none) if support == a else (none, scale(0.5, turned))
        for p in range(starts[joint], starts[number + 1]):
            point = np.uint64(p)
            if states[point] == OPEN:
                continue
            reach_a = reach_of(joints, point, 0, load(positions, a, 0, like), like)
            reach_b = reach_of(joints, point, 1, load(positions, b, 0, like), like)
            opening, sliding = rates_at(load_frame(frames, point, like), reach_a, reach_b, relative, spin_a, spin_b)
            work -= memory[point, first] * opening + dot(load(memory, point, first + 1, sliding), sliding)
    ledger[SUPPORT] += work
    ledger[DASHPOT] += work
