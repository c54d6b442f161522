"""kind = "pushover" with control = "displacement": the capacity curve, and the proof of its peak.

The displacement of the live load grows from gravity to beyond the peak (statics/displacement_control.py), and once more
up to the peak in longer increments, which show whether it hangs on them. Where it does not, the state at the peak is
held under a constant load a little below, from where the load is raised until failure is proved, as under load control:
the failure load is one of that history. Where it does, the load is raised from gravity, and the run says by how much
the curve misses it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses import curve_answers
from dem_cli.analyses.pushover import INTERRUPTED, answer, limit_analysis
from dem_cli.engine import measures
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.joint_summary import END, LAST_EQUILIBRIUM, joint_state
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import FALLS, Frame, HistoryRow, Observer
from dem_cli.statics import softer_joints
from dem_cli.statics.agreement import doubts, load_range
from dem_cli.statics.compliance import check_moves, compliance
from dem_cli.statics.displacement_control import CapacityCurve, CurvePoint, DisplacementControl, trace
from dem_cli.statics.equilibrium import settle
from dem_cli.statics.failure_bracket import OK, FailureLoad, SearchRange
from dem_cli.statics.failure_load import LoadSearch
from dem_cli.statics.mechanism import describe
from dem_cli.statics.rigid_limits import RigidLimits
from dem_cli.statics.warm_start import CURVE, GRAVITY, CurveStart

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.engine.track import Track

FOLLOWING = "following the capacity curve"
HANGS = "the peak of the curve hangs on its increments; the load is raised from gravity"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a pushover under displacement control; status "not converged" where its peak could not be proved."""
    job = Job.start(case, model, observer, settings)
    sim = job.moving_simulation()
    search, found = FailureLoad(), dict[str, Any]()
    track, resolution = job.track(sim), case.analysis.resolution
    try:
        if settle(sim, track, job.budget).state == "equilibrium":
            track.flush()
            _curve_and_peak(job, track, search, found)
        else:
            search.status = FALLS
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
    if search.limits is not None and search.status != INTERRUPTED and case.analysis.limit:
        found["limit_analysis"] = limit_analysis(job, search)
    return job.outcome([sim], answer(search, sim, resolution) | found)


def _curve_and_peak(job: Job, track: Track, search: FailureLoad, found: dict[str, Any]) -> None:
    """The curve, then the bracket around its peak; what is found goes to `found` and `search` as it is found.

    Raises SolverError where the budget ends.
    """
    analysis, sim = job.case.analysis, track.sim
    at_rest, elastic = sim.save(), compliance(sim, job.budget)[0]
    check_moves(sim, elastic)
    curve, hangs = _curve(job, track, elastic, found)
    end = sim.save()
    if analysis.check is not None:
        found |= curve_answers.CurveCheck(job, sim, analysis.check).run(found["capacity_curve"], curve, (at_rest, end))
    sim.restore(at_rest)
    search.limits, peak = RigidLimits(job, sim), curve.highest.load * sim.live_scale
    search.start = {"kind": GRAVITY, "note": HANGS} if hangs else {"kind": CURVE, "load": peak}
    wanted = SearchRange(analysis.resolution, analysis.max_load)
    LoadSearch(sim, wanted, job.budget, job.track(sim), search).run(None if hangs else _start(curve, sim))
    job.warnings += _missed(search, peak, analysis.resolution)
    if search.held is not None:
        sim.restore(search.standing)
        found["joint_state"] = joint_state(sim, LAST_EQUILIBRIUM)
    if search.failed_state is not None:
        sim.restore(search.failed_state)
        found |= describe(sim, search.failed_from or search.standing)
    sim.restore(end)


def _curve(job: Job, track: Track, elastic: float, found: dict[str, Any]) -> tuple[CapacityCurve, bool]:
    """The curve, and whether its peak hangs on the increments; the simulation is left at its end.

    Raises SolverError where the budget ends; the points up to there are in `found`.
    """
    analysis, sim = job.case.analysis, track.sim
    at_rest, longest = sim.save(), analysis.follow / analysis.increments
    curve, drawn = CapacityCurve(), _Drawing(track, FOLLOWING, analysis.follow, job.case.output.snapshots)
    try:
        control = DisplacementControl(sim, job.budget, elastic, drawn.watch)
        trace(control, curve, analysis.follow, longest, drawn)
    except (SolverError, KeyboardInterrupt) as ended:
        curve.stopped = str(ended) or INTERRUPTED
        raise
    finally:
        drawn.hand_over(curve)
        told = curve_answers.summary(job, curve, measures.live_force(sim), sim.live_scale)
        found |= {"capacity_curve": told, "displacement_at_failure": curve.highest.largest}
        job.warnings += _ends(curve)
    end = sim.save()
    sim.restore(at_rest)
    coarse = _coarser(job, track, elastic, curve)
    told["peak_load_of_coarser_increments"] = coarse * sim.live_scale
    sim.restore(end)
    load = curve.highest.load
    if abs(coarse - load) <= analysis.resolution * abs(load):
        return curve, False
    job.warnings.append(
        f"the peak hangs on the increments: longer ones change it by {100 * (coarse / load - 1):+.2g} %; "
        "more of them (analysis.increments) come closer to slow loading"
    )
    return curve, True


