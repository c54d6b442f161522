"""Time steps in one compiled call: contact forces, load, damping, velocities, positions.

Leapfrog: positions and forces at whole steps, velocities half a step behind. In quasi-static runs
the step is 1 and the masses are fictitious. The ledger sums what each group of forces really did,
force × mean velocity, so that the change of kinetic energy equals their sum to round-off.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dem_cli.core.kernels.deformation.quadratic import bend, resist_bending
from dem_cli.core.kernels.deformation.uniform_strain import resist, stretch
from dem_cli.core.kernels.jit import inline, kernel, named
from dem_cli.core.kernels.records import (
    CONTACT,
    CREEP,
    DAMP,
    DAMP_CHANGE,
    DAMPING,
    DEAD_FACTOR,
    EXTERNAL,
    FIRE,
    FIRE_MIX,
    FIRE_START,
    FRICTION,
    GUIDED,
    JOLT,
    LIVE,
    LIVE_FACTOR,
    MEAN_LOAD,
    RATE,
    SINCE_UPHILL,
    SUPPORT,
    TILT_CREEP,
    TILT_GUIDED,
    TRAVEL_LIMIT,
    UNBALANCED,
)
from dem_cli.core.kernels.vec import in_a_row


@inline
def along_live_load(forces, dead_loads, live_loads, inverse_masses, dead):
    """Force along the live load, q·M⁻¹(F + f0), which a live factor λ brings to zero: q·M⁻¹(F + f0 + λ q) = 0."""
    total = 0.0
    for i in range(forces.size):
        total += live_loads[i] * inverse_masses[i] * (forces[i] + dead * dead_loads[i])
    return total


@inline
def carry(along, stiffness, tilts, control):
    """Compute the live factor that balances the forces along the live load; a tilting table turns gravity by θ: dead
    cos θ + live sin θ.
    """
    factor = -along / stiffness
    if tilts:
        factor = min(max(factor, -1.0), 1.0)
        control[DEAD_FACTOR] = math.sqrt(1.0 - factor * factor)
    control[LIVE_FACTOR] = factor


@inline
def _sign(x):
    """Return the sign of a number, −1, 0 or 1; without a branch."""
    return (1.0 if x > 0.0 else 0.0) - (1.0 if x < 0.0 else 0.0)


@inline
def local_drag(unbalanced, previous, velocity, damp, damp_change):
    """Compute the local damping force against the motion: (α sgn v − α' sgn ΔF)|F|, local and combined damping (Cundall
    1987).

    The part with the change of force damps vibrations of a block that drifts, where sgn v cannot.
    """
    return abs(unbalanced) * (damp * _sign(velocity) - damp_change * _sign(unbalanced - previous))


@inline
def driven_flow(
    velocities, forces, previous, dead_loads, live_loads, inverse_masses, dead, live, damp, damp_change, dt
):  # fmt: skip
    """Velocity along the live load, q·v, after the step with damping, before the impulse that sets the rate."""
    flow = 0.0
    for i in range(forces.size):
        q = live_loads[i]
        if q != 0.0:
            unbalanced = forces[i] + dead * dead_loads[i] + live * q
            drag = local_drag(unbalanced, previous[i], velocities[i], damp, damp_change)
            flow += q * (velocities[i] + dt * inverse_masses[i] * (unbalanced - drag))
    return flow


@inline
def steered_flow(velocities, live_loads):
    """Compute the velocity along the live load, q·v. Where velocities are steered (FIRE) what drives them has no
    component along the live load.
    """
    flow = 0.0
    for i in range(live_loads.size):
        flow += live_loads[i] * velocities[i]
    return flow


@inline
def powers(velocities, forces, dead_loads, live_loads, inverse_masses, dead, live):
    """Compute the powers F·v, v·Mv and F·M⁻¹F, by which FIRE steers."""
    power = speed2 = force2 = 0.0
    for i in range(forces.size):
        inverse = inverse_masses[i]
        if inverse > 0.0:
            force = forces[i] + dead * dead_loads[i] + live * live_loads[i]
            power += force * velocities[i]
            speed2 += velocities[i] * velocities[i] / inverse
            force2 += force * force * inverse
    return power, speed2, force2


@inline
def steering(power, speed2, force2, control):
    """Steer velocities by FIRE (Bitzek et al. 2006) in the metric of the masses: v <- keep v + steer M⁻¹F. Motion
    uphill is stopped.
    """
    if power <= 0.0 or force2 == 0.0:
        control[SINCE_UPHILL] = 0.0
        control[FIRE_MIX] = control[FIRE_START]
        return 0.0, 0.0
    mix = control[FIRE_MIX]
    control[SINCE_UPHILL] += 1.0
    if control[SINCE_UPHILL] > 5.0:
        control[FIRE_MIX] *= 0.99
    return 1.0 - mix, mix * math.sqrt(speed2 / force2)


@inline
def _clip(x, limit):
    """Limit x to between −limit and limit."""
    return limit if x > limit else -limit if x < -limit else x


@inline
def kick(
    velocities, forces, previous, dead_loads, live_loads, inverse_masses, speed_limits, means, drags,
    dead, live, damp, damp_change, keep, steer, impulse, dt,
):  # fmt: skip
    """Update velocities from forces, with damping; leaves mean velocities and damping forces for `book`.

    Plain loops without sums, so that the compiler works on several degrees of freedom at once.
    """
    if keep == 1.0:
        for i in range(forces.size):
            old, inverse = velocities[i], inverse_masses[i]
            applied = dead * dead_loads[i] + live * live_loads[i]
            unbalanced = forces[i] + applied if inverse > 0.0 else 0.0
            drag = local_drag(unbalanced, previous[i], old, damp, damp_change)
            previous[i] = unbalanced
            free = old + inverse * (dt * (forces[i] - drag) + (dt * applied + impulse * live_loads[i]))
            new = _clip(free, speed_limits[i])
            velocities[i] = new
            means[i] = 0.5 * (old + new)
            drags[i] = drag + ((free - new) / (inverse * dt) if new != free else 0.0)
        return
    for i in range(forces.size):
        old, inverse = velocities[i], inverse_masses[i]
        if inverse == 0.0:
            means[i], drags[i] = old, 0.0
            continue
        applied = dead * dead_loads[i] + live * live_loads[i]
        unbalanced = forces[i] + applied
        drag = local_drag(unbalanced, previous[i], old, damp, damp_change)
        previous[i] = unbalanced
        pushed = dt * applied + impulse * live_loads[i]
        free = keep * old + inverse * (steer * unbalanced + dt * (forces[i] - drag) + pushed)
        new = _clip(free, speed_limits[i])
        velocities[i] = new
        means[i] = 0.5 * (old + new)
        drags[i] = drag + (((1.0 - keep) * old + free - new) / inverse - steer * unbalanced) / dt


@inline
def book(
    forces, dead_loads, live_loads, inverse_masses, means, drags, dead, live, impulse, dt, carried, ledger
):  # fmt: skip
    """Add the work of one step to the ledger (energy balance).

    Work is force × mean of the velocities of the two drifts around it, so that it adds up to force ×
    displacement; whatever steering, damping or a speed limit takes from the motion is booked as damping.
    """
    by_dead = by_live = contact = damping = support = 0.0
    for i in range(forces.size):
        mean = means[i]
        by_dead += dead_loads[i] * mean
        by_live += live_loads[i] * mean
        contact += forces[i] * mean
        damping += drags[i] * mean
    if carried:
        for i in range(forces.size):
            if inverse_masses[i] == 0.0:
                support -= forces[i] * means[i]
    given = (dt * live + impulse) * by_live
    ledger[EXTERNAL] += dt * dead * by_dead + given
    ledger[LIVE] += given
    ledger[CONTACT] += dt * (contact + support)  # of the free blocks alone
    ledger[DAMPING] += dt * damping
    ledger[SUPPORT] += dt * support


@inline
def mobility(live_loads, inverse_masses):
    """Compute the mobility along the live load: its velocity per unit of multiplier and time, all blocks free."""
    total = 0.0
    for i in range(live_loads.size):
        total += live_loads[i] * live_loads[i] * inverse_masses[i]
    return total


@inline
def is_carried(velocities, inverse_masses):
    """Test whether a support moves."""
    carried = False
    for i in range(velocities.size):
        carried = carried or (inverse_masses[i] == 0.0 and velocities[i] != 0.0)
    return carried


@inline
def largest_unbalanced(unbalanced, force_scales):
    """Compute the largest unbalanced force over its force scale."""
    largest = 0.0
    for i in range(unbalanced.size):
        largest = max(largest, abs(unbalanced[i]) * force_scales[i])
    return largest


def make_advance(
    contact_forces: Callable,
    drift: Callable,
    link_forces: Callable | None = None,
    strains: bool = False,
    moves: bool = False,
    bends: bool = False,
) -> Callable:
    """Make the compiled stepping loop for one contact loop, one way to move the blocks and the links of the model.

    strains: blocks deform; moves: on geometry that moves; bends: in quadratic modes as well.
    """
    linked, pull = link_forces is not None, link_forces or contact_forces  # what is not called is compiled away

    @kernel
    def advance(
        n_steps, mode, dt, bodies, shape, joints, geometry, contacts, links, loads, control, ledger, like,
        like_rotation,
    ):  # fmt: skip
        """Advance by up to n_steps; returns the steps done (fewer when a new detection is due)."""
        velocities, forces = in_a_row(bodies.velocities), in_a_row(bodies.forces)
        previous = in_a_row(bodies.unbalanced)
        dead_loads, live_loads = in_a_row(loads.dead), in_a_row(loads.live)
        inverse_masses, force_scales = in_a_row(loads.inverse_masses), in_a_row(loads.force_scales)
        speed_limits = in_a_row(loads.speed_limits)
        guided = mode in (GUIDED, TILT_GUIDED)
        creeps = guided or mode in (CREEP, TILT_CREEP)
        stiffness = mobility(live_loads, inverse_masses) if creeps else 0.0
        means, drags = bodies.means, bodies.drags
        carried = is_carried(velocities, inverse_masses)
        mean_load = 0.0
        done = 0
        for _ in range(n_steps):
            forces[:] = 0.0
            if strains:
                stretch(bodies, shape, like, moves)
            if bends:
                bend(bodies, shape)
            ledger[FRICTION] += contact_forces(joints, geometry, contacts, bodies, dt, like, like_rotation)
            if linked:
                ledger[FRICTION] += pull(links, bodies, like, like_rotation)
            if strains:
                resist(bodies, shape, like, moves)
            if bends:
                resist_bending(bodies, shape)
            keep, steer, impulse = 1.0, 0.0, 0.0
            if creeps:
                along = along_live_load(forces, dead_loads, live_loads, inverse_masses, control[DEAD_FACTOR])
                carry(along, stiffness, mode in (TILT_CREEP, TILT_GUIDED), control)
            dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
            if guided or mode == FIRE:
                power, speed2, force2 = powers(velocities, forces, dead_loads, live_loads, inverse_masses, dead, live)
                keep, steer = steering(power, speed2, force2, control)
            if guided:
                impulse = (control[RATE] - keep * steered_flow(velocities, live_loads)) / stiffness
            elif creeps:
                flow = driven_flow(
                    velocities, forces, previous, dead_loads, live_loads, inverse_masses,
                    dead, live, control[DAMP], control[DAMP_CHANGE], dt,
                )  # fmt: skip
                impulse = (control[RATE] - flow) / stiffness
            kick(
                velocities, forces, previous, dead_loads, live_loads, inverse_masses, speed_limits, means, drags,
                dead, live, control[DAMP], control[DAMP_CHANGE], keep, steer, impulse, dt,
            )  # fmt: skip
            book(forces, dead_loads, live_loads, inverse_masses, means, drags, dead, live, impulse, dt, carried, ledger)
            mean_load += live
            moved = drift(bodies, shape, dt, like)
            done += 1
            if moved > control[TRAVEL_LIMIT] or contacts.stale[-1] != 0:
                break
        ledger[JOLT] += contacts.jolts[0]
        contacts.jolts[0] = 0.0
        control[UNBALANCED] = largest_unbalanced(previous, force_scales)
        control[MEAN_LOAD] = mean_load / done
        return done

    named(advance.py_func, contact_forces, drift, *(part for part in (link_forces,) if part is not None),
          *["strains"] * strains, *["moves"] * moves, *["bends"] * bends)  # fmt: skip
    return advance
