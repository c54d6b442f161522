"""n steps of a time history in one compiled call: contact forces, ground motion, dampers, kick, drift.

Leapfrog with real masses, in the frame that moves with the base: positions and forces at whole steps, velocities half
a step behind. The ledger sums what each group of forces really did, force × mean velocity.
"""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.kernels.advance import _drag
from dem_cli.kernels.dashpots import book_dampers, meet, resist
from dem_cli.kernels.jit import inline, kernel, named
from dem_cli.kernels.records import (
    CONTACT,
    DAMP,
    DAMPING,
    EXTERNAL,
    FRICTION,
    MASS,
    MASS_RATE,
    SUPPORT,
    TRAVEL_LIMIT,
    UNBALANCED,
)


@inline
def _kick(velocities, forces, unbalanced, dead_loads, inverse_masses, old, drags, base, damp, rate, dt, d):
    """Velocities from forces, loads and the acceleration of the base; leaves the old ones and the drag of each.

    rate: mass-proportional damping, −rate·m·v at the mean velocity of the step. damp: local damping.
    """
    n_dof = velocities.shape[1]
    for block in range(velocities.shape[0]):
        for k in range(n_dof):
            i = block * n_dof + k
            before, inverse = velocities[block, k], inverse_masses[block, k]
            old[i] = before
            if inverse == 0.0:
                drags[i] = 0.0
                continue
            applied = dead_loads[block, k] - (base[k] / inverse if k < d else 0.0)
            unbalanced[block, k] = forces[block, k] + applied
            drags[i] = _drag(unbalanced[block, k], 0.0, before, damp, 0.0)
            pushed = (1.0 - 0.5 * rate * dt) * before + dt * inverse * (unbalanced[block, k] - drags[i])
            velocities[block, k] = pushed / (1.0 + 0.5 * rate * dt)


@inline
def _book(velocities, forces, unbalanced, inverse_masses, old, pulled, drags, rate, dt, carried, ledger):
    """Work of one step into the ledger; turns `old` velocities into means.

    pulled: velocities before the dashpots, whose mean with the old ones is what mass damping acted on.
    """
    n_dof = velocities.shape[1]
    contact = external = local = mass = support = 0.0
    for block in range(velocities.shape[0]):
        for k in range(n_dof):
            i = block * n_dof + k
            before, inverse = old[i], inverse_masses[block, k]
            mean = 0.5 * (before + velocities[block, k])
            old[i] = mean
            if inverse == 0.0:
                support -= forces[block, k] * mean
                continue
            contact += forces[block, k] * mean
            external += (unbalanced[block, k] - forces[block, k]) * mean
            local += drags[i] * mean
            mass += rate * 0.5 * (before + pulled[i]) / inverse * mean
    ledger[CONTACT] += dt * contact
    ledger[EXTERNAL] += dt * external
    ledger[DAMPING] += dt * local
    ledger[MASS] += dt * mass
    if carried:
        ledger[SUPPORT] += dt * support


@inline
def _sample(step, dt, positions, orientations, velocities, means, old, watch):
    """Place, mean velocity and acceleration of the watched blocks at this step."""
    n_dof, d = velocities.shape[1], positions.shape[1]
    row = step // watch.every
    for j in range(watch.blocks.shape[0]):
        block = watch.blocks[j]
        for k in range(n_dof):
            mean = means[block * n_dof + k]
            watch.samples[row, j, 0, k] = positions[block, k] if k < d else orientations[block, k - d]
            watch.samples[row, j, 1, k] = mean
            watch.samples[row, j, 2, k] = 2.0 * (velocities[block, k] - mean) / dt


def make_shake(contact_forces: Callable, drift: Callable, damped: bool) -> Callable:
    """The compiled loop for one contact loop; damped: with dashpots or Maxwell elements in the joints."""

    @kernel
    def shake(
        first, n_steps, dt, bodies, shape, joints, contacts, loads, control, ledger, ground, dampers, watch,
        like, like_rotation,
    ):  # fmt: skip
        """Steps first, first + 1 ... of a stretch, up to n_steps; returns those done (fewer when detection is due)."""
        velocities, forces, unbalanced = bodies.velocities, bodies.forces, bodies.unbalanced
        means, drags, pulled = bodies.means, bodies.drags, bodies.pulled
        dead_loads, inverse_masses, scales = loads.dead, loads.inverse_masses, loads.force_scales
        damp, rate, d, n_dof = control[DAMP], control[MASS_RATE], len(like), velocities.shape[1]
        n_moving = ground.moving.shape[0]
        done = 0
        for step in range(first, first + n_steps):
            forces[:] = 0.0
            ledger[FRICTION] += contact_forces(joints, contacts, bodies, dt, like, like_rotation)
            if damped:
                meet(joints, contacts, velocities, forces, inverse_masses, dampers, dt, like, like_rotation)
            _kick(
                velocities, forces, unbalanced, dead_loads, inverse_masses, means, drags,
                ground.accelerations[step], damp, rate, dt, d,
            )  # fmt: skip
            for j in range(n_moving):
                for k in range(n_dof):
                    velocities[ground.moving[j], k] = ground.velocities[step, j, k]
            if rate != 0.0:
                for block in range(velocities.shape[0]):
                    for k in range(n_dof):
                        pulled[block * n_dof + k] = velocities[block, k]
            if damped:
                resist(joints, contacts, velocities, inverse_masses, dampers, dt, like, like_rotation)
                book_dampers(joints, contacts, velocities, dampers, dt, ledger, like, like_rotation)
            _book(
                velocities, forces, unbalanced, inverse_masses, means, pulled, drags, rate, dt, n_moving > 0, ledger
            )  # fmt: skip
            if step % watch.every == 0:
                _sample(step, dt, bodies.positions, bodies.orientations, velocities, means, drags, watch)
            moved = drift(bodies, shape, dt, like)
            done += 1
            if moved > control[TRAVEL_LIMIT] or contacts.stale[-1] != 0:
                break
        largest = 0.0
        for block in range(unbalanced.shape[0]):
            for k in range(n_dof):
                largest = max(largest, abs(unbalanced[block, k]) * scales[block, k])
        control[UNBALANCED] = largest
        return done

    named(shake.py_func, contact_forces, drift, "damped" if damped else "")
    return shake