def _coarser(job: Job, track: Track, elastic: float, curve: CapacityCurve) -> float:
    """Internal multiplier of the peak of a curve in longer increments, to where the other one came to its peak."""
    settings, analysis = job.settings.displacement_control, job.case.analysis
    near = curve.first_within(settings.near * analysis.resolution).largest - curve.points[0].largest
    coarse, drawn = CapacityCurve(), _Drawing(track, "the same curve in longer steps", near, 0)
    control = DisplacementControl(track.sim, job.budget, elastic, drawn.watch)
    trace(control, coarse, near, analysis.follow / analysis.increments, coarser=settings.coarser)
    return coarse.highest.load


def _start(curve: CapacityCurve, sim: Simulation) -> CurveStart:
    assert curve.at_peak is not None
    return CurveStart(curve.highest.load * sim.live_scale, curve.at_peak)


class _Drawing:
    """Rows and frames of a curve as it grows, kept until its peak is known, and how far it is."""

    def __init__(self, track: Track, doing: str, until: float, wanted: int) -> None:
        self.sim, self.track, self.doing, self.until, self.wanted = track.sim, track, doing, until, wanted
        self.start, self.every = measures.largest_displacement(track.sim), until / max(wanted - 2, 1)
        self.next_frame = self.every
        self.rows: list[HistoryRow] = []
        self.frames: list[tuple[int, Frame]] = []  # number of its row, and the frame

    def watch(self) -> None:
        """Says where the curve is."""
        largest = measures.largest_displacement(self.sim)
        share = min((largest - self.start) / self.until, 1.0) if self.until > 0.0 else None
        self.track.observer.progress(self.doing, self.sim.load * self.sim.live_scale, largest, share)

    def __call__(self, point: CurvePoint) -> None:
        """One more point."""
        self.rows.append(self.track.row("loading"))
        if point.largest >= self.next_frame and self.wanted > 0:
            self.frames.append((len(self.rows), measures.frame(self.sim, "loading")))
            self.next_frame = point.largest + self.every

    def hand_over(self, curve: CapacityCurve) -> None:
        """Hands over all rows and frames: where the load has fallen for good, they are those of the collapse."""
        near = self.sim.settings.displacement_control.past * curve.highest.load
        held = max((number for number, point in enumerate(curve.points) if point.load >= near), default=0)
        frames = dict(self.frames)
        for number, row in enumerate(self.rows, 1):
            stage = "loading" if number <= held else "collapse"
            self.track.observer.row(row._replace(stage=stage))
            if number in frames:
                self.track.hand_over(frames[number]._replace(stage=stage))


def _ends(curve: CapacityCurve) -> list[str]:
    """Warnings: a curve that ends early, one without a peak."""
    last = curve.points[-1]
    if curve.stopped is not None:
        return [f"the curve ends at {last.largest:.3g} m, where the run did: its points so far are kept"]
    if not curve.whole:
        return [
            f"the curve ends at {last.largest:.3g} m: beyond, nothing comes to rest at a displacement of the live load"
        ]
    if curve.peak == len(curve.points) - 1:
        return ["the curve still rises where it ends: its peak is further than analysis.follow"]
    return []


def _missed(search: FailureLoad, peak: float, resolution: float) -> list[str]:
    """A word where the load that was raised from gravity is not that of the peak, which hangs on the increments."""
    if search.start.get("kind") == CURVE or not search.found or search.high is None:
        return []
    low, high = search.carried, search.high
    if (1.0 - resolution) * low <= peak <= (1.0 + resolution) * high:
        return []
    share, where = (100 * abs(peak / low - 1), "below") if peak < low else (100 * abs(peak / high - 1), "above")
    return [
        f"the curve peaks {share:.2g} % {where} the failure load, which was found by raising the load from gravity: "
        "only its shape counts"
    ]
