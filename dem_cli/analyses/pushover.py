"""kind = "pushover": the load multiplier at which a structure fails, and how it falls."""

from __future__ import annotations

from math import ceil, inf, log2
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.bound_beside import StartBound, beside, status_beside
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.dynamics.stability import buckles, standing
from dem_cli.core.engine.automatic_stiffness import ratio_of
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, LAST_EQUILIBRIUM, joint_state
from dem_cli.core.engine.kinematics import fixed_beside
from dem_cli.core.engine.properties import law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.core.statics import post_peak, softer_joints
from dem_cli.core.statics.agreement import at_the_bound, doubts, histories, load_range, percent, unique
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.failure_bracket import EXISTS, NO_FAILURE, OK, FailureLoad, SearchRange
from dem_cli.core.statics.failure_load import LoadSearch
from dem_cli.core.statics.mechanism import describe, moved_blocks
from dem_cli.core.statics.rigid_limits import RigidLimits
from dem_cli.core.statics.warm_start import GRAVITY, IMPLICIT, find_start
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from collections.abc import Callable

    from dem_cli.case.schema import Case
    from dem_cli.core.engine.track import Track

INTERRUPTED = "interrupted"
MOTION, IMPOSSIBLE, BUCKLING = "motion", "limit analysis", "buckling"  # what failure is proved by


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a pushover; status "not converged" where the budget of steps ends before the proofs."""
    job = CaseJob.of_case(case, model, observer, settings)
    start = StartBound(job)
    search, sim = _search(job, start)
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
    said = answer(search, sim, resolution) | found
    return job.outcome(sims, said | {"status": status_beside(said["status"], found)})


def _mechanism(sim: Simulation, search: FailureLoad, track: Track) -> dict[str, Any]:
    """How the structure fails, with the frames before and after, where failure was shown by motion.

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


def _search(job: CaseJob, start: StartBound) -> tuple[FailureLoad, Simulation]:
    """Gravity and the failure search, with geometry that moves where given joints are too soft to freeze it.

    That is decided before the search, by elastic displacements at the load that limit analysis allows at most; and
    after it once more, by those at failure. Where some of several structures have gaps that may close, geometry is that
    of the start unless it is one of these that fails first.
    """
    analysis = job.case.analysis
    closing = fixed_beside(job.request, job.model)
    search, sim = FailureLoad(), job.first_simulation() if closing is None else job.simulation("fixed")
    rigid: float | None = None  # what the same blocks carry on stiff joints, or
    searched = False  # at most
    while True:
        track = job.track(sim)
        moved = _raised(job, sim, track, search, rigid)  # smallest edges
        if closing is not None and search.status != INTERRUPTED:
            if not _fails_beside(search, sim, closing):
                job.warnings.clear()
                closing, search, sim = None, FailureLoad(), job.first_simulation()
                continue
            job.skipped.append("large displacements: what fails first has no gaps that may close")
        again = moved > job.settings.load_search.soft * analysis.resolution
        if not again or search.status == INTERRUPTED:
            if rigid and search.found:
                job.warnings += _changed(search.carried, rigid, searched, job.settings.doubts.lowered)
            if search.status != "ok" or analysis.follow == 0.0 or _by_load(job):
                track.flush()  # else the rows of the collapse tell the whole way
            return search, sim
        job.skipped[:] = [f"fixed geometry: with the given kn blocks move {moved:.2g} smallest edges before failure"]
        rigid, searched = (search.carried, True) if search.found else (_bound_of_the_start(search, start), False)
        job.warnings.clear()
        search, sim = FailureLoad(), job.simulation("large")


def _raised(job: CaseJob, sim: Simulation, track: Track, search: FailureLoad, rigid: float | None) -> float:
    """Raises the load of a simulation from gravity until it fails, into `search`; how far given joints let blocks move
    before failure, in smallest edges, where that says that geometry has to move, else 0.

    rigid: as in `_search`.
    """
    analysis, moved = job.case.analysis, 0.0
    try:
        if (status := standing(sim, track, job.budget)) == OK:
            search.limits = RigidLimits(job, sim)
            moved = _expected_motion(job, sim, search.limits)
            if not moved:
                near, search.start = find_start(job, sim, search.limits)
                wanted = SearchRange(analysis.resolution, analysis.max_load, analysis.step)
                load_search = LoadSearch(sim, wanted, job.budget, track, search, buckling(job))
                load_search.on_stiff_joints = rigid / sim.live_scale if rigid else inf
                load_search.run(near)
                _second_history(job, load_search)
                moved = search.peak_displacement / sim.smallest if _may_move(job, sim) else 0.0
        else:
            search.status = status
    except SolverError as error:
        job.warnings.append(str(error))
        search.end_undecided(job.settings.load_search.widest)
    except KeyboardInterrupt:
        search.status = INTERRUPTED
    return moved


