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
    DAMP_CHANGE,
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
def _creep_factor(forces, dead_loads, live_loads, inverse_masses, dead, stiffness):
    """Live factor that leaves no force along the live load: q·M⁻¹(F + f0 + λ q) = 0."""
    total = 0.0
    for i in range(forces.size):
        total += live_loads[i] * inverse_masses[i] * (forces[i] + dead * dead_loads[i])
    return -total / stiffness


@inline
def _sign(x):
    """−1, 0 or 1; without a branch."""
    return (1.0 if x > 0.0 else 0.0) - (1.0 if x < 0.0 else 0.0)


@inline
def _drag(unbalanced, previous, velocity, damp, damp_change):
    """Damping force against the motion: (α sgn v − α' sgn ΔF)|F|, local and combined damping (Cundall 1987).

    The part with the change of force damps vibrations of a block that drifts, where sgn v cannot.
    """
    return abs(unbalanced) * (damp * _sign(velocity) - damp_change * _sign(unbalanced - previous))


@inline
def _rate_impulse(
    velocities, forces, previous, dead_loads, live_loads, inverse_masses,
    dead, live, damp, damp_change, rate, dt, stiffness,
):  # fmt: skip
    """Impulse of the live load after which q·v = rate, local damping included."""
    flow = 0.0
    for i in range(forces.size):
        q = live_loads[i]
        if q != 0.0:
            unbalanced = forces[i] + dead * dead_loads[i] + live * q
            drag = _drag(unbalanced, previous[i], velocities[i], damp, damp_change)
            flow += q * (velocities[i] + dt * inverse_masses[i] * (unbalanced - drag))
    return (rate - flow) / stiffness


@inline
def _steering(velocities, forces, dead_loads, live_loads, inverse_masses, dead, live, control):
    """FIRE (Bitzek et al. 2006) in the metric of the masses: v <- keep v + steer M⁻¹F, and a stop when uphill."""
    power = speed2 = force2 = 0.0
    for i in range(forces.size):
        inverse = inverse_masses[i]
        if inverse > 0.0:
            force = forces[i] + dead * dead_loads[i] + live * live_loads[i]
            power += force * velocities[i]
            speed2 += velocities[i] * velocities[i] / inverse
            force2 += force * force * inverse
    if power <= 0.0 or force2 == 0.0:
        control[SINCE_UPHILL] = 0.0
        control[FIRE_MIX] = 0.1
        return 0.0, 0.0
    mix = control[FIRE_MIX]
    control[SINCE_UPHILL] += 1.0
    if control[SINCE_UPHILL] > 5.0:
        control[FIRE_MIX] *= 0.99
    return 1.0 - mix, mix * math.sqrt(speed2 / force2)


@inline
def _kick(
    velocities, forces, previous, dead_loads, live_loads, inverse_masses, force_scales, speed_limits,
    dead, live, damp, damp_change, keep, steer, impulse, dt, ledger,
):  # fmt: skip
    """Velocities from forces, damped; returns (largest force, residual power).

    Work is force × mean of the velocities of the two drifts around it, so that it adds up to force ×
    displacement; whatever steering, damping or a speed limit takes from the motion is booked as damping.
    """
    external = contact = damping = support = power = largest = 0.0
    for i in range(forces.size):
        old = velocities[i]
        inverse = inverse_masses[i]
        force = forces[i]
        if inverse == 0.0:
            support -= force * old
            continue
        applied = dead * dead_loads[i] + live * live_loads[i]
        unbalanced = force + applied
        size = abs(unbalanced)
        largest = max(largest, size * force_scales[i])
        drag = _drag(unbalanced, previous[i], old, damp, damp_change)
        previous[i] = unbalanced
        pushed = dt * applied + impulse * live_loads[i]
        free = keep * old + inverse * (steer * unbalanced + dt * (force - drag) + pushed)
        new = min(max(free, -speed_limits[i]), speed_limits[i])
        velocities[i] = new
        mean = 0.5 * (old + new)
        external += pushed * mean
        contact += force * mean
        damping += drag * mean
        if new != free:
            damping += mean * (free - new) / (inverse * dt)
        if keep != 1.0:
            damping += mean * ((1.0 - keep) * old / inverse - steer * unbalanced) / dt
        power += unbalanced * mean
    ledger[EXTERNAL] += external
    ledger[CONTACT] += dt * contact
    ledger[DAMPING] += dt * damping
    ledger[SUPPORT] += dt * support
    return largest, power


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


@inline
def keep_points(joints, contacts, positions, corners):
    """Fixed geometry: the points stay where they are."""


def make_advance(contact_forces: Callable, place_points: Callable, drift: Callable) -> Callable:
    """The compiled stepping loop for one contact loop, one contact geometry and one way to move the blocks."""

    @kernel
    def advance(n_steps, mode, dt, bodies, shape, joints, contacts, loads, control, ledger, like, like_rotation):
        """Advance by up to n_steps; returns the steps done (fewer when a new detection is due)."""
        velocities, forces = bodies.velocities.ravel(), bodies.forces.ravel()
        previous = bodies.unbalanced.ravel()
        dead_loads, live_loads = loads.dead.ravel(), loads.live.ravel()
        inverse_masses, force_scales = loads.inverse_masses.ravel(), loads.force_scales.ravel()
        speed_limits = loads.speed_limits.ravel()
        creeps = mode in (CREEP, TILT_CREEP)
        stiffness = 0.0
        if creeps:
            for i in range(live_loads.size):
                stiffness += live_loads[i] * live_loads[i] * inverse_masses[i]
        mean_load = mean_power = 0.0
        done = 0
        for _ in range(n_steps):
            forces[:] = 0.0
            place_points(joints, contacts, bodies.positions, bodies.corners)
            ledger[FRICTION] += contact_forces(
                joints, contacts, bodies.velocities, bodies.forces, dt, like, like_rotation
            )
            keep, steer, impulse = 1.0, 0.0, 0.0
            if creeps:
                factor = _creep_factor(
                    forces, dead_loads, live_loads, inverse_masses, control[DEAD_FACTOR], stiffness
                )
                if mode == TILT_CREEP:  # the table turns gravity by θ: dead cos θ + live sin θ
                    factor = min(max(factor, -1.0), 1.0)
                    control[DEAD_FACTOR] = math.sqrt(1.0 - factor * factor)
                control[LIVE_FACTOR] = factor
                impulse = _rate_impulse(
                    velocities, forces, previous, dead_loads, live_loads, inverse_masses,
                    control[DEAD_FACTOR], factor, control[DAMP], control[DAMP_CHANGE], control[RATE], dt, stiffness,
                )  # fmt: skip
            dead, live = control[DEAD_FACTOR], control[LIVE_FACTOR]
            if mode == FIRE:
                keep, steer = _steering(
                    velocities, forces, dead_loads, live_loads, inverse_masses, dead, live, control
                )
            largest, power = _kick(
                velocities, forces, previous, dead_loads, live_loads, inverse_masses, force_scales, speed_limits,
                dead, live, control[DAMP], control[DAMP_CHANGE], keep, steer, impulse, dt, ledger,
            )  # fmt: skip
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
