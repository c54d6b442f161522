"""Equilibrium or failure at a constant load: each claim with its proof.

An equilibrium is proven by the largest unbalanced force, a failure by power: under constant load the
motion accelerates while the loads release more energy than friction and joints take.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.errors import SolverError
from dem_cli.kernels import records as slot

if TYPE_CHECKING:
    from dem_cli.solve.simulation import Simulation

CHUNK = 100  # steps between two looks
TOLERANCE = 1e-5  # unbalanced force on any block of a claimed equilibrium, in its own weight
GRAVITY_TOLERANCE = 1e-5
COMBINED = 0.3  # combined damping: as much against the velocity as against the change of force
# Mass scaling for FIRE, for local damping (numerics, section 3) and for combined damping, which makes a
# reversal of force 1 + 2·COMBINED times as strong and is stable below 1/√(1 + 2·COMBINED) = 0.79.
RELAX_SAFETY, CREEP_SAFETY, COMBINED_SAFETY = 0.6, 0.85, 0.75
# Displacement at constant load grows fourfold when time doubles while it accelerates, twofold at constant speed.
ACCELERATED, STEADY = 2.5, 1.55
FAR, FAR_STEADY = 30.0, 100.0  # in elastic displacements; large walls still find equilibrium after 20


@dataclass(frozen=True)
class Verdict:
    """What happened at a constant load."""

    state: str  # "equilibrium" | "failure" | "unknown"
    unbalanced: float  # largest unbalanced force at the end, in weights of its own block
    released: float = 0.0  # failure: share of the work of the loads that became motion or was damped
    growth: float = 0.0  # failure: growth of the displacement in the last doubling of time


@dataclass
class Budget:
    """Solver steps that may still be spent. `spend` raises SolverError when there are none left."""

    left: int

    def spend(self, steps: int, doing: str) -> None:
        self.left -= steps
        if self.left < 0:
            raise SolverError(f"gave up {doing}: all steps of analysis.max_steps are used up")


def check_finite(sim: Simulation) -> None:
    """Raises SolverError that names the block where a number is no number."""
    bad = ~np.isfinite(sim.bodies.velocities).all(axis=1)
    if bad.any():
        name = sim.model.block_ids[int(np.flatnonzero(bad)[0])]
        raise SolverError(f"the motion of block '{name}' is not a number after {sim.steps} steps")


def relax(sim: Simulation, load: float, tolerance: float, max_steps: int = 40_000) -> Verdict:
    """Steepest fast way to an equilibrium at this load (FIRE); "unknown" if there is none within max_steps."""
    sim.use(RELAX_SAFETY, damping=0.0)
    sim.set_load(load)
    sim.control[slot.FIRE_MIX], sim.control[slot.SINCE_UPHILL] = 0.1, 0.0
    calm = 0
    for _ in range(max(1, max_steps // CHUNK)):
        sim.advance(CHUNK, slot.FIRE)
        check_finite(sim)
        calm = calm + 1 if sim.unbalanced < tolerance else 0
        if calm == 2:
            break
    sim.rest()
    sim.use(CREEP_SAFETY)
    return Verdict("equilibrium" if calm == 2 else "unknown", sim.unbalanced)


def settle_or_fail(
    sim: Simulation, load: float, budget: Budget, scale: float, tolerance: float = TOLERANCE
) -> Verdict:
    """Constant load with local damping until equilibrium or failure is proven.

    scale: displacement that is elastic [m]. Looks when the time doubled; failure is claimed where the
    loads released more energy than friction and joints took, after three accelerated doublings beyond
    FAR elastic displacements, or, for a mechanism that creaks on because sticking and slipping damp it,
    after four doublings at about constant speed beyond FAR_STEADY.
    """
    sim.use(COMBINED_SAFETY, COMBINED, COMBINED)
    sim.set_load(load)
    start, ledger = sim.save_places(), sim.energy_sums()
    done, target, calm, moved = 0, CHUNK, 0, []
    while True:
        while done < target:
            sim.advance(CHUNK, slot.HOLD_LOAD)
            budget.spend(CHUNK, f"at load multiplier {load * sim.live_scale:.5g}")
            done += CHUNK
            calm = calm + 1 if sim.unbalanced < tolerance else 0
            if calm == 2:
                sim.rest()
                return Verdict("equilibrium", sim.unbalanced)
        check_finite(sim)
        moved.append(float(np.abs(sim.save_places() - start).max()))
        now = sim.energy_sums()
        given, taken = now.given - ledger.given, now.taken - ledger.taken
        if given > max(taken, 0.0) and len(moved) > 4 and min(moved[-4:]) > 0.0:
            growth = moved[-1] / moved[-2]
            accelerated = min(moved[-1] / moved[-2], moved[-2] / moved[-3], moved[-3] / moved[-4]) > ACCELERATED
            steady = moved[-1] > STEADY**4 * moved[-5] and moved[-1] > FAR_STEADY * scale
            if moved[-1] > FAR * scale and (accelerated or steady):
                return Verdict("failure", sim.unbalanced, 1.0 - taken / given, growth)
        target *= 2
