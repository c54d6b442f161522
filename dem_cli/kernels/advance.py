"""n steps in one compiled call: contact forces, load, damping, kick, drift.

Leapfrog: positions and forces at whole steps, velocities half a step behind. In quasi-static runs
the step is 1 and the masses are fictitious. The ledger sums what each group of forces really did,
force × mean velocity, so that the change of kinetic energy equals their sum to round-off.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dem_cli.kernels.jit import inline, kernel
from dem_cli.kernels.records import (
    CONTACT,
    CREEP,
    DAMP,
    DAMPING,
    DEAD_FACTOR,
    EXTERNAL,
    FIRE,
    FIRE_MIX,
    FRICTION,
    LIVE_FACTOR,
    MEAN_LOAD,
    MEAN_POWER,
    RATE,
    SINCE_UPHILL,
    SUPPORT,
    TILT_CREEP,
    TRAVEL_LIMIT,
    UNBALANCED,
)


@inline
def _creep_factor(forces, loads, dead, stiffness):
    """Live factor that leaves no force along the live load: q·M⁻¹(F + f0 + λ q) = 0."""
    total = 0.0
    for i in range(forces.shape[0]):
        for k in range(forces.shape[1]):
            q = loads.live[i, k]
            if q != 0.0:
                total += q * loads.inverse_masses[i, k] * (forces[i, k] + dead * loads.dead[i, k])
    return -total / stiffness


@inline
def _kick(bodies, shape, loads, dead, live, damp, dt, ledger, like):
    """Velocities from forces, with local damping α|F| against the motion; returns (largest force, residual power)."""
    velocities, forces = bodies.velocities, bodies.forces
    d = len(like)
    external = contact = damping = support = power = largest = 0.0
    for i in range(forces.shape[0]):
        for k in range(forces.shape[1]):
            old = velocities[i, k]
            inverse = loads.inverse_masses[i, k]
            if inverse == 0.0:
                support -= forces[i, k] * old
                continue
            applied = dead * loads.dead[i, k] + live * loads.live[i, k]
            unbalanced = forces[i, k] + applied
            size = abs(unbalanced)
            largest = max(largest, size if k < d else size / shape.radii[i])
            drag = 0.0
            if old != 0.0:
                drag = damp * (size if old > 0.0 else -size)
            new = old + dt * inverse * (unbalanced - drag)
            velocities[i, k] = new
            mean = 0.5 * (old + new)
            external += applied * mean
            contact += forces[i, k] * mean
            damping += drag * mean
            power += unbalanced * mean
    ledger[EXTERNAL] += dt * external
    ledger[CONTACT] += dt * contact
    ledger[DAMPING] += dt * damping
    ledger[SUPPORT] += dt * support
    return largest, power


@inline
def _impose_rate(velocities, loads, rate, stiffness, ledger):
    """v += M⁻¹q (rate − q·v)/(q·M⁻¹q): an impulse of the live load that prescribes its displacement rate."""
    flow = 0.0
    for i in range(velocities.shape[0]):
        for k in range(velocities.shape[1]):
            flow += loads.live[i, k] * velocities[i, k]
    impulse = (rate - flow) / stiffness
    for i in range(velocities.shape[0]):
        for k in range(velocities.shape[1]):
            velocities[i, k] += impulse * loads.inverse_masses[i, k] * loads.live[i, k]
    ledger[EXTERNAL] += 0.5 * impulse * (flow + rate)


@inline
def _mix(bodies, loads, dead, live, control, ledger):
    """FIRE (Bitzek et al. 2006) in the metric of the masses: steer downhill, stop when going uphill."""
    velocities, forces = bodies.velocities, bodies.forces
    power = speed2 = force2 = 0.0
    for i in range(forces.shape[0]):
        for k in range(forces.shape[1]):
            inverse = loads.inverse_masses[i, k]
            if inverse > 0.0:
                force = forces[i, k] + dead * loads.dead[i, k] + live * loads.live[i, k]
                power += force * velocities[i, k]
                speed2 += velocities[i, k] ** 2 / inverse
                force2 += force * force * inverse
    keep, steer = 1.0, 0.0
    if power > 0.0:
        control[SINCE_UPHILL] += 1.0
        if force2 > 0.0:
            keep = 1.0 - control[FIRE_MIX]
            steer = control[FIRE_MIX] * math.sqrt(speed2 / force2)
        if control[SINCE_UPHILL] > 5.0:
            control[FIRE_MIX] *= 0.99
    else:
        control[SINCE_UPHILL] = 0.0
        control[FIRE_MIX] = 0.1
        keep = 0.0
    after = 0.0
    for i in range(forces.shape[0]):
        for k in range(forces.shape[1]):
            inverse = loads.inverse_masses[i, k]
            if inverse > 0.0:
                force = forces[i, k] + dead * loads.dead[i, k] + live * loads.live[i, k]
                velocities[i, k] = keep * velocities[i, k] + steer * inverse * force
                after += velocities[i, k] ** 2 / inverse
    ledger[DAMPING] += 0.5 * (speed2 - after)


@inline
def drift_centroids(bodies, shape, dt, like):
    """Positions from velocities."""
    positions, orientations, velocities = bodies.positions, bodies.orientations, bodies.velocities
    d = len(like)
    for i in range(positions.shape[0]):
        for k in range(d):
            positions[i, k] += dt * velocities[i, k]
        orientations[i, 0] += dt * velocities[i, d]
    return 0.0


@inline
def drift_corners(bodies, shape, dt, like):
    """Positions and corners from velocities; returns the largest travel of a corner since detection [m]."""
    positions, orientations, velocities = bodies.positions, bodies.orientations, bodies.velocities
    corners, travel = bodies.corners, bodies.travel
    largest = 0.0
    for i in range(positions.shape[0]):
        vx, vy, w = velocities[i, 0], velocities[i, 1], velocities[i, 2]
        positions[i, 0] += dt * vx
        positions[i, 1] += dt * vy
        orientations[i, 0] += dt * w
        travel[i] += dt * (math.sqrt(vx * vx + vy * vy) + shape.radii[i] * abs(w))
        largest = max(largest, travel[i])
    block, c, s = -1, 1.0, 0.0
    for i in range(corners.shape[0]):
        if shape.corner_blocks[i] != block:
            block = shape.corner_blocks[i]
            c, s = math.cos(orientations[block, 0]), math.sin(orientations[block, 0])
        x, y = shape.corner_arms[i, 0], shape.corner_arms[i, 1]
        corners[i, 0] = positions[block, 0] + c * x - s * y
        corners[i, 1] = positions[block, 1] + s * x + c * y
    return largest


def make_advance(contact_forces: Callable, drift: Callable) -> Callable:
    """The compiled stepping loop for one contact loop and one way to move the blocks."""

    @kernel
    def advance(n_steps, mode, dt, bodies, shape, joints, contacts, loads, control, ledger, like, like_rotation):
        """Advance by up to n_steps; returns the steps done (fewer when a new detection is due)."""
        stiffness = 0.0
        if mode == CREEP or mode == TILT_CREEP:
            for i in range(loads.live.shape[0]):
                for k in range(loads.live.shape[1]):
                    stiffness += loads.live[i, k] ** 2 * loads.inverse_masses[i, k]
        mean_load = mean_power = 0.0
        done = 0
        for _ in range(n_steps):
            bodies.forces[:] = 0.0
            ledger[FRICTION] += contact_forces(joints, contacts, bodies, dt, like, like_rotation)
            if mode == CREEP or mode == TILT_CREEP:
                factor = _creep_factor(bodies.forces, loads, control[DEAD_FACTOR], stiffness)
                if mode == TILT_CREEP:  # the table turns gravity by θ: dead cos θ + live sin θ
                    factor = min(max(factor, -1.0), 1.0)
                    control[DEAD_FACTOR] = math.sqrt(1.0 - factor * factor)
                control[LIVE_FACTOR] = factor
            dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
            if mode == FIRE:
                _mix(bodies, loads, dead, live, control, ledger)
            largest, power = _kick(
                bodies, shape, loads, dead, live, control[DAMP], dt, ledger, like
            )
            if mode == CREEP or mode == TILT_CREEP:
                _impose_rate(bodies.velocities, loads, control[RATE], stiffness, ledger)
            control[UNBALANCED] = largest
            mean_load += live
            mean_power += power
            moved = drift(bodies, shape, dt, like)
            done += 1
            if moved > control[TRAVEL_LIMIT] or contacts.stale[-1] != 0:
                break
        control[MEAN_LOAD] = mean_load / done
        control[MEAN_POWER] = mean_power
        return done

    return advance
