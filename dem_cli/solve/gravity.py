"""kind = "gravity": does the structure stand under its dead loads?"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import Observer
from dem_cli.solve.equilibrium import Budget, Verdict, stand
from dem_cli.solve.run import Job, Outcome
from dem_cli.solve.simulation import Simulation
from dem_cli.solve.track import Track

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FALLS = "does not stand under its dead loads"


def settle(sim: Simulation, track: Track, budget: Budget) -> Verdict:
    """Dead loads; the row is kept in the track, the frame handed over."""
    track.observer.progress("gravity", 0.0, 0.0, 0.02)
    verdict = stand(sim, budget)
    track.keep("gravity")
    track.frame("gravity")
    return verdict


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Outcome of a gravity analysis; status "ok" means that it stands."""
    job = Job.start(case, model, observer)
    sim = job.first_simulation()
    track = job.track(sim)
    try:
        status = "ok" if settle(sim, track, job.budget).state == "equilibrium" else FALLS
    except SolverError as error:
        status = "not converged"
        job.warnings.append(str(error))
    track.flush()
    return job.outcome([sim], {"status": status, "largest_displacement": sim.largest_displacement()})
