"""Tracing of a capacity curve in ramps, repeated in longer ones, and in implicit increments where these two differ.

Ramps are quick, but where joints are so stiff that they would be long. Where joints slip as blocks are moved, a curve
may hang on how long ramps are; then every increment is solved as a contact problem of its own
(core/statics/implicit_control.py), from gravity on, and the run says what changed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.analyses import curve_answers
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.engine import measures
from dem_cli.core.statics.displacement_control import CapacityCurve, CurvePoint, DisplacementControl, Followed, trace
from dem_cli.core.statics.implicit_control import ImplicitControl, StiffControl, why_not
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.state import SavedState
    from dem_cli.core.engine.track import Track
    from dem_cli.core.records.frames import Frame
    from dem_cli.core.records.history_rows import HistoryRow

RAMPS, IMPLICIT, MIXED = "ramps", "implicit", "ramps, long ones implicit"  # how increments were made
INTERRUPTED = "interrupted"
TURNS = 0.01  # of the farthest displacement of a monitor, by which it has turned back
FOLLOWING, AGAIN, BY_INCREMENTS = (
    "following the capacity curve",
    "the same curve in longer steps",
    "the same curve in implicit increments",
)


def followed(job: CaseJob, track: Track) -> Followed | None:
    """Return the controlled displacement of the case (analysis.of); None: that of the live load."""
    name = job.case.analysis.of
    if name is None:
        return None
    number = [monitor.name for monitor in job.case.monitor].index(name)
    return Followed(name, lambda: job.monitors.values(track.sim)[number])


class CurveTracing:
    """Capacity curve traced from rest under dead loads; the simulation is left at the end of the curve.

    elastic: compliance, q·u per unit of internal multiplier [J]. curve, end: the curve of the answer and the state at
    its end; increments: how that was made; hangs: its peak hangs on the increments, so that it proves nothing.
    """

    def __init__(self, job: CaseJob, track: Track, elastic: float) -> None:
        self.job, self.track, self.sim, self.elastic = job, track, track.sim, elastic
        self.of, self.at_rest = followed(job, track), track.sim.save()
        self.longest = job.case.analysis.follow / job.case.analysis.increments
        self.curve, self.increments, self.hangs = CapacityCurve(), RAMPS, False
        self.kind = StiffControl if why_not(self.sim) is None else DisplacementControl
        self.coarse: float | None = None  # peak in longer ramps, internal multiplier
        self.in_ramps: float | None = None  # peak in ramps, where the curve is not theirs

    end: SavedState

    def run(self, found: dict[str, Any]) -> None:
        """Trace the curve; rows, frames and keys of the summary are handed over even after an error.

        Raises SolverError where the budget ends.
        """
        until, drawn = self.job.case.analysis.follow, self._drawing(FOLLOWING)
        try:
            control = self._trace(self.kind, self.curve, until, drawn)
            if isinstance(control, StiffControl) and control.starts:
                self.increments = MIXED
            self.end = self.sim.save()
            self.coarse = self._coarser()
            drawn = self._checked(until, drawn)
        finally:
            drawn.hand_over(self.curve)
            found |= {"capacity_curve": self._told(), "displacement_at_failure": self.curve.highest.largest}
            self.job.warnings += _ends(self.curve) + self._turns()
        self.sim.restore(self.end)

    def _drawing(self, doing: str) -> _Drawing:
        analysis, snapshots = self.job.case.analysis, self.job.case.output.snapshots
        return _Drawing(self.track, doing, analysis.follow, snapshots)

    def _trace(
        self, kind: type[DisplacementControl], curve: CapacityCurve, until: float, drawn: _Drawing, longer: float = 1.0
    ) -> DisplacementControl:
        """Trace one curve, from rest under the dead loads; records why it ends early."""
        self.sim.restore(self.at_rest)
        try:
            control = kind(self.sim, self.job.budget, self.elastic, drawn.watch, self.of)
            drawn.control = control
            trace(control, curve, until, self.longest, drawn, longer)
        except (SolverError, KeyboardInterrupt) as ended:
            curve.stopped = str(ended) or INTERRUPTED
            raise
        return control

    def _coarser(self) -> float:
        """Return the internal multiplier of the peak in longer ramps, up to the displacement of the reference curve."""
        settings, resolution = self.job.settings.displacement_control, self.job.case.analysis.resolution
        near, coarse = self.curve.first_within(settings.near * resolution).way, CapacityCurve()
        self._trace(self.kind, coarse, near, _Drawing(self.track, AGAIN, near, 0), settings.coarser)
        return coarse.highest.load

    def _checked(self, until: float, drawn: _Drawing) -> _Drawing:
        """Select the rows of the answer: where the ramp length matters, those of implicit increments."""
        load, resolution = self.curve.highest.load, self.job.case.analysis.resolution
        assert self.coarse is not None
        change = abs(self.coarse - load)
        if change <= resolution * abs(load):
            return drawn
        settings, other, shown = self.job.settings.displacement_control, CapacityCurve(), self._drawing(BY_INCREMENTS)
        differ = f"the peak hangs on the increments: longer ones change it by {100 * (self.coarse / load - 1):+.2g} %"
        reason = why_not(self.sim)
        if reason is None:
            longer = settings.implicit_longer
            control = self._trace(ImplicitControl, other, until, shown, longer)
            assert isinstance(control, ImplicitControl)
            if control.mostly(other.highest.way):
                self.in_ramps, self.curve, self.increments, self.end = load, other, IMPLICIT, self.sim.save()
                self.job.warnings.append(
                    f"{differ}; the curve is that of implicit increments, whose peak is "
                    f"{100 * (other.highest.load / load - 1):+.2g} % off it"
                )
                return shown
            reason = "too many implicit increments had no solution"
        self.hangs = True
        self.job.warnings.append(f"{differ}; more of them (analysis.increments) come closer to slow loading ({reason})")
        return drawn

    def _turns(self) -> list[str]:
        """Warn where the controlled monitor turns back."""
        end, far = self.curve.points[-1].displacement, self.curve.points[self.curve.farthest].displacement
        if self.of is None or end >= (1.0 - TURNS) * far:
            return []
        return [
            f"monitor '{self.of.name}' turns back at {far:.3g} m: loads_at and the bilinear system are those of the "
            "curve up to there; control another one (analysis.of)"
        ]

    def _told(self) -> dict[str, Any]:
        """Return the summary of the curve with its increments."""
        scale = self.sim.live_scale
        told = curve_answers.summary(self.job, self.curve, measures.live_force(self.sim), scale)
        told |= {"of": self.of.name if self.of is not None else None, "increments": self.increments}
        told["peak_load_of_coarser_increments"] = None if self.coarse is None else self.coarse * scale
        return told if self.in_ramps is None else told | {"peak_load_in_ramps": self.in_ramps * scale}


class _Drawing:
    """Rows and frames of a growing curve, kept until its peak is known, and its progress."""

    LASTING = frozenset(("sim", "track", "control"))

    def __init__(self, track: Track, doing: str, until: float, wanted: int) -> None:
        self.sim, self.track, self.doing, self.until, self.wanted = track.sim, track, doing, until, wanted
        self.every = until / max(wanted - 2, 1)
        self.next_frame = self.every
        self.rows: list[HistoryRow] = []
        self.frames: dict[int, Frame] = {}  # by the number of their row

    control: DisplacementControl

    def watch(self) -> None:
        """Report the progress along the curve."""
        share = min(self.control.way / self.until, 1.0) if self.until > 0.0 else None
        load, largest = self.sim.load * self.sim.live_scale, measures.largest_displacement(self.sim)
        self.track.observer.progress(self.doing, load, largest, share)

    def __call__(self, point: CurvePoint) -> None:
        """Record one more point of the curve."""
        self.rows.append(self.track.row("loading"))
        if point.way >= self.next_frame and self.wanted > 0:
            self.frames[len(self.rows)] = measures.frame(self.sim, "loading")
            self.next_frame = point.way + self.every

    def hand_over(self, curve: CapacityCurve) -> None:
        """Hand over all rows and frames: where the load has fallen for good, they belong to the collapse."""
        near = self.sim.settings.displacement_control.past * curve.highest.load
        held = max((number for number, point in enumerate(curve.points) if point.load >= near), default=0)
        for number, row in enumerate(self.rows, 1):
            stage = "loading" if number <= held else "collapse"
            self.track.observer.row(row._replace(stage=stage))
            if number in self.frames:
                self.track.hand_over(self.frames[number]._replace(stage=stage))


def _ends(curve: CapacityCurve) -> list[str]:
    """Warn about a curve that ends early, or one without a peak."""
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
