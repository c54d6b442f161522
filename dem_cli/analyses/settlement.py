"""kind = "settlement": supports move as [[settlement]] says, slowly, with geometry that moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.engine import measures
from dem_cli.engine.budget import Budget
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.engine.track import Track
from dem_cli.errors import CaseError, CaseProblem, SolverError
from dem_cli.kernels import records as slot
from dem_cli.model.model import Model
from dem_cli.output.record import FALLS, Observer
from dem_cli.statics.equilibrium import check_finite, settle_or_fail, stand
from dem_cli.statics.post_peak import soften_falls

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a settlement; status "ok" means that the structure stands afterwards. Raises CaseError without any."""
    if not case.settlement:
        raise CaseError([CaseProblem(("analysis", "kind"), "'settlement' needs at least one [[settlement]] table")])
    job = Job.start(case, model, observer, settings)
    job.skipped.append("failure search: the supports move, the load does not")
    sim = job.simulation("large", stiffness_ratio(model, settings.stiffness.settlement_overlap))
    track = job.track(sim)
    try:
        job.clock.progress("gravity", 0.0, 0.0, 0.0)
        status = "ok" if stand(sim, job.budget).state == "equilibrium" else FALLS
        track.write("gravity")
        track.frame("gravity")
        if status == "ok":
            status = _move(case, sim, track, job.budget)
    except SolverError as error:
        status = "not converged"
        job.warnings.append(str(error))
    return job.outcome([sim], {"status": status, "largest_displacement": measures.largest_displacement(sim)})


def stiffness_ratio(model: Model, overlap: float = DEFAULT.stiffness.settlement_overlap) -> float:
    """kn·h/W of "auto" joints that keeps overlaps small: the whole weight may stand on one joint."""
    return float((~model.fixed).sum()) / overlap


def _motions(case: Case, sim: Simulation) -> np.ndarray:
    """Whole movement of every block, zero but for the settling supports, (n_blocks, n_dof) [m, rad]."""
    names = sim.model.numbers
    motion = np.zeros_like(sim.bodies.velocities)
    for table in case.settlement:
        motion[names[table.block]] += [*table.displacement, table.rotation]
    return motion


def _move(case: Case, sim: Simulation, track: Track, budget: Budget) -> str:
    """Moves the supports, then waits for equilibrium; returns the status."""
    settlement = sim.settings.settlement
    motion = _motions(case, sim)
    reach = np.column_stack([np.ones((len(motion), sim.model.dimension)), sim.shape.radii])
    largest = float(np.abs(motion * reach).max())
    elastic = max(measures.largest_elastic(sim), 1e-9 * sim.smallest)
    chunk = max(int(np.ceil(max(largest / (settlement.per_step * elastic), settlement.fewest) / settlement.rows)), 1)
    every = max(settlement.rows // max(case.output.snapshots - 2, 1), 1)
    sim.use_combined_damping()
    sim.set_load(0.0)
    soften_falls(sim, largest, chunk * settlement.rows)
    sim.move_supports(motion / (chunk * settlement.rows))
    for number in range(1, settlement.rows + 1):
        sim.advance(chunk, slot.HOLD_LOAD)
        budget.spend(chunk, "moving the supports")
        check_finite(sim)
        track.write("settlement")
        if number % every == 0:
            track.frame("settlement")
        share, moved = number / settlement.rows, measures.largest_displacement(sim)
        track.observer.progress("settlement", share, moved, 0.95 * share)
    sim.move_supports(np.zeros_like(motion))
    verdict = settle_or_fail(sim, 0.0, budget, measures.dead_scale(sim))
    track.write("settlement")
    track.frame("settlement")
    return "ok" if verdict.state == "equilibrium" else "collapsed under the settlement"
