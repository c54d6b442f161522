"""Stability of an equilibrium with large displacements: a column beyond its buckling load balances and does not
stand.

The tangent stiffness of the points that carry, with that of their forces and of loads that follow blocks, has a
negative eigenvalue there. Points that are just open are left out of it, and may close: so the blocks are moved a little
along that shape, and what they do under the same loads decides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.sparse_systems import most_negative
from dem_cli.core.dynamics.frequencies import System, system, with_springs
from dem_cli.core.engine.placement import moves
from dem_cli.core.geometry.rotation import turned_further
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.ports import stage
from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.core.statics.equilibrium import settle

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.track import Track


def buckles(sim: Simulation, budget: Budget) -> int | None:
    """Return the block that moves most in the shape in which an equilibrium buckles; None: it is stable.

    sim: at rest; left as it was. Only where geometry moves on joints of a given stiffness, the only ones that say
    anything of buckling, and that have no profile: blocks roll over its sides and come to rest again. Else None.
    """
    if sim.kinematics != "large" or not sim.properties.given or sim.properties.rough or not len(sim.free):
        return None
    shape = _unstable_shape(sim)
    if shape is None:
        return None
    held = sim.save()
    try:
        return int(np.abs(shape).max(axis=1).argmax()) if _goes_on(sim, shape, budget) else None
    finally:
        sim.restore(held)


def standing(sim: Simulation, track: Track, budget: Budget) -> str:
    """Settle the structure under its dead loads; "ok", or the status of one that falls or buckles under them."""
    if settle(sim, track, budget).state != "equilibrium":
        return FALLS
    return "ok" if buckles(sim, budget) is None else BUCKLED


def _unstable_shape(sim: Simulation) -> np.ndarray | None:
    """Motion of all blocks along the lowest eigenvalue of the tangent where it is negative, its largest part one.

    Displacements, and turns times radii [-], (n_blocks, n_dof).
    """
    settings = sim.settings.stability
    acting = np.abs(sim.contacts.normal) > settings.acting * np.abs(sim.contacts.normal).max(initial=0.0)
    if not acting.any():
        return None
    found = system(sim, acting, geometric=True)
    if sim.following is not None:
        found = with_springs(found, _of_following_loads(sim, found))
    matrix = found.matrix
    matrix = 0.5 * (matrix + matrix.T)
    strained = np.bincount(found.rows.indices, minlength=matrix.shape[0]) > 0
    joined = np.repeat(strained.reshape(found.masses.shape).any(axis=1), found.masses.shape[1]) & ~found.held
    among = matrix.tocsr()[joined][:, joined]
    largest = float(abs(among).sum(axis=1).max())
    try:
        vector = most_negative(among, settings.negative * largest)
    except np.linalg.LinAlgError:
        return None
    if vector is None:
        return None
    whole = np.zeros(matrix.shape[0])
    whole[joined] = vector
    motion = np.zeros((sim.model.n_blocks, found.masses.shape[1]))
    motion[found.blocks] = found.motion(whole.reshape(found.masses.shape))
    motion[:, sim.model.rotations] *= sim.shape.radii[:, None]
    return motion / np.abs(motion).max()


def _of_following_loads(sim: Simulation, found: System) -> csr_array:
    """Stiffness of loads that turn with their blocks, (n_free, n_free)."""
    from scipy.sparse import coo_array

    assert sim.following is not None
    n_free, n_dof = found.masses.shape
    d, turn = sim.model.dimension, sim.settings.stability.turn
    factors = float(sim.control[slot.DEAD_FACTOR]), float(sim.control[slot.LIVE_FACTOR]) * sim.live_scale
    rows, columns, values = [], [], []
    for axis in range(sim.model.rotations.stop - d):
        sides = []
        for sign in (1.0, -1.0):
            spins = np.zeros((sim.model.n_blocks, sim.model.rotations.stop - d))
            spins[:, axis] = sign * turn
            turned = turned_further(sim.bodies.orientations, spins)
            now = (sim.following.change(turned, dead=dead) for dead in (True, False))
            of_dead, of_live = now
            sides.append(factors[0] * of_dead + factors[1] * of_live)
        slope = (sides[0] - sides[1])[found.blocks] / (2.0 * turn)  # (n_free, d + r)
        for column in range(slope.shape[1]):
            rows.append(n_dof * np.arange(n_free) + column)
            columns.append(n_dof * np.arange(n_free) + d + axis)
            values.append(-slope[:, column])
    places = np.concatenate(rows), np.concatenate(columns)
    return coo_array((np.concatenate(values), places), shape=(n_free * n_dof, n_free * n_dof)).tocsr()


@stage
def _goes_on(sim: Simulation, shape: np.ndarray, budget: Budget) -> bool:
    """Test whether blocks that are moved a little along a shape go on along it under the same loads."""
    settings, relaxation = sim.settings.stability, sim.settings.relaxation
    little = settings.pushed * sim.smallest
    motion = little * shape[:, : sim.model.rotations.stop].copy()
    motion[:, sim.model.rotations] /= sim.shape.radii[:, None]
    start = sim.places()
    sim.use(relaxation.fire_safety, damping=0.0)
    moves.push(sim, motion)
    sim.restart_relaxation()
    way = shape[:, : sim.model.rotations.stop]
    for _ in range(settings.looks):
        sim.advance(relaxation.chunk, slot.FIRE)
        budget.spend(relaxation.chunk, "looking whether it buckles")
        along = float(((sim.places() - start) * way).sum() / (little * (way * way).sum()))
        if along > settings.goes_on:
            return True
        if along < settings.goes_back:
            return False
    return along > 1.0