def _fails_beside(search: FailureLoad, sim: Simulation, closing: np.ndarray) -> bool:
    """Whether what failed on geometry of the start are other structures than those whose gaps may close, (n_blocks,)
    bool: until then these stood with open gaps, so that none closed."""
    before, failing = search.failed_from or search.held, search.failed_state
    if search.status != OK or not search.found or before is None or failing is None:
        return False
    motion = np.sqrt(((failing.bodies.positions - before.bodies.positions) ** 2).sum(axis=1))
    return bool(motion[closing].max() < sim.settings.mechanism.takes_part * motion.max())


def buckling(job: CaseJob) -> Callable[[Simulation], bool]:
    """Whether a state at rest buckles, for searches."""
    return lambda sim: buckles(sim, job.budget) is not None


def _bound_of_the_start(search: FailureLoad, start: StartBound) -> float | None:
    """What rigid blocks carry at most, by limit analysis of the geometry of the start."""
    if search.bound is not None:
        return search.bound
    loads = start.loads
    return None if loads is None else loads.associated.upper


def _may_move(job: CaseJob, sim: Simulation) -> bool:
    """Whether geometry may have to move because joints have a stiffness that the case gives."""
    return sim.properties.given and sim.kinematics == "fixed" and job.case.analysis.kinematics == "auto"


def _expected_motion(job: CaseJob, sim: Simulation, limits: RigidLimits) -> float:
    """Elastic displacement in smallest edges at the load that limit analysis allows at most, where that alone already
    says that geometry has to move; else 0.
    """
    if not _may_move(job, sim):
        return 0.0
    settings, load = job.settings.load_search, 1.0 if limits.bound is None else limits.bound / sim.live_scale
    moved = compliance(sim, job.budget)[1] * load / sim.smallest
    return moved if moved > settings.soft * job.case.analysis.resolution else 0.0


def _second_history(job: CaseJob, load_search: LoadSearch) -> None:
    """The path from gravity beside a load that limit analysis leaves open, where it is affordable.

    Where it ends elsewhere, or nowhere, rested or fell on the way, or a creep came to rest at a higher load, the load
    is raised again in small steps, up to so many blocks: which of the loads a search finds hangs on its steps there,
    and these are its own.
    """
    search, resolution = load_search.answer, job.case.analysis.resolution
    if not search.found or search.limits is None or at_the_bound(search, resolution) or search.limits.too_large:
        return
    implicit = search.start["kind"] == IMPLICIT
    if implicit and search.limits.largest > job.settings.warm_start.beside_implicit:
        return
    path = search.limits.path
    if path is None:
        return
    even = path.load is not None and path.finished and path.rest is None and path.fall <= resolution
    if even and load_range(search, resolution) is None:
        return
    if implicit and load_search.run_again_in_small_implicit_steps():
        return
    if search.limits.largest > job.settings.warm_start.repeated:
        job.skipped.append("the load again in small steps: too many blocks")
    elif search.carried > job.settings.load_search.least * search.scale and search.start["kind"] in (GRAVITY, IMPLICIT):
        load_search.run_again_in_small_steps(2.0 ** ceil(log2(search.carried)))
        if search.earlier is None:
            job.skipped.append("the load again in small steps: not finished; it is that of larger steps")


def _changed(load: float, rigid: float, searched: bool, lowered: float) -> list[str]:
    """A word where joints of the given stiffness carry another load than stiff ones; searched: that was found."""
    if abs(load - rigid) <= lowered * rigid:
        return []
    if not searched:
        return [f"the given kn moves the geometry before failure: on stiff joints it carries at most {rigid:.5g}"]
    change = f"{'lowers' if load < rigid else 'raises'} the failure load by {percent(abs(load / rigid - 1))}"
    return [f"the given kn {change}: on stiff joints it is {rigid:.5g}"]


def _off_the_load(peak: post_peak.CurvePeak, search: FailureLoad, scale: float, off: float) -> list[str]:
    """A word where the curve of the collapse does not come to what the structure carries at rest, or passes it."""
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
    """Whether the load of failure stays while the collapse is followed."""
    wanted = job.case.analysis.collapse
    snaps = law_of(job.request).bonded or any(joint.profile for joint in job.case.joints.values())
    return wanted == "load" or (wanted == "auto" and snaps)


def _fall(job: CaseJob, sim: Simulation, search: FailureLoad) -> tuple[Simulation, post_peak.CurvePeak]:
    """The collapse, in a simulation of its own."""
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
    """The failure load and how it was obtained."""
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
