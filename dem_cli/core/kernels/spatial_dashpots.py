"""Dashpots of joints in space: gains of impulses, packed point by point, so that sweeps read little.

An impulse J gives up S (w₀ + w + C⁻¹ J), S = (C⁻¹ + K)⁻¹ along the axes of the world, K rates by impulses at the point,
C half of damping × step; it goes no lower than its bound by moving along S n. A point that slips has S = s n nᵀ. While
sweeps last, velocities are sums of those before and after the step, so that w₀ + w is one rate and nothing else.
Joints that hold their geometry (spatial_forces.py) keep their rows while the same points touch, stick and slip.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.dashpots import (
    OPEN,
    SLIPS,
    STICKS,
    closed_share,
    forget,
    least_of,
    make_turns,
    meet_in_plane,
    pull,
    resist_in_plane,
    stir,
    touch,
)
from dem_cli.core.kernels.dashpots import WIDTH as PLANAR_WIDTH
from dem_cli.core.kernels.deformation.strain_dashpots import (
    give_pushes,
    mobility_of,
    plus_modes,
    push_modes,
    put_motions,
    with_mobility,
)
from dem_cli.core.kernels.jit import always_inline, inline, overload
from dem_cli.core.kernels.joint_plane import load_mobility, moment, rates_at, spun, sweep
from dem_cli.core.kernels.vec import add_at, axpy, components, compose, dot, load, load_frame, norm, scale, store

# Columns of Dampers.gains: n, arm from a, J, S (xx xy xz yy yz zz), C⁻¹ = EVENLY + ACROSS n nᵀ, least J·n.
NORMAL, ARM, IMPULSE, GAIN, EVENLY, ACROSS, LEAST = 0, 3, 6, 9, 15, 16, 17
WIDTH = 18
GAINS = {2: PLANAR_WIDTH, 3: WIDTH}  # columns by dimension


def meet(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation):
    """Determine states and gains of all points before the kick, and the impulses before; returns how many have met."""
    found = meet_in_plane if len(like) == 2 else meet_in_space
    return found(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation)


@overload(meet)
def _meet(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation):
    found = meet_in_plane if len(like) == 2 else meet_in_space
    return lambda joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation: found(
        joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation
    )


def resist(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation):
    """Apply the impulses of all dashpots to the velocities after the kick, starting from those of the step before.

    turns: pairs of sweeps, to and fro, at most. One over all joints is enough where the step before is a good guess;
    those after it are over joints of blocks that the one before has stirred (`stir`), beginning where points have met.
    """
    found = resist_in_plane if len(like) == 2 else resist_in_space
    found(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation)


@overload(resist)
def _resist(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation):
    found = resist_in_plane if len(like) == 2 else resist_in_space
    return lambda joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation: found(
        joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation
    )


@always_inline
def _rates_by_impulses(arm, mobility):
    """Rate at the tip of an arm by a unit impulse there, of the turning of its block alone: xx xy xz yy yz zz."""
    x, y, z = arm
    at_x = axpy(z, mobility[1], scale(-y, mobility[2]))
    at_y = axpy(x, mobility[2], scale(-z, mobility[0]))
    at_z = axpy(y, mobility[0], scale(-x, mobility[1]))
    return (
        z * at_x[1] - y * at_x[2], z * at_y[1] - y * at_y[2], z * at_z[1] - y * at_z[2],
        x * at_y[2] - z * at_y[0], x * at_z[2] - z * at_z[0], y * at_z[0] - x * at_z[1],
    )  # fmt: skip


@always_inline
def put_gains(rows, row, normal, arms, masses, mobilities, viscous, slips, more=()):
    """Store gain and inverse viscosity of a point, columns GAIN, EVENLY and ACROSS.

    viscous: C, half of damping × step across and along the joint [kg]; masses: sum of both inverse masses. more: rates
    by impulses of blocks that deform, beside those of rigid ones.
    """
    a, b = _rates_by_impulses(arms[0], mobilities[0]), _rates_by_impulses(arms[1], mobilities[1])
    across, along = viscous
    x, y, z = normal
    rigid = (
        masses + (a[0] + b[0]),
        a[1] + b[1],
        a[2] + b[2],
        masses + (a[3] + b[3]),
        a[4] + b[4],
        masses + (a[5] + b[5]),
    )
    xx, xy, xz, yy, yz, zz = with_mobility(rigid, more)
    if slips or along == 0.0:
        around = x * (xx * x + 2.0 * xy * y) + y * (yy * y + 2.0 * yz * z) + z * (zz * z + 2.0 * xz * x)
        share = 1.0 / (1.0 / across + around)
        evenly, more = 0.0, 1.0 / across
        sxx, sxy, sxz, syy, syz, szz = x * x, x * y, x * z, y * y, y * z, z * z
    else:
        evenly = 1.0 / along
        more = 1.0 / across - evenly
        xx, xy, xz = xx + evenly + more * x * x, xy + more * x * y, xz + more * x * z
        yy, yz, zz = yy + evenly + more * y * y, yz + more * y * z, zz + evenly + more * z * z
        sxx, sxy, sxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        syy, syz, szz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
        share = 1.0 / (xx * sxx + xy * sxy + xz * sxz)
    store(rows, row, GAIN, (share * sxx, share * sxy, share * sxz))
    store(rows, row, GAIN + 3, (share * syy, share * syz, share * szz))
    rows[row, EVENLY], rows[row, ACROSS] = evenly, more


@always_inline
def _gained(rows, row, vector):
    """Multiply the gain S of a row by a vector."""
    x, y, z = load(rows, row, GAIN, vector)
    yy, yz, zz = load(rows, row, GAIN + 3, vector)
    return dot((x, y, z), vector), dot((y, yy, yz), vector), dot((z, yz, zz), vector)


@always_inline
def given_up(rows, row, normal, impulse, rate):
    """Relax the impulse of a point by its error at the rate w₀ + w; across the joint not below its bound."""
    error = axpy(rows[row, ACROSS] * dot(normal, impulse), normal, axpy(rows[row, EVENLY], impulse, rate))
    free = axpy(-1.0, _gained(rows, row, error), impulse)
    short = rows[row, LEAST] - dot(normal, free)
    if short <= 0.0:
        return free
    way = _gained(rows, row, normal)
    return axpy(short / dot(normal, way), way, free)


@always_inline
def _goes_on(joints, contacts, dampers, joint):
    """Test whether the rows of a joint are still valid: geometry is held, the same points touch, stick and slip.

    Points that have met in the step before act for all of this one.
    """
    states, first, last = dampers.states, dampers.packed[joint], dampers.lasts[joint]
    if last - first != joints.held[joint] or dampers.met[joint] != 0:
        return False
    for row in range(first, last):
        point = np.uint64(dampers.holders[row])
        state = STICKS if contacts.slip[point] == dampers.slips[point] else SLIPS
        if contacts.normal[point] == 0.0 or states[point] != state:
            return False
    return True


@always_inline
def _touching(held):
    """Return the number of touching points of a joint, whether its geometry is held or was just measured."""
    return held if held >= 0 else -1 - held


@inline
def _make_room(joints, dampers):
    """Restart the rows of all joints from the first, where new ones have no room any more."""
    needed = dampers.packed[-1]
    for joint in range(joints.held.shape[0]):
        needed += _touching(joints.held[joint])
    if needed > dampers.gains.shape[0]:
        dampers.packed[:], dampers.lasts[:], dampers.rooms[:] = 0, 0, 0


@always_inline
def _first_row(joints, dampers, joint):
    """Find the first row for a joint whose rows are made anew: where they were, or behind all others."""
    packed, n = dampers.packed, _touching(joints.held[joint])
    if n > dampers.rooms[joint]:
        packed[joint], dampers.rooms[joint] = packed[-1], n
        packed[-1] += n
    return packed[joint]


@always_inline
def _push_on(joints, contacts, bodies, dampers, dt, joint, a, b, like):
    """Apply impulses of rows that go on, as far as they may, to the blocks."""
    rows, holders, slips, seen = dampers.gains, dampers.holders, contacts.slip, dampers.slips
    pushed, turned = scale(0.0, like), scale(0.0, like)
    for number in range(dampers.packed[joint], dampers.lasts[joint]):
        row = np.uint64(number)
        point = np.uint64(holders[row])
        seen[point] = slips[point]
        normal, impulse = load(rows, row, NORMAL, like), load(rows, row, IMPULSE, like)
        least = least_of(contacts.normal[point], dt)
        rows[row, LEAST] = least
        short = least - dot(normal, impulse)
        if short > 0.0:
            impulse = axpy(short, normal, impulse)
            store(rows, row, IMPULSE, impulse)
        pushed = axpy(1.0, impulse, pushed)
        turned = axpy(1.0, moment(load(rows, row, ARM, like), impulse), turned)
    apart = axpy(-1.0, load(bodies.positions, b, 0, like), load(bodies.positions, a, 0, like))
    add_at(dampers.pushes, a, 0, pushed, -1.0)
    add_at(dampers.pushes, b, 0, pushed, 1.0)
    add_at(dampers.pushes, a, 3, turned, -1.0)
    add_at(dampers.pushes, b, 3, axpy(1.0, moment(apart, pushed), turned), 1.0)


@inline
def meet_in_space(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation):
    """Determine states and gains of all points in space before the kick; rows of joint j from packed[j] up to lasts[j].
    Those that go on are not made anew.
    """
    blocks, starts, kns, kss, frames = joints.blocks, joints.starts, joints.kn, joints.ks, joints.frames
    normals, memory, slips = contacts.normal, contacts.memory, contacts.slip
    positions, velocities = bodies.positions, bodies.velocities
    viscosity, rates, rows, holders = dampers.viscosity, dampers.rates, dampers.gains, dampers.holders
    states, seen, first, pushes = dampers.states, dampers.slips, dampers.first, dampers.pushes
    pushes[:] = 0.0
    motions, lifts = dampers.motions, dampers.lifts
    elements, packed, lasts, n_met, n_active = dampers.elements, dampers.packed, dampers.lasts, 0, 0
    _make_room(joints, dampers)
    for number in range(blocks.shape[0]):
        joint = np.uint64(number)
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        if elements.shape[0] == 0 and _goes_on(joints, contacts, dampers, joint):
            if lasts[joint] > packed[joint]:
                _push_on(joints, contacts, bodies, dampers, dt, joint, a, b, like)
                dampers.active[n_active] = number
                n_active += 1
            continue
        half, masses = 0.5 * viscosity[joint] * dt, inverse_masses[a, 0] + inverse_masses[b, 0]
        dampers.met[joint] = 0
        n_rows = _first_row(joints, dampers, joint)
        mobilities = (load_mobility(bodies.mobilities, a, like), load_mobility(bodies.mobilities, b, like))
        xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
        spin_a, spin_b = load(velocities, a, 3, like_rotation), load(velocities, b, 3, like_rotation)
        relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
        pushed, turned_a, turned_b = scale(0.0, like), scale(0.0, like), scale(0.0, like)
        touched = False
        for p in range(starts[joint], starts[number + 1]):
            point = np.uint64(p)
            if normals[point] == 0.0:
                if states[point] != OPEN:
                    forget(states, memory, point, first)
                continue
            touched = True
            met, closed = touch(states, seen, slips, point)
            frame, place = load_frame(frames, point, like), load(joints.points, point, 0, like)
            arms = (axpy(-1.0, xa, place), axpy(-1.0, xb, place))
            put_motions(motions, lifts, dampers.strained, bodies, point, 0, a, arms[0])
            put_motions(motions, lifts, dampers.strained, bodies, point, 1, b, arms[1])
            share = 1.0
            if met or elements.shape[0] > 0:
                moved = plus_modes(motions, velocities, point, a, b, relative)
                opening, sliding = rates_at(frame, arms[0], arms[1], moved, spin_a, spin_b)
                rates[point, 0] = opening
                store(rates, point, 1, sliding)
                if met:
                    n_met += 1
                    dampers.met[joint] = 1
                if met and opening * dt < 0.0:
                    closed = closed_share(contacts.gaps[point], opening, dt)
                    share = 0.5 + closed
            if half > 0.0:
                slipping, least = states[point] == SLIPS, least_of(normals[point], dt)
                along = scale(0.0 if slipping else 1.0, load(memory, point, first + 1, like[1:]))
                impulse = compose(frame, max(memory[point, first], least), along, scale(0.0, like))
                row = np.uint64(n_rows)
                n_rows += 1
                holders[row] = point
                store(rows, row, NORMAL, frame[0])
                store(rows, row, ARM, arms[0])
                store(rows, row, IMPULSE, impulse)
                rows[row, LEAST] = least
                viscous = (share * half * kns[point], share * half * kss[point])
                more = mobility_of(motions, lifts, point)
                put_gains(rows, row, frame[0], arms, masses, mobilities, viscous, slipping, more)
                push_modes(motions, pushes, point, a, b, impulse)
                pushed = axpy(1.0, impulse, pushed)
                turned_a = axpy(1.0, moment(arms[0], impulse), turned_a)
                turned_b = axpy(1.0, moment(arms[1], impulse), turned_b)
            if elements.shape[0] > 0:
                stiffness = (kns[point], kss[point])
                pull(elements, contacts, bodies, dampers, a, b, point, frame, arms, stiffness, closed, like)
        if touched:
            add_at(pushes, a, 0, pushed, -1.0)
            add_at(pushes, b, 0, pushed, 1.0)
            add_at(pushes, a, 3, turned_a, -1.0)
            add_at(pushes, b, 3, turned_b, 1.0)
        lasts[joint] = n_rows
        if n_rows > packed[joint]:
            dampers.active[n_active] = number
            n_active += 1
    dampers.active[blocks.shape[0]] = n_active
    return n_met


@inline
def _sweep_in_space(joints, contacts, bodies, inverse_masses, dampers, swept, n, turn, backwards, like, like_rotation):
    """Relax the impulses of n joints in space in one sweep; backwards: which are then kept with the points, too."""
    blocks, frames, positions, velocities = joints.blocks, joints.frames, bodies.positions, bodies.velocities
    rows, packed, holders, memory, first = (
        dampers.gains, dampers.packed, dampers.holders, contacts.memory, dampers.first
    )  # fmt: skip
    motions = dampers.motions
    for i in range(n):
        number = swept[n - 1 - i if backwards else i]
        joint = np.uint64(number)
        low, high, change = packed[joint], dampers.lasts[joint], 0.0
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        mass_a, mass_b = inverse_masses[a, 0], inverse_masses[b, 0]
        mobility_a = load_mobility(bodies.mobilities, a, like)
        mobility_b = load_mobility(bodies.mobilities, b, like)
        xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
        apart = axpy(-1.0, xb, xa)
        va, vb = load(velocities, a, 0, like), load(velocities, b, 0, like)
        spin_a, spin_b = load(velocities, a, 3, like_rotation), load(velocities, b, 3, like_rotation)
        for j in range(high - low):
            row = np.uint64(high - 1 - j if backwards else low + j)
            normal, impulse = load(rows, row, NORMAL, like), load(rows, row, IMPULSE, like)
            arm_a = load(rows, row, ARM, like)
            arm_b = axpy(1.0, apart, arm_a)
            turning = axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b))
            rate = plus_modes(motions, velocities, holders[row], a, b, axpy(1.0, turning, axpy(-1.0, va, vb)))
            new = given_up(rows, row, normal, impulse, rate)
            store(rows, row, IMPULSE, new)
            gain = axpy(-1.0, impulse, new)
            change = max(change, norm(gain))
            va, vb = axpy(-mass_a, gain, va), axpy(mass_b, gain, vb)
            push_modes(dampers.lifts, velocities, holders[row], a, b, gain)
            spin_a = axpy(-1.0, spun(mobility_a, moment(arm_a, gain)), spin_a)
            spin_b = axpy(1.0, spun(mobility_b, moment(arm_b, gain)), spin_b)
            if backwards:
                point = np.uint64(holders[row])
                push, along = components(load_frame(frames, point, like), new)
                memory[point, first] = max(push, rows[row, LEAST])
                store(memory, point, first + 1, scale(0.0 if rows[row, EVENLY] == 0.0 else 1.0, along))
        store(velocities, a, 0, va)
        store(velocities, a, 3, spin_a)
        store(velocities, b, 0, vb)
        store(velocities, b, 3, spin_b)
        stir(dampers, joint, a, b, turn, change)


turns_in_space = make_turns(_sweep_in_space)


@inline
def resist_in_space(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation):
    """Apply the impulses of all dashpots in space to the velocities; bodies.means: velocities before the step."""
    if dampers.active[-1] == 0:
        return
    velocities, pushes, old = bodies.velocities, dampers.pushes, bodies.means
    n_dof = velocities.shape[1]
    for block in range(velocities.shape[0]):
        push = load(pushes, block, 3, like_rotation)
        turning = spun(load_mobility(bodies.mobilities, block, like), push)
        for k in range(3):
            i = block * n_dof + k
            velocities[block, k] += old[i] + inverse_masses[block, k] * pushes[block, k]
            velocities[block, 3 + k] += old[i + 3]
        for k in range(6, n_dof):
            velocities[block, k] += old[block * n_dof + k]
        add_at(velocities, block, 3, turning, 1.0)
        give_pushes(dampers.motions, dampers.strained, velocities, pushes, block)
    turns_in_space(joints, contacts, bodies, inverse_masses, dampers, turns, like, like_rotation)
    for block in range(velocities.shape[0]):
        for k in range(n_dof):
            velocities[block, k] -= old[block * n_dof + k]
