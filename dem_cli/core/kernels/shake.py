"""Time steps of a time history in one compiled call: contact forces, ground motion, dampers, velocities, positions.

Leapfrog with real masses, in the frame that moves with the base: positions and forces at whole steps, velocities half
a step behind. The ledger sums what each group of forces really did, force × mean velocity. In space torques kick with
the tensors of inertia of the whole step, before and after which blocks turn freely (kernels/spin.py).
Samples miss what lies between two of them; so the extremes of places, velocities and turns are taken at every step.
Velocities of blocks that deform have mean spins, behind these rates of modes (kernels/deformation/strain_rates.py).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.advance import local_drag
from dem_cli.core.kernels.dashpots import book_elements, book_supports
from dem_cli.core.kernels.deformation.quadratic import bend, resist_bending
from dem_cli.core.kernels.deformation.strain_rates import (
    book_modes,
    kick_modes,
    resist_in_time,
    stretch_in_time,
    turn_by_modes,
)
from dem_cli.core.kernels.jit import always_inline, inline, kernel, literal_unroll, named
from dem_cli.core.kernels.records import (
    CONTACT,
    DAMP,
    DAMPING,
    DASHPOT,
    EXTERNAL,
    FRICTION,
    HIGHEST,
    HIGHEST_AT,
    LEAST_GAP,
    LOWEST,
    LOWEST_AT,
    MASS,
    MASS_RATE,
    MET,
    PLACE,
    PLACE_IN_SPACE,
    SPEED,
    SPEED_IN_SPACE,
    SUPPORT,
    TRAVEL_LIMIT,
    TURN,
    UNBALANCED,
)
from dem_cli.core.kernels.spatial_dashpots import meet, resist
from dem_cli.core.kernels.spin import add_gyration, add_spin_powers, kick_spins, rotation
from dem_cli.core.kernels.vec import shaped_as

TURNS_OF_IMPACT = 6  # pairs of sweeps where points have met, which have no impulse of the step before to start from


@always_inline
def _kick(
    velocities, forces, unbalanced, dead_loads, inverse_masses, masses, mobilities, old, drags, pulled, base, damp,
    rate, dt, like, like_rotation,
):  # fmt: skip
    """Update velocities from forces, loads and the acceleration of the base; leaves the old ones and the drag of each.

    rate: mass-proportional damping, −rate·m·v at the mean velocity of the step. damp: local damping. Without branches.
    """
    n_dof, d = velocities.shape[1], len(like)
    keep, gain = (1.0 - 0.5 * rate * dt) / (1.0 + 0.5 * rate * dt), dt / (1.0 + 0.5 * rate * dt)
    i = np.uint64(0)
    for number in range(velocities.shape[0]):
        block = np.uint64(number)
        for dof in range(n_dof):
            k = np.uint64(dof)
            before, inverse = velocities[block, k], inverse_masses[block, k]
            total = forces[block, k] + dead_loads[block, k] - (masses[block, k] * base[k] if dof < d else 0.0)
            drag = local_drag(total, 0.0, before, damp, 0.0)
            old[i], unbalanced[block, k], drags[i] = before, total, drag
            new = keep * before + gain * inverse * (total - drag)
            velocities[block, k] = new
            pulled[i] = new
            i += np.uint64(1)
        kick_spins(velocities, unbalanced, drags, old, pulled, mobilities, keep, gain, block, like_rotation)


@always_inline
def _book(
    velocities, forces, unbalanced, inverse_masses, masses, shape, turns, old, pulled, drags, rate, dt, ledger,
    like_rotation,
):  # fmt: skip
    """Add the work of one step to the ledger; turns `old` velocities into means and `pulled` ones into those of the
    end.

    pulled: velocities before the dashpots, whose mean with the old ones is what mass damping acted on; what came
    after them is impulse of the dashpots. Supports have their own velocity, and what they push is their work.
    """
    n_dof = velocities.shape[1]
    contact = external = local = drained = support = dashpots = 0.0
    i = np.uint64(0)
    for number in range(velocities.shape[0]):
        block = np.uint64(number)
        drained, dashpots = add_spin_powers(
            drained, dashpots, velocities, old, pulled, shape, turns, block, like_rotation
        )  # fmt: skip
        for dof in range(n_dof):
            k = np.uint64(dof)
            before, after, force = old[i], velocities[block, k], forces[block, k]
            free = 1.0 if inverse_masses[block, k] > 0.0 else 0.0
            mean = 0.5 * (before + after)
            old[i] = mean
            contact += free * force * mean
            support -= (1.0 - free) * force * mean
            external += free * (unbalanced[block, k] - force) * mean
            local += free * drags[i] * mean
            drained += masses[block, k] * (before + pulled[i]) * mean
            dashpots += masses[block, k] * (after - pulled[i]) * mean
            pulled[i] = after
            i += np.uint64(1)
    ledger[CONTACT] += dt * contact
    ledger[EXTERNAL] += dt * external
    ledger[DAMPING] += dt * local
    ledger[MASS] += 0.5 * rate * dt * drained
    ledger[DASHPOT] -= dashpots
    ledger[SUPPORT] += dt * support


@inline
def _sample(step, dt, bodies, shape, watch, like_rotation):
    """Sample place, mean velocity and acceleration of the watched blocks at this step."""
    positions, velocities, means, samples = bodies.positions, bodies.velocities, bodies.means, watch.samples
    d = positions.shape[1]
    n_dof = d + len(like_rotation)
    row = step // watch.every
    for j in range(watch.blocks.shape[0]):
        block = watch.blocks[j]
        turned = rotation(bodies.orientations, block, like_rotation)
        for k in range(n_dof):
            mean = means[block * n_dof + k]
            samples[row, j, 0, k] = positions[block, k] if k < d else turned[k - d]
            samples[row, j, 1, k] = mean
            samples[row, j, 2, k] = 2.0 * (velocities[block, k] - mean) / dt
        add_gyration(samples, row, j, shape, bodies.turns, block, like_rotation)


@inline
def _sample_links(step, links, watch):
    """Sample the state of the links of every kind at this step."""
    row, place = step // watch.every, 0
    for link in literal_unroll(links):
        state = link.state
        for i in range(min(state.shape[0], watch.links.shape[1] - place)):  # nobody may look
            for k in range(state.shape[1]):
                watch.links[row, place + i, k] = state[i, k]
        place += state.shape[0]


@always_inline
def _turned(bodies, block, arms, point, k, like):
    """Compute component k of the arm of a point, turned with its block [m]."""
    turns = bodies.turns
    if len(like) == 2:
        i, j = np.uint64(k), np.uint64(1 - k)
        swept = turns[block, np.uint64(1)] * arms[point, j]
        return turns[block, np.uint64(0)] * arms[point, i] + (swept if k == 1 else -swept)
    found = 0.0
    for m in range(len(like)):
        found += turns[block, np.uint64(len(like) * k + m)] * arms[point, np.uint64(m)]
    return found


@always_inline
def _swept(bodies, block, arms, point, k, like):
    """Compute component k of the velocity ω × r of a point [m/s]."""
    means, d, n_dof = bodies.means, len(like), bodies.velocities.shape[1]
    first = block * np.uint64(n_dof) + np.uint64(d)
    if d == 2:
        across = means[first] * _turned(bodies, block, arms, point, 1 - k, like)
        return -across if k == 0 else across
    i, j = (k + 1) % 3, (k + 2) % 3
    one, other = _turned(bodies, block, arms, point, j, like), _turned(bodies, block, arms, point, i, like)
    return means[first + np.uint64(i)] * one - means[first + np.uint64(j)] * other


@always_inline
def _component(kind, first, last, k, step, bodies, gauges, like, like_rotation):
    """Compute component k of the present reading of a gauge: the mean over its points."""
    arms, n_dof, found, column = gauges.arms, bodies.velocities.shape[1], 0.0, np.uint64(k)
    for number in range(first, last):
        point = np.uint64(number)
        block = np.uint64(gauges.blocks[point])
        if kind == TURN:
            value = rotation(bodies.orientations, block, like_rotation)[k]
        elif kind in (SPEED, SPEED_IN_SPACE):
            value = bodies.means[block * np.uint64(n_dof) + column] + _swept(bodies, block, arms, point, k, like)
        else:
            arm = _turned(bodies, block, arms, point, k, like)
            value = bodies.positions[block, column] + arm - gauges.drawn[point, column]
        found += gauges.weights[point] * value
    if kind >= PLACE_IN_SPACE:
        found += gauges.base[step, kind - PLACE_IN_SPACE, k]
    return found


@always_inline
def _mean_of_gauge(g, step, bodies, gauges, like, like_rotation):
    """Compute the present reading of a gauge of points, of several blocks or of a length."""
    component, kind = gauges.components[g], gauges.kinds[g]
    first, last = gauges.starts[g], gauges.starts[g + 1]
    if component >= 0:
        return _component(kind, first, last, component, step, bodies, gauges, like, like_rotation)
    value, n = 0.0, len(like_rotation) if kind == TURN else len(like)
    for k in range(n):
        part = _component(kind, first, last, k, step, bodies, gauges, like, like_rotation)
        value += part * part if component == -1 else part * gauges.axes[g, k]
    return value


@always_inline
def _read_gauges(step, bodies, gauges, like, like_rotation):
    """Update the extremes of all gauges by their readings at this step."""
    found = gauges.found
    for number in range(found.shape[0]):
        g = np.uint64(number)
        plain, block, component = gauges.plain[g], np.uint64(gauges.owners[g]), gauges.components[g]
        if plain == PLACE:
            value = bodies.positions[block, np.uint64(component)] - gauges.shifts[g]
        elif plain == SPEED:
            value = bodies.means[block * np.uint64(bodies.velocities.shape[1]) + np.uint64(component)]
        elif plain == TURN:
            value = bodies.orientations[block, np.uint64(component)]
        else:
            value = _mean_of_gauge(number, step, bodies, gauges, like, like_rotation)
        if value > found[g, HIGHEST]:
            found[g, HIGHEST], found[g, HIGHEST_AT] = value, step
        if value < found[g, LOWEST]:
            found[g, LOWEST], found[g, LOWEST_AT] = value, step


@always_inline
def _tally_gaps(gaps, tally):
    """Update the least gap so far: four at a time, as a minimum waits for the one before."""
    n = gaps.shape[0]
    a = b = c = d = tally[LEAST_GAP]
    for i in range(0, n - 3, 4):
        a, b = min(a, gaps[i]), min(b, gaps[i + 1])
        c, d = min(c, gaps[i + 2]), min(d, gaps[i + 3])
    for i in range(n - n % 4, n):
        a = min(a, gaps[i])
    tally[LEAST_GAP] = min(min(a, b), min(c, d))


def make_shake(
    contact_forces: Callable,
    drift: Callable,
    damped: bool,
    link_forces: Callable | None = None,
    strains: bool = False,
    bends: bool = False,
) -> Callable:
    """Make the compiled time-history loop for one contact loop and the links of the model.

    damped: with dashpots or Maxwell elements in the joints; strains: blocks deform; bends: in quadratic modes as well.
    """
    linked, pull = link_forces is not None, link_forces or contact_forces  # what is not called is compiled away

    @kernel
    def shake(
        first, n_steps, dt, bodies, shape, joints, geometry, contacts, links, loads, control, ledger, ground,
        dampers, watch, like, like_rotation,
    ):  # fmt: skip
        """Advance by up to n_steps from step `first` of a stretch; returns the steps done (fewer when detection is
        due).
        """
        velocities, forces, unbalanced = bodies.velocities, bodies.forces, bodies.unbalanced
        means, drags, pulled, strained = bodies.means, bodies.drags, bodies.pulled, dampers.strained
        dead_loads, inverse_masses, scales = loads.dead, loads.inverse_masses, loads.force_scales
        damp, rate, n_dof = control[DAMP], control[MASS_RATE], velocities.shape[1]
        gauges, looks = watch.gauges, watch.gauges.tally.shape[0] > 0
        n_moving, n_given = ground.moving.shape[0], ground.velocities.shape[2]
        done = 0
        for step in range(first, first + n_steps):
            forces[:] = 0.0
            if strains:
                stretch_in_time(bodies, shape, strained, like, like_rotation)
            if bends:
                bend(bodies, shape)
            ledger[FRICTION] += contact_forces(joints, geometry, contacts, bodies, dt, like, like_rotation)
            if linked:
                ledger[FRICTION] += pull(links, bodies, like, like_rotation)
            if bends:
                resist_bending(bodies, shape)
            if strains:
                resist_in_time(bodies, shape, strained, like, like_rotation)
            if damped:
                met = meet(joints, contacts, bodies, inverse_masses, dampers, dt, like, like_rotation)
            _kick(
                velocities, forces, unbalanced, dead_loads, inverse_masses, dampers.masses, bodies.mobilities, means,
                drags, pulled, ground.accelerations[step], damp, rate, dt, like, like_rotation,
            )  # fmt: skip
            if strains:
                kick_modes(bodies, shape, strained)
            for j in range(n_moving):
                for k in range(n_given):
                    velocities[ground.moving[j], k] = ground.velocities[step, j, k]
            if damped:
                turns = TURNS_OF_IMPACT if met > 0 else 1
                resist(joints, contacts, bodies, inverse_masses, dampers, dt, turns, like, like_rotation)
                book_elements(
                    dampers.elements, joints, contacts, bodies, dampers, dt, ledger, like, like_rotation
                )  # fmt: skip
                if n_moving > 0:
                    old = shaped_as(means, velocities)
                    book_supports(
                        joints, contacts, bodies, old, inverse_masses, dampers, ledger, like, like_rotation
                    )  # fmt: skip
            if strains:
                book_modes(bodies, shape, strained, rate, dt, ledger)
            _book(
                velocities, forces, unbalanced, inverse_masses, dampers.masses, shape, bodies.turns, means, pulled,
                drags, rate, dt, ledger, like_rotation,
            )  # fmt: skip
            _read_gauges(step, bodies, gauges, like, like_rotation)
            if looks:
                _tally_gaps(contacts.gaps, gauges.tally)
                if damped and met > 0:
                    gauges.tally[MET] += 1.0
            if step % watch.every == 0:
                _sample(step, dt, bodies, shape, watch, like_rotation)
                if linked:
                    _sample_links(step, links, watch)
            if strains:
                turn_by_modes(bodies, shape, strained, dt, like, like_rotation)
            moved = drift(bodies, shape, dt, like)
            done += 1
            if moved > control[TRAVEL_LIMIT] or contacts.stale[-1] != 0:
                break
        largest = 0.0
        for block in range(unbalanced.shape[0]):
            for k in range(n_dof):
                if inverse_masses[block, k] > 0.0:  # supports take what comes
                    largest = max(largest, abs(unbalanced[block, k]) * scales[block, k])
        control[UNBALANCED] = largest
        return done

    named(
        shake.py_func,
        contact_forces,
        drift,
        "damped" if damped else "",
        *((link_forces,) if link_forces is not None else ()),
        *["strains"] * strains,
        *["bends"] * bends,
    )
    return shake
