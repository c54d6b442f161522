"""kind = "pushover": the load multiplier at which a structure fails, and how it falls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.engine.automatic_stiffness import ratio_of
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.properties import joint_properties, law_of
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.errors import SolverError, UsageError
from dem_cli.model.model import Model
from dem_cli.output.record import Observer
from dem_cli.statics import post_peak
from dem_cli.statics.equilibrium import FALLS, settle
from dem_cli.statics.failure_bracket import FailureLoad, SearchRange
from dem_cli.statics.failure_load import LoadSearch
from dem_cli.statics.mechanism import describe
from dem_cli.statics.warm_start import GRAVITY, LIMIT, PATH, find_start

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

INTERRUPTED = "interrupted"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a pushover; status "not converged" where the budget of steps ends before the proofs."""
    job = Job.start(case, model, observer, settings)
    search, sim = _search(job)
    sims = [sim]
    found: dict[str, Any] = {"failure_mode": None, "displacement_at_failure": None}
    track = job.track(sim)
    if search.found and search.start["kind"] == LIMIT:
        job.warnings.append(
            "started from the forces of limit analysis without friction in head joints: "
            "the load that the structure reaches from gravity may be some per cent lower"
        )
    elif search.found and search.start["kind"] == GRAVITY and len(sim.free) > settings.warm_start.large:
        large = settings.warm_start.large
        job.warnings.append(f"more than {large} blocks raised from gravity: the true failure load may be higher")
    if search.crept is not None and search.crept_beyond:
        job.warnings.append(
            f"a creep to failure came to rest at {search.crept * sim.live_scale:.5g}, above the proven failure: "
            "how much this structure carries depends on the way it is loaded"
        )
    if search.status == "ok":
        found |= describe(sim, search.standing)
        failing = sim.save()
        sim.restore(search.standing)
        track.frame("loading")
        sim.restore(failing)
        track.frame("collapse")
        if case.analysis.follow > 0.0:
            falling, peak = _fall(job, sim, search)
            sims.append(falling)
            found["displacement_at_failure"] = peak["displacement"]
            found["peak_of_curve"] = peak["load"] and peak["load"] * sim.live_scale
            job.warnings += _too_fast(found["peak_of_curve"], search.high, settings.doubts.overshoot)
        else:
            job.skipped.append("collapse: analysis.follow = 0")
            found["displacement_at_failure"] = search.peak_displacement
    elif search.status != FALLS:
        track.frame("loading")
    if case.analysis.limit:
        found["limit_analysis"] = _limit_analysis(job, search)
    return job.outcome(sims, _answer(search, sim) | found)


def _search(job: Job) -> tuple[FailureLoad, Simulation]:
    """Gravity and the failure search; again with moving geometry where given joints are too soft to freeze it."""
    analysis = job.case.analysis
    search, sim = FailureLoad(), job.first_simulation()
    rigid: float | None = None  # failure load of the same blocks on stiff joints
    while True:
        track = job.track(sim)
        try:
            if settle(sim, track, job.budget).state == "equilibrium":
                start, search.start = find_start(job, sim)
                search.limits = start.limits if start is not None else None
                wanted = SearchRange(analysis.resolution, analysis.max_load, analysis.step)
                LoadSearch(sim, wanted, job.budget, track, search).run(start)
            else:
                search.status = FALLS
        except SolverError as error:
            job.warnings.append(str(error))
        except KeyboardInterrupt:
            search.status = INTERRUPTED
        moved = search.peak_displacement / sim.smallest
        given = any(joint.kn != "auto" for joint in job.case.joints.values())
        soft = given and moved > job.settings.load_search.soft * analysis.resolution
        if not (soft and sim.kinematics == "fixed" and analysis.kinematics == "auto"):
            if rigid and search.found:
                job.warnings += _changed(search.carried, rigid, job.settings.doubts.lowered)
            if search.status != "ok" or analysis.follow == 0.0 or _by_load(job):
                track.flush()  # else the rows of the collapse tell the whole way
            return search, sim
        job.skipped[:] = [f"fixed geometry: with the given kn blocks move {moved:.2g} smallest edges before failure"]
        job.warnings.clear()
        rigid = search.carried if search.found else None
        search, sim = FailureLoad(), job.simulation("large")


