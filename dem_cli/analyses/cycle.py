"""kind = "cycle": the load multiplier follows a path of given values, slowly, to and fro."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.engine import measures
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.joint_summary import END, joint_state
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.engine.track import Track
from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import FALLS, Observer
from dem_cli.statics.compliance import compliance
from dem_cli.statics.equilibrium import settle, settle_or_fail

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FAILS = "fails on the way"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a load path; status "ok" means that the structure stood at every load of it."""
    job = Job.start(case, model, observer, settings)
    job.skipped.append("failure search: the load follows the path of the case")
    sim = job.first_simulation()
    track = job.track(sim)
    found: dict[str, Any] = {"status": FALLS, "failure_load": None, "turning_points": []}
    try:
        if settle(sim, track, job.budget).state == "equilibrium":
            track.flush()
            _follow(job, sim, track, found)
    except SolverError as error:
        found["status"] = "not converged"
        job.warnings.append(str(error))
    track.flush()
    found |= {"largest_displacement": measures.largest_displacement(sim), "joint_state": joint_state(sim, END)}
    return job.outcome([sim], found)


def loads_between(start: float, end: float, step: float) -> np.ndarray:
    """Equal steps of at most `step` from start (left out) to end."""
    return np.linspace(start, end, max(1, math.ceil(abs(end - start) / step - 1e-9)) + 1)[1:]


def _follow(job: Job, sim: Simulation, track: Track, found: dict[str, Any]) -> None:
    """Every load of the path, each a proven equilibrium; what is found goes to `found` as it is found."""
    analysis = job.case.analysis
    elastic = compliance(sim)[1]
    step = analysis.step / sim.live_scale
    load = 0.0
    for turn, target in enumerate(analysis.path):
        for next_load in loads_between(load, target / sim.live_scale, step):
            share, moved = turn / len(analysis.path), measures.largest_displacement(sim)
            track.observer.progress("on the path", next_load * sim.live_scale, moved, share)
            verdict = settle_or_fail(sim, next_load, job.budget, elastic * max(abs(next_load), step))
            if verdict.state != "equilibrium":
                found |= {"status": FAILS, "failure_load": next_load * sim.live_scale}
                track.write("collapse")
                track.frame("collapse")
                return
            track.write("loading")
            load = next_load
        track.frame("loading")
        found["turning_points"].append({"load": target, "displacement": measures.largest_displacement(sim)})
    found["status"] = "ok"
