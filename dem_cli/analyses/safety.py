"""Safety analysis, kind = "safety": the factor by which strengths may fall, or a key may change, before failure.

Every value is a run of its own (ensembles/static_run.py); the search only says which value comes next. What it
reports is the last value proven to stand and the first proven to fail.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from dem_cli.analyses.ensembles import bisection
from dem_cli.analyses.ensembles.bisection import Ends
from dem_cli.analyses.ensembles.shaken_run import ProgressOnly
from dem_cli.analyses.ensembles.static_bound import Bound, bound
from dem_cli.analyses.ensembles.static_run import StaticRun, decide, fall, moved_into_it
from dem_cli.analyses.ensembles.static_values import changed, checked_model, load_doubts, scale_of, weaker
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.kinematics import why_moving
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.laws.strength import strengths
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import ABOVE
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.tables.safety import SafetyAnalysis

NOT_CONVERGED, INTERRUPTED = "not converged", "interrupted"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a safety analysis. Raises CaseError where nothing can be varied as the case says."""
    return SafetyStudy(case, model, observer, settings).run()


class SafetyStudy:
    """Safety study: all runs of a safety analysis and their bracket."""

    def __init__(self, case: Case, model: Model, observer: Observer, settings: Settings):
        self.settings = settings
        self.case, self.model, self.observer = case, model, observer
        self.analysis: SafetyAnalysis = case.analysis
        self.scale = scale_of(case, settings.safety)
        self.started, self.compiling = time.perf_counter(), 0.0
        self.nearest_runs: dict[float, StaticRun] = {}  # only of the values next to the answer
        self.runs: list[dict[str, Any]] = []
        self.answers: dict[float, bool] = {}
        self.undecided: set[float] = set()  # values at which neither equilibrium nor failure was proven
        self.warnings: list[str] = []
        self.above: dict[str, Any] = {}  # `above_the_bound` of the summary; empty: it is not
        self.steps, self.closure = 0, 0.0
        self.known: Bound | str | None = None  # what limit analysis says of the geometry of the start
        self.moving = ""  # why geometry moves, where the case does not ask for it: then that is no guess, but a bound

    def run(self) -> Outcome:
        """Run limit analysis where it applies, then the trial runs, then hand over the decisive ones."""
        known = self.known = self._bound()
        guess = Ends(known.carried, known.impossible) if isinstance(known, Bound) and not self.moving else None
        start = min(max(1.0, self.scale.low), self.scale.high) if self.analysis.of_strength else None
        status = "ok"
        try:
            resolution, scan = self.analysis.resolution, self.analysis.scan
            ends = bisection.search(self._stands, self.scale, resolution, guess, scan, start, self.settings.safety)
        except KeyboardInterrupt:
            if not self.answers:
                raise
            status, ends = INTERRUPTED, self._nearest()
        if status == "ok" and ends.fails in self.undecided:
            status = f"{NOT_CONVERGED}: neither equilibrium nor failure was proven at {self._named(ends.fails)}"
            ends = self._nearest()
        if status == "ok" and None in ends:
            status = self._nowhere(ends)
        if not self._check(ends) and status == "ok":
            status = ABOVE
        self._show(ends, 0.0 if status == INTERRUPTED else self.analysis.follow)
        return Outcome(self._answer(status, ends) | self._facts(ends))

    # -- runs --------------------------------------------------------------------------------------

    def variant(self, value: float) -> tuple[Case, Model]:
        """Return case and model at a value of the varied parameter."""
        if self.analysis.of_strength:
            return weaker(self.case, value), self.model
        case = changed(self.case, self.analysis.vary, value)
        return case, checked_model(case, value)

    def _stands(self, value: float) -> bool:
        """Test whether the structure provably stands at a value; each value is run once."""
        if value not in self.answers and value not in self.undecided:
            self._run(value)
        return self.answers.get(value, False)

    def _run(self, value: float) -> None:
        text = f"{len(self.runs) + 1}. run: {self._named(value)}"
        self.observer.progress(text, math.nan, math.nan, None)
        try:
            case, model = self.variant(value)
            hopeless = not self.moving and self._past(value) >= 0.0
            run = decide(case, model, ProgressOnly(self.observer, self.observer.stages), value, hopeless, self.settings)
        except CaseError as error:  # both ends of the range are possible
            self._give_up(value, str(error))
            return
        self.steps += run.result.steps
        self.compiling += run.job.clock.compiling
        self.runs.append(run.result.summary())
        self.warnings += [text for text in run.job.warnings if text not in self.warnings]
        if run.result.stands is None:
            self._give_up(value, run.result.why)
            return
        self.answers[value] = run.result.stands
        if run.result.stands:
            self.closure = max(self.closure, run.result.closure, key=abs)
        self.nearest_runs[value] = run
        near = set(self._nearest())
        self.nearest_runs = {v: kept for v, kept in self.nearest_runs.items() if v in near}

    def _give_up(self, value: float, why: str) -> None:
        """Record a value without proof: it counts neither as standing nor as failing."""
        self.undecided.add(value)
        self.warnings.append(f"{self._named(value)}: {why}")

    def _nearest(self) -> Ends:
        """Return the tried values next to the change from standing to failing."""
        tried = sorted(self.answers.items())
        return bisection.first_change(tried) if tried else Ends(None, None)

    def _bound(self) -> Bound | str | None:
        if not self.analysis.limit:
            return None
        self.moving = why_moving(solver_request(self.case), self.model) or ""
        self.observer.progress("limit analysis", 0.0, 0.0, None)
        return bound(self.variant, self.scale, self.analysis.resolution, self.settings)

    # -- what they say -----------------------------------------------------------------------------

    def _named(self, value: float) -> str:
        return f"F = {value:.5g}" if self.analysis.of_strength else f"{self.analysis.vary} = {value:.6g}"

    def _nowhere(self, ends: Ends) -> str:
        """Return the status where all tried values stand, or all fail."""
        low, high = self.scale.low, self.scale.high
        if not self.analysis.of_strength:
            return f"{'stands' if ends.fails is None else 'fails'} at both {self._named(low)} and {high:.6g}"
        if ends.fails is None:
            return f"no failure up to F = {high:g}"
        return f"fails even at F = {low:g}"

    def _past(self, value: float) -> float:
        """Return how far a value lies beyond what limit analysis proved impossible; negative: not beyond, or not
        known.
        """
        if not isinstance(self.known, Bound):
            return -math.inf
        return (value - self.known.impossible) * math.copysign(1.0, self.known.impossible - self.known.carried)

    def _check(self, ends: Ends) -> bool:
        """Warn about a structure that fails as it is, and about answers that contradict each other.

        False: it stands where limit analysis proves that nothing can, and nothing explains that.
        """
        possible = True
        doubts = self.settings.doubts
        if self.analysis.of_strength and ends.fails is not None and ends.fails <= 1.0:
            self.warnings.append("it does not stand as it is: it fails at F = 1, with the strengths of the case")
        if not self.analysis.of_strength and ends.stands is not None:
            self.warnings += load_doubts(self.case, ends.stands)
        if bisection.changes(self.answers) > 1:
            tried = ", ".join(f"{v:.5g} {'stands' if s else 'fails'}" for v, s in sorted(self.answers.items()))
            self.warnings.append(f"not monotone: {tried}; the answer is the first failure from the side that stands")
        if isinstance(self.known, Bound) and ends.stands is not None:
            impossible = self.known.impossible
            if self._past(ends.stands) > doubts.beyond * abs(impossible):
                run = self.nearest_runs[ends.stands]
                possible = moved_into_it(run)
                above = f"it stands at {self._named(ends.stands)}, where limit analysis proves that nothing can "
                above += f"in the geometry of the start ({impossible:.5g} and beyond): "
                moved = f"its blocks have moved by {run.result.displacement:.3g} m" if possible else ""
                self.warnings.append(above + (moved or "do not trust this run"))
                self.above = {"bound": impossible, "displacement": run.result.displacement}
                self.above |= {"bound_where_it_rests": None, "explained": possible}
        if abs(self.closure) > doubts.closure:
            self.warnings.append(f"the energy does not close: {self.closure:.2%} is missing; do not trust this run")
        return possible

    def _answer(self, status: str, ends: Ends) -> dict[str, Any]:
        bracket = sorted(end for end in ends if end is not None) if None not in ends else None
        of_strength = self.analysis.of_strength
        name = "safety_factor" if of_strength else "critical_value"
        found = ends.stands if status in ("ok", ABOVE) else None
        answer: dict[str, Any] = {"status": status, "vary": self.analysis.vary}
        answer |= {name: found, f"{name}_bracket": bracket, "stands_at": ends.stands, "fails_at": ends.fails}
        if of_strength:
            there = {key for table in self.case.joints.values() for key in strengths(table)}
            answer["reduce"] = [key for key in self.analysis.reduce if key in there]
            if found is not None:
                answer["strengths_needed"] = {
                    joint: strengths(table) for joint, table in weaker(self.case, found).joints.items()
                }
        failing = self.nearest_runs.get(ends.fails) if ends.fails is not None else None
        if failing is not None:
            answer |= failing.result.mechanism
            answer["proof_of_failure"] = failing.result.proof or {"why": failing.result.why}
        answer["load"] = self.analysis.constant_load
        if self.known is not None:
            answer["limit_analysis"] = self.known.summary() if isinstance(self.known, Bound) else {"note": self.known}
        if self.above:
            answer["above_the_bound"] = self.above
        answer["runs"] = self.runs
        return answer

    def _facts(self, ends: Ends) -> dict[str, Any]:
        """Return how the answer was obtained; joints and contacts are those of the structure next to failure."""
        run = next(iter(self.nearest_runs.values()), None)
        return {
            "joints": run.sim.first_joints if run else None,
            "contacts": run.sim.first_points if run else None,
            "kinematics": run.sim.kinematics if run else None,
            "steps": self.steps,
            "time_step": 1.0,
            "solve_seconds": time.perf_counter() - self.started - self.compiling,
            "compile_seconds": self.compiling,
            "energy_closure": self.closure,
            "skipped": run.job.skipped if run else [],
            "warnings": self.warnings,
        }

    # -- what is to be seen ------------------------------------------------------------------------

    def _show(self, ends: Ends, follow: float) -> None:
        """Hand over rows and frames of the last standing and the first failing structure, and its collapse."""
        standing, failing = (self.nearest_runs.get(v) if v is not None else None for v in ends)
        base = failing or standing
        if base is None:
            return
        if base.model is not self.model:
            self.observer.structure(base.model)
        if standing is not None and standing.model.n_blocks == base.model.n_blocks:
            self._hand_over(standing, base)
        if failing is None:
            return
        if follow == 0.0:
            self._hand_over(failing, base)
            return
        quiet = fall(failing, self.observer, follow, self.case.output.snapshots)
        if quiet is not None:
            self.warnings.append(f"the collapse was not followed to its end: {quiet}")

    def _hand_over(self, run: StaticRun, base: StaticRun) -> None:
        """Hand over rows, and the frame as a displacement from the structure that is drawn."""
        for row in run.rows:
            self.observer.row(row)
        if self.case.output.snapshots == 0:
            return
        frame, shift = run.frame, base.model.centroids - run.model.centroids
        contacts = frame.contacts
        moved = contacts._replace(points=contacts.points + shift[contacts.blocks[:, 0]])
        self.observer.frame(frame._replace(positions=frame.positions + shift, contacts=moved))
