"""Compliance of a structure at rest: displacement by a small live load, and the scale of elastic displacements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.statics.equilibrium import relax
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.engine.simulation import Simulation

AGAINST = "a small live load moves the structure against its direction: it hardly stands as it is"
NOTHING = "the live load moves nothing: no free block has a live load"


def check_moves(sim: Simulation, value: float) -> None:
    """Raises SolverError where the live load moves nothing, or against itself; value: q·u as `compliance` has it."""
    if not value > 0.0:
        raise SolverError(AGAINST if sim.loads.live[sim.free].any() else NOTHING)


def compliance(sim: Simulation, budget: Budget | None = None) -> tuple[float, float]:
    """Compute q·u [J] and the largest displacement [m] per unit of multiplier for small loads; the state is left
    as it was.

    budget: what the steps are taken from. Where the structure has no equilibrium even at the smallest probe, that of
    the last probe is returned.
    """
    load_search, relaxation = sim.settings.load_search, sim.settings.relaxation
    before, places, saved = measures.live_displacement(sim), sim.places(), sim.save()
    load, value, largest = load_search.probe_in_play if sim.play.moved.any() else load_search.probe, 0.0, 0.0
    steps = min(load_search.probe_steps_per_depth * sim.depth**2, load_search.most_probe_steps)
    steps = max(steps, load_search.probe_steps)
    for _ in range(load_search.probes):
        verdict = relax(sim, load, relaxation.tolerance, steps, budget=budget)
        value = (measures.live_displacement(sim) - before) / load
        largest = float(np.abs(sim.places() - places).max()) / load
        sim.restore(saved)
        if verdict.state == "equilibrium":
            break
        load /= 10.0
    return _compliance_in_play(sim, (value, largest), steps, budget) if sim.play.moved.any() else (value, largest)


def _compliance_in_play(
    sim: Simulation, first: tuple[float, float], steps: int, budget: Budget | None
) -> tuple[float, float]:
    """Compute the compliance where any load may roll blocks over a profile: the load step that moves them least."""
    load_search, relaxation = sim.settings.load_search, sim.settings.relaxation
    saved, found, load = sim.save(), first, load_search.probe_in_play
    for _ in range(load_search.doublings):
        if relax(sim, load, relaxation.tolerance, steps, budget=budget).state != "equilibrium":
            break
        before, places = measures.live_displacement(sim), sim.places()
        if relax(sim, 2.0 * load, relaxation.tolerance, steps, budget=budget).state != "equilibrium":
            break
        value = (measures.live_displacement(sim) - before) / load
        largest = float(np.abs(sim.places() - places).max()) / load
        if value > 0.0 and largest < found[1]:
            found = value, largest
        load *= 2.0
    sim.restore(saved)
    return found
