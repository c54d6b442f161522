"""Measures of a simulation: how far its blocks may fall by themselves, whether its energy balances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.kernels import records as slot

if TYPE_CHECKING:
    from dem_cli.engine.simulation import Simulation


def free_falls(sim: Simulation) -> np.ndarray:
    """Largest acceleration that its own loads alone can give each block [m per step²], (n_blocks,)."""
    loads, control, d = sim.loads, sim.control, sim.model.dimension
    force = control[slot.DEAD_FACTOR] * loads.dead[:, :d] + control[slot.LIVE_FACTOR] * loads.live[:, :d]
    light = loads.inverse_masses.copy()
    light[:, d:] *= sim.shape.radii[:, None] ** 2
    return np.sqrt((force**2).sum(axis=1)) * light.max(axis=1)


def closure(sim: Simulation) -> float:
    """Energy error over the largest energy in the ledger, or kinetic so far: 0 where the books balance."""
    e = sim.energy()
    taken = e.friction + e.damping + e.dashpots + e.mass_damping + e.maxwell
    error = e.kinetic + e.elastic + e.gravity + taken - e.external - e.supports
    largest = max(abs(e.external), abs(e.gravity), abs(e.supports), e.elastic, taken, sim.most_kinetic)
    return float(error / largest) if largest > 0.0 else 0.0