def _changed(load: float, rigid: float, lowered: float) -> list[str]:
    """A word where joints of the given stiffness carry another load than stiff ones."""
    if abs(load - rigid) <= lowered * rigid:
        return []
    change = f"{'lowers' if load < rigid else 'raises'} the failure load by {100 * abs(load / rigid - 1):.2g} %"
    return [f"the given kn {change}: on stiff joints it is {rigid:.5g}"]


def _too_fast(peak: float | None, high: float | None, overshoot: float) -> list[str]:
    """A word where the curve of the collapse is above what the structure carries at rest."""
    if peak is None or high is None or peak <= (1.0 + overshoot) * high:
        return []
    share = f"{100 * (peak / high - 1):.2g} %"
    return [
        f"the collapse was followed so fast that its curve peaks {share} above the failure load: only its shape counts"
    ]


def _limit_analysis(job: Job, search: FailureLoad) -> dict[str, Any]:
    """Failure loads of the same rigid blocks by limit analysis; warns where the failure load is above the bound."""
    from dem_cli.limit.analysis import limit_loads, taken_as_plane
    from dem_cli.limit.path import OK

    case, model = job.case, job.model
    properties = joint_properties(case, model, job.settings.stiffness.statics)
    if note := taken_as_plane(properties):
        job.warnings.append(note)
    by_path = search.start.get("kind") == PATH  # known already
    try:
        law, limit = law_of(case), job.settings.limit
        loads = search.limits or limit_loads(model, properties, law, associated_only=by_path, settings=limit)
    except UsageError as error:
        job.warnings.append(f"no limit analysis: {error}")
        return {}
    summary = loads.summary()
    if by_path:
        status, load = search.start["status"], search.start["load"]
        summary["non_associated" if status == OK else "non_associated_at_least"] = load
        summary["non_associated_status"] = status
    bound = loads.associated.upper
    if search.found and bound is not None and search.carried > (1.0 + job.settings.doubts.above) * bound:
        job.warnings.append(
            f"the failure load {search.carried:.5g} is above the associated limit load {bound:.5g}, "
            "which rigid blocks cannot exceed: do not trust this run"
        )
    return summary


def _by_load(job: Job) -> bool:
    """Whether the load of failure stays while the collapse is followed."""
    wanted = job.case.analysis.collapse
    snaps = law_of(job.case).bonded or any(joint.profile for joint in job.case.joints.values())
    return wanted == "load" or (wanted == "auto" and snaps)


def _fall(job: Job, sim: Simulation, search: FailureLoad) -> tuple[Simulation, dict[str, float | None]]:
    """The collapse, in a simulation of its own."""
    until, frames = job.case.analysis.follow, job.case.output.frames
    load = search.carried / sim.live_scale
    by_load = _by_load(job)
    ratio = ratio_of(sim)
    if not by_load:
        ratio = post_peak.softness(ratio, search.elastic, load, sim.smallest, until, job.settings)
    falling = job.simulation("large", ratio)
    softer = ratio_of(sim) / ratio_of(falling) if ratio_of(falling) > 0.0 else 1.0
    falling.count_from(sim.steps)
    fast = search.compliance * softer / sim.settings.post_peak.steps
    rate = min(fast, search.compliance / search.elastic * until / sim.settings.post_peak.fewest)
    try:
        if by_load:
            impossible = search.failed / sim.live_scale
            post_peak.follow_load(falling, job.track(falling), impossible, until, frames, job.budget)
            return falling, {"load": None, "displacement": search.peak_displacement}
        return falling, post_peak.follow(falling, job.track(falling), rate, load, until, frames, job.budget)
    except SolverError as error:
        job.warnings.append(f"the collapse was not followed to its end: {error}")
    except KeyboardInterrupt:
        search.status = INTERRUPTED
        job.warnings.append("the collapse was not followed to its end: interrupted")
    return falling, {"load": None, "displacement": None}


def _answer(search: FailureLoad, sim: Simulation) -> dict[str, Any]:
    """The failure load and how it was obtained."""
    status = search.status
    if status == "no failure":
        status = f"no failure up to a load multiplier of {search.limit:g}"
    answer: dict[str, Any] = {
        "status": status,
        "failure_load": search.low if search.found else None,
        "failure_load_bracket": [search.low, search.high],
        "onset_of_displacements": search.onset,
        "kinematics": sim.kinematics,
        "start": search.start,
        "search": [vars(p) for p in search.passes],
    }
    if search.failing is not None:
        answer["proof_of_failure"] = {
            "released_share_of_work": search.failing.released,
            "growth_when_time_doubles": search.failing.growth,
        }
    return answer
