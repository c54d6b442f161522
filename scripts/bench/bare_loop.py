"""Bare stepping loop that can only hold a load: beside it core/kernels/advance.py shows what its features cost.

No prescribed rates, no FIRE, no tilting, no combined damping, no speed limits; the energy ledger is a choice.
"""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.core.kernels.jit import kernel, named
from dem_cli.core.kernels.records import (
    CONTACT,
    DAMP,
    DAMPING,
    DEAD_FACTOR,
    EXTERNAL,
    FRICTION,
    LIVE_FACTOR,
    UNBALANCED,
)


def make_bare(contact_forces: Callable, drift: Callable, ledger_on: bool) -> Callable:
    """The loop for one contact loop and one way to move the blocks, with the arguments of `make_advance`."""

    @kernel
    def advance(
        n_steps, mode, dt, bodies, shape, joints, geometry, contacts, links, loads, control, ledger, like,
        like_rotation,
    ):  # fmt: skip
        """Advance by n_steps at constant load with local damping; returns the steps done."""
        velocities, forces, residuals = bodies.velocities.ravel(), bodies.forces.ravel(), bodies.unbalanced.ravel()
        dead_loads, live_loads = loads.dead.ravel(), loads.live.ravel()
        inverse_masses, force_scales = loads.inverse_masses.ravel(), loads.force_scales.ravel()
        means, drags = bodies.means, bodies.drags
        dead, live, damp = control[DEAD_FACTOR], control[LIVE_FACTOR], control[DAMP]
        for _ in range(n_steps):
            forces[:] = 0.0
            friction = contact_forces(joints, geometry, contacts, bodies, dt, like, like_rotation)
            for i in range(forces.size):
                old, inverse = velocities[i], inverse_masses[i]
                applied = dead * dead_loads[i] + live * live_loads[i]
                unbalanced = forces[i] + applied if inverse > 0.0 else 0.0
                sign = (1.0 if old > 0.0 else 0.0) - (1.0 if old < 0.0 else 0.0)
                drag = abs(unbalanced) * damp * sign
                residuals[i] = unbalanced
                new = old + inverse * dt * (forces[i] + applied - drag)
                velocities[i] = new
                if ledger_on:
                    means[i] = 0.5 * (old + new)
                    drags[i] = drag
            if ledger_on:
                by_dead = by_live = contact = damping = 0.0
                for i in range(forces.size):
                    mean = means[i]
                    by_dead += dead_loads[i] * mean
                    by_live += live_loads[i] * mean
                    contact += forces[i] * mean
                    damping += drags[i] * mean
                ledger[FRICTION] += friction
                ledger[EXTERNAL] += dt * (dead * by_dead + live * by_live)
                ledger[CONTACT] += dt * contact
                ledger[DAMPING] += dt * damping
            drift(bodies, shape, dt, like)
        largest = 0.0
        for i in range(forces.size):
            largest = max(largest, abs(residuals[i]) * force_scales[i])
        control[UNBALANCED] = largest
        return n_steps

    named(advance.py_func, contact_forces, drift, "ledger" if ledger_on else "")
    return advance
