"""Gravity analysis, kind = "gravity": does the structure stand under its dead loads?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.dynamics.stability import buckles
from dem_cli.core.engine import measures
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, joint_state
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.core.statics.equilibrium import settle
from dem_cli.core.statics.failure_test import moved_far
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a gravity analysis; status "ok" means that the structure stands."""
    job = CaseJob.of_case(case, model, observer, settings)
    sim = job.first_simulation()
    track, start = job.track(sim), sim.places()
    found: dict[str, Any] = {}
    try:
        status = "ok" if settle(sim, track, job.budget).state == "equilibrium" else FALLS
        if status == "ok" and (block := buckles(sim, job.budget)) is not None:
            status, found["buckling"] = BUCKLED, {"block": model.block_ids[block]}
        if status == "ok" and (far := moved_far(sim, start)) is not None:
            found["moved_far"] = {"block": model.block_ids[far[0]], "distance": far[1]}
    except SolverError as error:
        status = "not converged"
        job.warnings.append(str(error))
    track.flush()
    found |= {"status": status, "largest_displacement": measures.largest_displacement(sim)}
    return job.outcome([sim], found | {"joint_state": joint_state(sim, END)})
