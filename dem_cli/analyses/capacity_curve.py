"""Trace the capacity curve: kind = "pushover" with control = "displacement", and the proof of its peak.

The displacement of the live load grows from gravity to beyond the peak (analyses/curve_tracing.py). The state at the
peak is held under a constant load a little below, from where the load is raised until failure is proved, as under load
control: the failure load is one of that history. Where the peak hangs on how the displacement grew, the load is raised
from gravity instead, and the run says by how much the curve misses it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses import curve_answers
from dem_cli.analyses.bound_beside import StartBound, beside, certified, status_beside
from dem_cli.analyses.curve_tracing import CurveTracing
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.analyses.pushover import answer
from dem_cli.core.dynamics.stability import standing
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, LAST_EQUILIBRIUM, joint_state
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.failure_search import INTERRUPTED, buckling
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.statics import softer_joints
from dem_cli.core.statics.agreement import doubts, load_range, percent
from dem_cli.core.statics.compliance import check_moves, compliance
from dem_cli.core.statics.failure_bracket import OK, FailureLoad, SearchRange
from dem_cli.core.statics.failure_load import LoadSearch
from dem_cli.core.statics.mechanism import describe
from dem_cli.core.statics.rigid_limits import RigidLimits
from dem_cli.core.statics.warm_start import CURVE, GRAVITY, CurveStart
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.track import Track

HANGS = "the peak of the curve hangs on its increments; the load is raised from gravity"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a pushover under displacement control; status "not converged" where its peak could not be proved."""
    job = CaseJob.of_case(case, model, observer, settings)
    sim = job.moving_simulation()
    search, start, found = FailureLoad(), StartBound(job), dict[str, Any]()
    track, resolution = job.track(sim), case.analysis.resolution
    try:
        if (status := standing(sim, track, job.budget)) == OK:
            track.flush()
            _curve_and_peak(job, track, search, found)
        else:
            search.status = status
            track.flush()
            found["joint_state"] = joint_state(sim, END)
    except SolverError as error:
        job.warnings.append(str(error))
        search.end_undecided(settings.load_search.widest)
    except KeyboardInterrupt:
        search.status = INTERRUPTED
    job.warnings += doubts(search, resolution, load_range(search, resolution))
    if search.status == OK:
        try:
            found |= softer_joints.checked(job, sim, search, resolution)
        except KeyboardInterrupt:
            search.status = INTERRUPTED
    if search.status != INTERRUPTED:
        found |= beside(job, search, sim, start)
    found |= certified(job, search, sim, start)
    said = answer(search, sim, resolution) | found
    return job.outcome([sim], said | {"status": status_beside(said["status"], found)})


def _curve_and_peak(job: CaseJob, track: Track, search: FailureLoad, found: dict[str, Any]) -> None:
    """Trace the curve, then bracket its peak; results go to `found` and `search` as they are found.

    Raises SolverError where the budget ends.
    """
    analysis, sim = job.case.analysis, track.sim
    at_rest, elastic = sim.save(), compliance(sim, job.budget)[0]
    check_moves(sim, elastic)
    traced = CurveTracing(job, track, elastic)
    traced.run(found)
    curve, end = traced.curve, traced.end
    if analysis.check is not None:
        found |= curve_answers.CurveCheck(job, sim, analysis.check).run(found["capacity_curve"], curve, (at_rest, end))
    sim.restore(at_rest)
    search.limits, peak = RigidLimits(job, sim), curve.highest.load * sim.live_scale
    start = None
    if traced.hangs:
        search.start = {"kind": GRAVITY, "note": HANGS}
    else:
        assert curve.at_peak is not None
        start, search.start = CurveStart(peak, curve.at_peak), {"kind": CURVE, "load": peak}
    wanted = SearchRange(analysis.resolution, analysis.max_load)
    LoadSearch(sim, wanted, job.budget, job.track(sim), search, buckling(job)).run(start)
    if missed := _missed(search, peak, analysis.resolution):
        job.warnings += missed
        found |= {"curve_off_the_load": True, "peak_of_curve": peak}
    if search.held is not None:
        sim.restore(search.standing)
        found["joint_state"] = joint_state(sim, LAST_EQUILIBRIUM)
    if search.failed_state is not None:
        sim.restore(search.failed_state)
        found |= describe(sim, search.failed_from or search.standing)
    sim.restore(end)


def _missed(search: FailureLoad, peak: float, resolution: float) -> list[str]:
    """Warn where the load raised from gravity differs from the peak, which then depends on the increments."""
    if search.start.get("kind") == CURVE or not search.found or search.high is None:
        return []
    low, high = search.carried, search.high
    if (1.0 - resolution) * low <= peak <= (1.0 + resolution) * high:
        return []
    share, where = (abs(peak / low - 1), "below") if peak < low else (abs(peak / high - 1), "above")
    return [
        f"the curve peaks {percent(share)} {where} the failure load, which was found by raising the load from gravity: "
        "only its shape counts"
    ]
