"""kind = "gravity": does the structure stand under its dead loads?"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import Observer
from dem_cli.solve.equilibrium import Budget, Verdict
from dem_cli.solve.failure import stand
from dem_cli.solve.monitors import Monitors
from dem_cli.solve.run import Clock, Outcome, common_summary, simulation, wants_large
from dem_cli.solve.simulation import Simulation
from dem_cli.solve.track import Track

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FALLS = "does not stand under its dead loads"


def begin(case: Case, model: Model, clock: Clock) -> tuple[Simulation, list[str]]:
    """The simulation that a case starts with, compiled, and what it can do without."""
    kinematics, skipped = case.analysis.kinematics, []
    sim = simulation(case, model, "fixed" if kinematics == "auto" else kinematics)
    if kinematics == "auto":
        why = wants_large(case, model, sim)
        if why:
            sim = simulation(case, model, "large")
        else:
            skipped += ["large-displacement kernel: all joints are closed, the geometry of the start is exact"]
    if sim.kinematics == "fixed":
        skipped.append("detection: done once, nothing moves visibly before failure")
    clock.compile(sim)
    return sim, skipped


def settle(sim: Simulation, track: Track, budget: Budget) -> Verdict:
    """Dead loads; the row is kept in the track, the frame handed over."""
    track.observer.progress("gravity", 0.0, 0.0, 0.02)
    verdict = stand(sim, budget)
    track.keep("gravity")
    track.frame("gravity")
    return verdict


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Outcome of a gravity analysis; status "ok" means that it stands."""
    clock = Clock(observer)
    sim, skipped = begin(case, model, clock)
    track = Track(sim, clock, Monitors(case, model), case.output.frames)
    try:
        verdict = settle(sim, track, Budget(case.analysis.max_steps))
        track.flush()
        status, why = ("ok" if verdict.state == "equilibrium" else FALLS), []
    except SolverError as error:
        status, why = "not converged", [str(error)]
    summary = common_summary([sim], clock, skipped)
    summary["warnings"] += why
    return Outcome(summary | {"status": status, "largest_displacement": sim.largest_displacement()})
