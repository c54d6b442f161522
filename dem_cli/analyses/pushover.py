"""Pushover analysis, kind = "pushover": the load multiplier at failure, and the collapse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses.bound_beside import StartBound, beside, certified, status_beside
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.engine.automatic_stiffness import ratio_of
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, LAST_EQUILIBRIUM, joint_state
from dem_cli.core.engine.properties import law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.failure_search import INTERRUPTED, failure_search
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.core.statics import post_peak, softer_joints
from dem_cli.core.statics.agreement import doubts, histories, load_range, percent, unique
from dem_cli.core.statics.failure_bracket import EXISTS, NO_FAILURE, OK, FailureLoad
from dem_cli.core.statics.mechanism import describe, moved_blocks
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.track import Track

MOTION, IMPOSSIBLE, BUCKLING = "motion", "limit analysis", "buckling"  # what failure is proved by


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a pushover; status "not converged" where the budget of steps ends before the proofs."""
    job = CaseJob.of_case(case, model, observer, settings)
    start = StartBound(job)
    search, sim = failure_search(
        job, case.analysis.max_load, start.upper, rows=case.analysis.follow == 0.0 or _by_load(job)
    )  # else the rows of the collapse tell the whole way
    sims = [sim]
    found: dict[str, Any] = {"failure_mode": None, "displacement_at_failure": None}
    track = job.track(sim)
    start.follow_path(search, sim)
    resolution = case.analysis.resolution
    job.warnings += doubts(search, resolution, load_range(search, resolution))
    if search.status == OK:
        try:
            found |= softer_joints.checked(job, sim, search, resolution)
        except KeyboardInterrupt:
            search.status = INTERRUPTED
    if search.status == OK:
        found |= _mechanism(sim, search, track)
        if case.analysis.follow > 0.0:
            falling, peak = _fall(job, sim, search)
            sims.append(falling)
            found["displacement_at_failure"] = peak.displacement
            found["curve_joint_stiffness"] = ratio_of(falling) or None
            found["peak_of_curve"] = peak.load and peak.load * sim.live_scale
            off = _off_the_load(peak, search, sim.live_scale, settings.doubts.off_the_load)
            found["curve_off_the_load"] = bool(off)
            job.warnings += off
            found["after_collapse"] = joint_state(falling, END) | {"moved_blocks": moved_blocks(falling)}
        else:
            job.skipped.append("collapse: analysis.follow = 0")
            found["displacement_at_failure"] = search.peak_displacement
    elif search.status not in (FALLS, BUCKLED):
        track.frame("loading")
        found["joint_state"] = joint_state(sim, END)
    if search.status != INTERRUPTED:
        found |= beside(job, search, sim, start)
    found |= certified(job, search, sim, start)
    said = answer(search, sim, resolution) | found
    return job.outcome(sims, said | {"status": status_beside(said["status"], found)})


def _mechanism(sim: Simulation, search: FailureLoad, track: Track) -> dict[str, Any]:
    """Describe the failure mechanism, with frames before and after, where failure was shown by motion.

    Before is where that motion began: the highest equilibrium may be one of the creep, which had gone further.
    """
    before, failing = search.failed_from or search.standing, search.failed_state
    sim.restore(before)
    track.frame("loading")
    found = {"joint_state": joint_state(sim, LAST_EQUILIBRIUM)}
    if failing is None:
        return found
    sim.restore(failing)
    track.frame("collapse")
    return found | describe(sim, before)


def _off_the_load(peak: post_peak.CurvePeak, search: FailureLoad, scale: float, off: float) -> list[str]:
    """Warn where the curve of the collapse misses or exceeds the load carried at rest."""
    low, high = search.low, search.high
    if peak.load is None or not low or high is None:
        return []
    load = peak.load * scale
    if load > (1.0 + off) * high:
        above = f"{percent(load / high - 1)} above the failure load"
        if peak.hardens:
            return [f"the structure carries {above} after it has failed and moved: its curve peaks there"]
        why = f"so fast that its curve peaks {above}"
    elif load < (1.0 - off) * low:
        below = f"{percent(1 - load / low)} below the failure load"
        why = f"on softer joints and with geometry that moves: its curve peaks {below}"
    else:
        return []
    return [f"the collapse was followed {why}: only its shape counts"]


def _by_load(job: CaseJob) -> bool:
    """Tell whether the failure load stays constant while the collapse is followed."""
    wanted = job.case.analysis.collapse
    snaps = law_of(job.request).bonded or any(joint.profile for joint in job.case.joints.values())
    return wanted == "load" or (wanted == "auto" and snaps)


def _fall(job: CaseJob, sim: Simulation, search: FailureLoad) -> tuple[Simulation, post_peak.CurvePeak]:
    """Follow the collapse in a separate simulation."""
    until, frames = job.case.analysis.follow, job.case.output.snapshots
    load = search.carried / sim.live_scale
    by_load = _by_load(job)
    ratio = (
        None if by_load else post_peak.softness(ratio_of(sim), search.elastic, load, sim.smallest, until, job.settings)
    )
    falling = job.simulation("large", ratio)
    softer = ratio_of(sim) / ratio_of(falling) if ratio_of(falling) > 0.0 else 1.0
    falling.count_from(sim.steps)
    fast = search.compliance * softer / sim.settings.post_peak.steps
    rate = min(fast, search.compliance / search.elastic * until / sim.settings.post_peak.fewest)
    try:
        if by_load:
            impossible = search.failed / sim.live_scale
            post_peak.follow_load(falling, job.track(falling), impossible, until, frames, job.budget)
            return falling, post_peak.CurvePeak(displacement=search.peak_displacement)
        peak = post_peak.follow(falling, job.track(falling), rate, load, until, frames, job.budget)
        if peak.followed < until:
            job.warnings.append(
                f"the collapse was not followed to its end, but to {peak.followed:.3g} m: it is too slow"
            )
        return falling, peak
    except SolverError as error:
        job.warnings.append(f"the collapse was not followed to its end: {error}")
    except KeyboardInterrupt:
        search.status = INTERRUPTED
        job.warnings.append("the collapse was not followed to its end: interrupted")
    return falling, post_peak.CurvePeak()


def answer(search: FailureLoad, sim: Simulation, resolution: float) -> dict[str, Any]:
    """Return the failure load and the accuracy of its search as keys of the summary."""
    status = search.status
    if status == NO_FAILURE:
        status = f"no failure up to a load multiplier of {search.limit:g}"
    answer: dict[str, Any] = {
        "status": status,
        "failure_load": search.low if search.found else None,
        "failure_load_bracket": [search.low, search.high],
        "load_range": load_range(search, resolution),
        "histories": [history.summary() for history in histories(search)],
        "unique": unique(search) if search.bound is not None else None,
        "onset_of_displacements": search.onset,
        "kinematics": sim.kinematics,
        "start": search.start,
        "search": [vars(p) for p in search.passes],
    }
    if status == EXISTS:
        answer["equilibrium_load"] = search.low
    if search.undecided:
        answer["undecided_loads"] = search.undecided
    if search.failing is not None:
        answer["proof_of_failure"] = {
            "by": IMPOSSIBLE if search.impossible else BUCKLING if search.failing.buckles else MOTION,
            "released_share_of_work": search.failing.released,
            "growth_when_time_doubles": None if search.impossible else search.failing.growth,
        }
    return answer
