"""kind = "settlement": supports move as [[settlement]] says, slowly, with geometry that moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.engine import measures
from dem_cli.engine.budget import Budget
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.simulation import Simulation
from dem_cli.engine.track import Track
from dem_cli.errors import CaseError, CaseProblem, SolverError
from dem_cli.kernels import records as slot
from dem_cli.model.model import Model
from dem_cli.output.record import Observer
from dem_cli.statics.equilibrium import COMBINED, COMBINED_SAFETY, FALLS, check_finite, settle_or_fail, stand
from dem_cli.statics.post_peak import FALL

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

ROWS = 200  # looks along the way
PER_STEP = 0.05  # movement of a support in a step, in elastic displacements under the dead loads
FEWEST = 20_000  # steps of the whole movement, at least
OVERLAP = 1e-3  # overlap that the dead loads may cause in "auto" joints, in smallest edges


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Outcome of a settlement; status "ok" means that the structure stands afterwards."""
    if not case.settlement:
        raise CaseError([CaseProblem(("analysis", "kind"), "'settlement' needs at least one [[settlement]] table")])
    job = Job.start(case, model, observer)
    job.skipped.append("failure search: the supports move, the load does not")
    sim = job.simulation("large", stiffness_ratio(model))
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


def stiffness_ratio(model: Model) -> float:
    """kn·h/W of "auto" joints that keeps overlaps small: the whole weight may stand on one joint."""
    return float((~model.fixed).sum()) / OVERLAP


def _motions(case: Case, sim: Simulation) -> np.ndarray:
    """Whole movement of every block, zero but for the settling supports, (n_blocks, n_dof) [m, rad]."""
    names = sim.model.numbers
    motion = np.zeros_like(sim.bodies.velocities)
    for table in case.settlement:
        motion[names[table.block]] += [*table.displacement, table.rotation]
    return motion


def _move(case: Case, sim: Simulation, track: Track, budget: Budget) -> str:
    """Moves the supports, then waits for equilibrium; returns the status."""
    motion = _motions(case, sim)
    reach = np.column_stack([np.ones((len(motion), sim.model.dimension)), sim.shape.radii])
    largest = float(np.abs(motion * reach).max())
    elastic = max(measures.largest_displacement(sim), 1e-9 * sim.smallest)
    chunk = max(int(np.ceil(max(largest / (PER_STEP * elastic), FEWEST) / ROWS)), 1)
    every = max(ROWS // max(case.output.frames - 2, 1), 1)
    sim.use(COMBINED_SAFETY, COMBINED, COMBINED)
    sim.set_load(0.0)
    sim.limit_speed(max(FALL * sim.smallest, 20.0 * largest / (chunk * ROWS)))
    sim.move_supports(motion / (chunk * ROWS))
    for number in range(1, ROWS + 1):
        sim.advance(chunk, slot.HOLD_LOAD)
        budget.spend(chunk, "moving the supports")
        check_finite(sim)
        track.write("settlement")
        if number % every == 0:
            track.frame("settlement")
        track.observer.progress("settlement", number / ROWS, measures.largest_displacement(sim), 0.95 * number / ROWS)
    sim.move_supports(np.zeros_like(motion))
    verdict = settle_or_fail(sim, 0.0, budget, measures.dead_scale(sim))
    track.write("settlement")
    track.frame("settlement")
    return "ok" if verdict.state == "equilibrium" else "collapsed under the settlement"
