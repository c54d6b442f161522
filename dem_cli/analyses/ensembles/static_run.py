"""Static run of a safety analysis: constant loads raised from zero until equilibrium or failure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.analyses.ensembles.static_bound import stands_where_it_rests
from dem_cli.core.dynamics.stability import buckles
from dem_cli.core.engine import measures
from dem_cli.core.engine.measures import closure
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow
from dem_cli.core.records.ports import Observer
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.equilibrium import NOTHING_KNOWN, Ahead, Verdict, settle_or_fail, stand, unexpected
from dem_cli.core.statics.mechanism import describe
from dem_cli.core.statics.post_peak import fall_under, soften_falls
from dem_cli.core.statics.rigid_limits import RigidLimits
from dem_cli.core.statics.warm_start import LIMIT, find_start
from dem_cli.errors import SolverError, UsageError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.state import SavedState
    from dem_cli.core.engine.track import Track
    from dem_cli.core.model.model import Model

WIDEST = 0.1  # of the smallest edge: gaps between blocks that have moved, over which faces still touch at most


class StaticRunResult(NamedTuple):
    """Result of a structure at one value of the varied parameter."""

    value: float
    stands: bool | None  # None: neither was proven
    why: str  # the proof in words, or why there is none
    unbalanced: float  # largest unbalanced force at the end, in weights of its own block
    proof: dict[str, float] | None  # of a failure by power
    at_share: float  # share of the load that was reached
    mechanism: dict[str, Any]  # of a failure: mode, who takes part
    displacement: float  # largest of a centroid [m]
    steps: int
    seconds: float  # of solving, without compilation
    closure: float  # energy error over the largest energy

    def summary(self) -> dict[str, Any]:
        """Return one line of the table of runs in the summary."""
        return {
            "value": self.value,
            "stands": self.stands,
            "why": self.why,
            "unbalanced": self.unbalanced,
            "displacement": self.displacement,
            "steps": self.steps,
            "seconds": self.seconds,
        }


class StaticRun(NamedTuple):
    """Static run with its simulation, rows and frames."""

    result: StaticRunResult
    case: Case
    model: Model
    job: CaseJob
    sim: Simulation
    frame: Frame  # at the end
    rows: list[HistoryRow]


def decide(
    case: Case,
    model: Model,
    observer: Observer,
    value: float,
    hopeless: bool = False,
    settings: Settings = DEFAULT,
) -> StaticRun:
    """Decide between equilibrium and failure of a case under its constant load.

    hopeless: known to have no equilibrium, so that the first failure will do.
    """
    job = CaseJob.of_case(case, model, observer, settings)
    run = _decided(job, job.first_simulation(), value, hopeless)
    given = run.sim.properties.given
    soft = run.result.displacement > settings.safety.soft * case.analysis.resolution * run.sim.smallest
    if run.result.stands and soft and given and run.sim.kinematics == "fixed" and case.analysis.kinematics == "auto":
        run = _decided(job, job.simulation("large"), value, hopeless)  # joints too soft to leave geometry as it was
    return run


def _decided(job: CaseJob, sim: Simulation, value: float, hopeless: bool) -> StaticRun:
    track, before, share = job.track(sim), sim.save(), 0.0
    try:
        verdict, before, share = _loaded(job, sim, track, hopeless)
    except SolverError as error:
        verdict, why = Verdict("unknown", sim.unbalanced), str(error)
    else:
        why = _proof(verdict, share, job.case.analysis.constant_load)
    failed = verdict.state == "failure"
    result = StaticRunResult(
        value,
        {"equilibrium": True, "failure": False}.get(verdict.state),
        why,
        verdict.unbalanced,
        {"released_share_of_work": verdict.released, "growth_when_time_doubles": verdict.growth}
        if failed and verdict.block is None and not verdict.buckles
        else None,
        share,
        describe(sim, before) if failed else {},
        measures.largest_displacement(sim),
        sim.steps,
        job.clock.seconds(),
        closure(sim),
    )
    track.keep("collapse" if failed else "loading")
    frame = measures.frame(sim, "collapse" if failed else "loading")
    return StaticRun(result, job.case, job.model, job, sim, frame, track.kept)


def _loaded(job: CaseJob, sim: Simulation, track: Track, hopeless: bool) -> tuple[Verdict, SavedState, float]:
    """Apply the constant load; returns the verdict, the state before the last increment, and the applied share."""
    safety = sim.settings.safety
    before = sim.save()
    verdict = _stable(job, sim, stand(sim, job.budget))
    track.keep("gravity")
    load = job.case.analysis.constant_load / sim.live_scale
    if verdict.state != "equilibrium" or load == 0.0:
        return verdict, before, 0.0
    elastic = compliance(sim)[1] * load or measures.dead_scale(sim)
    near = _next_to_failure(job, sim, load, elastic)
    if near is not None:
        track.keep("loading")
        return *near, 1.0
    shares, at, ahead = list(safety.shares), 0.0, NOTHING_KNOWN if hopeless else unexpected(sim)
    while shares:
        share, before = shares[0], sim.save()
        verdict = _stable(job, sim, settle_or_fail(sim, share * load, job.budget, elastic * share, ahead=ahead))
        if verdict.state == "equilibrium":
            at = shares.pop(0)
            track.keep("loading")
        elif share >= safety.near and share - at > safety.gentle and not hopeless:
            sim.restore(before)
            shares.insert(0, 0.5 * (at + share))
        else:
            return verdict, before, share
    return verdict, before, at


def _stable(job: CaseJob, sim: Simulation, verdict: Verdict) -> Verdict:
    """Turn the verdict of an equilibrium that buckles into a failure."""
    if verdict.state == "equilibrium" and buckles(sim, job.budget) is not None:
        return Verdict("failure", verdict.unbalanced, buckles=True)
    return verdict


def _next_to_failure(job: CaseJob, sim: Simulation, load: float, elastic: float) -> tuple[Verdict, SavedState] | None:
    """Apply the load from a state next to failure where the structure is large (warm_start.py).

    None: there is no such state, or it fails under a load below its own, which proves nothing; all is as it was.
    """
    held, steps = sim.save(), sim.steps
    start, _ = find_start(job, sim, RigidLimits(job, sim))
    if start is None:
        return None
    start.put_into(sim)
    before = sim.save()
    verdict = _stable(job, sim, settle_or_fail(sim, load, job.budget, elastic, ahead=Ahead(start.plateau)))
    if verdict.state == "failure" and load * sim.live_scale <= start.load:
        job.skipped.append(f"a start next to failure: it did not hold, {sim.steps - steps:,} steps")
        sim.restore(held)
        return None
    if start.kind == LIMIT:
        job.warnings.append(
            "runs started from the forces of limit analysis without friction in head joints: what the structure "
            "reaches from gravity may be some per cent lower"
        )
    return verdict, before


def _proof(verdict: Verdict, share: float, load: float) -> str:
    """Describe the proof of a verdict in words."""
    where = "" if share in (0.0, 1.0) else f" at {share:g} of the load"
    if verdict.state == "equilibrium":
        return f"at rest: forces balance to {verdict.unbalanced:.1g} of each block's weight"
    if verdict.buckles:
        return f"it buckles{where}: forces balance, and the least push makes it go on"
    if verdict.block is not None:
        return f"'{verdict.block}' came to rest elsewhere{where}"
    under = " under its dead loads alone" if load > 0.0 and share == 0.0 else where
    return f"moves on and releases energy{under}: {100.0 * verdict.released:.2g} % of the work of the loads"


def moved_into_it(run: StaticRun) -> bool:
    """Test by limit analysis whether a structure that stands could carry its loads in its displaced geometry."""
    sim, moved = run.sim, run.result.displacement
    if sim.kinematics == "fixed":
        return False
    touch = 2.0 * measures.largest_overlap(sim), min(WIDEST * sim.smallest, 10.0 * moved)
    try:
        return bool(stands_where_it_rests(run.case, sim, touch, run.job.settings))
    except UsageError:
        return False


def fall(run: StaticRun, observer: Observer, until: float, frames: int) -> str | None:
    """Follow the collapse of a failed structure with moving geometry, until a block moved by `until` [m].

    Frames and rows go to the observer; returns why it did not go that far, if so.
    """
    job = CaseJob.of_case(run.case, run.model, observer, run.job.settings)
    sim = job.simulation("large")
    sim.count_from(run.sim.steps)
    soften_falls(sim, until)
    load = run.case.analysis.constant_load / sim.live_scale
    try:
        if not fall_under(sim, job.track(sim), load, until, frames, job.budget):
            return "with geometry that moves it comes to rest"
    except SolverError as error:
        return str(error)
    return None
