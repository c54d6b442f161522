"""kind = "pushover" with control = "displacement": the capacity curve, and the proof of its peak.

The displacement of the live load grows from gravity to beyond the peak (statics/displacement_control.py), twice: with
increments as they are asked for, and with coarser ones before, which show whether the peak hangs on them. The state at
the peak is then held under a constant load a little below, from where the load is raised until failure is proved, as
under load control: the failure load is one of that history.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses.pushover import INTERRUPTED, answer, limit_analysis
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.joint_summary import END, LAST_EQUILIBRIUM, joint_state
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import FALLS, Observer
from dem_cli.statics import softer_joints
from dem_cli.statics.agreement import doubts, load_range
from dem_cli.statics.compliance import check_moves, compliance
from dem_cli.statics.displacement_control import CapacityCurve, CurvePoint, DisplacementControl, trace
from dem_cli.statics.equilibrium import settle
from dem_cli.statics.failure_bracket import OK, FailureLoad, SearchRange
from dem_cli.statics.failure_load import LoadSearch
from dem_cli.statics.mechanism import describe
from dem_cli.statics.rigid_limits import RigidLimits
from dem_cli.statics.warm_start import CURVE, CurveStart

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a pushover under displacement control; status "not converged" where its peak could not be proved."""
    job = Job.start(case, model, observer, settings)
    sim = job.moving_simulation()
    search, found = FailureLoad(), dict[str, Any]()
    track, resolution = job.track(sim), case.analysis.resolution
    try:
        if settle(sim, track, job.budget).state == "equilibrium":
            track.flush()
            found |= _curve_and_peak(job, sim, search)
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


def _curve_and_peak(job: Job, sim: Simulation, search: FailureLoad) -> dict[str, Any]:
    """The curve, then the bracket around its peak; what is found of the load goes to `search` as it is found."""
    analysis, settings = job.case.analysis, job.settings.displacement_control
    at_rest = sim.save()
    elastic = compliance(sim, job.budget)[0]
    check_moves(sim, elastic)
    control = DisplacementControl(sim, job.budget, elastic)
    coarse = trace(control, analysis.follow, analysis.increments, coarser=settings.coarser)
    sim.restore(at_rest)
    curve = trace(control, analysis.follow, analysis.increments, _Shown(job, sim, coarse, settings.past))
    end = sim.save()
    found = {"capacity_curve": _summary(curve, coarse, sim), "displacement_at_failure": curve.highest.largest}
    job.warnings += _words(curve, coarse, analysis.resolution)
    sim.restore(at_rest)
    search.limits, search.start = RigidLimits(job, sim), {"kind": CURVE, "load": curve.highest.load * sim.live_scale}
    wanted = SearchRange(analysis.resolution, analysis.max_load)
    LoadSearch(sim, wanted, job.budget, job.track(sim), search).run(_start(curve, sim))
    if search.held is not None:
        sim.restore(search.standing)
        found["joint_state"] = joint_state(sim, LAST_EQUILIBRIUM)
    if search.failed_state is not None:
        sim.restore(search.failed_state)
        found |= describe(sim, search.failed_from or search.standing)
    sim.restore(end)
    return found


def _start(curve: CapacityCurve, sim: Simulation) -> CurveStart:
    assert curve.at_peak is not None
    return CurveStart(curve.highest.load * sim.live_scale, curve.at_peak)


class _Shown:
    """Rows and frames of a curve as it grows; a first, coarser one says how far it goes and where its peak is."""

    def __init__(self, job: Job, sim: Simulation, first: CapacityCurve, past: float) -> None:
        self.track, self.sim, self.past = job.track(sim), sim, past
        self.until, self.highest = job.case.analysis.follow, first.highest.load
        self.every = self.until / max(job.case.output.snapshots - 2, 1)
        self.next_frame, self.stage, self.peaked = self.every, "loading", False

    def __call__(self, point: CurvePoint) -> None:
        """One more point."""
        if point.load < self.past * self.highest and self.peaked:
            self.stage = "collapse"
        self.highest = max(self.highest, point.load)
        self.peaked = self.peaked or point.load >= self.past * self.highest
        self.track.write(self.stage)
        if point.largest >= self.next_frame:
            self.track.frame(self.stage)
            self.next_frame = point.largest + self.every
        share = min(point.largest / self.until, 1.0)
        load = point.load * self.sim.live_scale
        self.track.observer.progress("following the capacity curve", load, point.largest, share)


def _summary(curve: CapacityCurve, coarse: CapacityCurve, sim: Simulation) -> dict[str, Any]:
    """What summary.json says of the curve; multipliers as users know them, displacements in m."""
    displacements, loads = curve.arrays()
    return {
        "displacements": displacements.tolist(),
        "loads": (loads * sim.live_scale).tolist(),
        "peak_load": curve.highest.load * sim.live_scale,
        "peak_displacement": curve.highest.displacement,
        "last_load": curve.points[-1].load * sim.live_scale,
        "last_displacement": curve.points[-1].displacement,
        "whole": curve.whole,
        "peak_load_of_coarser_increments": coarse.highest.load * sim.live_scale,
    }


def _words(curve: CapacityCurve, coarse: CapacityCurve, resolution: float) -> list[str]:
    """Warnings: increments that change the peak, a curve that ends early, one without a peak."""
    said = []
    load, other, last = curve.highest.load, coarse.highest.load, curve.points[-1]
    if abs(other - load) > resolution * abs(load):
        said.append(
            f"the peak hangs on the increments: longer ones change it by {100 * (other / load - 1):+.2g} %; "
            "more of them (analysis.increments) come closer to slow loading"
        )
    if not curve.whole:
        said.append(
            f"the curve ends at {last.largest:.3g} m: beyond, nothing comes to rest at a displacement of the live load"
        )
    elif curve.peak == len(curve.points) - 1:
        said.append("the curve still rises where it ends: its peak is further than analysis.follow")
    return said
