"""kind = "safety": by which factor strengths may fall, or how thin a structure may be, before it fails.

Every value is a run of its own (solve/safety_trial.py); the search only says which value comes next. What it reports is
the last value proven to stand and the first proven to fail.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from dem_cli.case.vary import impossible, value_at, with_value
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.laws.strength import reduced, strengths
from dem_cli.model.assemble import assembly
from dem_cli.model.model import Model
from dem_cli.model.validate import problems
from dem_cli.output.record import Observer
from dem_cli.solve import bisection
from dem_cli.solve.audit import CLOSURE
from dem_cli.solve.bisection import Ends, Scale, Undecided
from dem_cli.solve.run import Outcome
from dem_cli.solve.safety_bound import Bound, bound
from dem_cli.solve.safety_trial import Told, decide, fall
from dem_cli.solve.trial import OnlyProgress

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.solve.safety_table import SafetyAnalysis

UNLIMITED = ("elastic",)  # laws without any strength
BEYOND = 0.005  # of the value, that a structure may stand beyond what limit analysis proved impossible
NOT_CONVERGED = "not converged"


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Outcome of a safety analysis. Raises CaseError where nothing can be varied as the case says."""
    return Study(case, model, observer).run()


class Study:
    """All runs of a safety analysis."""

    def __init__(self, case: Case, model: Model, observer: Observer):
        self.case, self.model, self.observer = case, model, observer
        self.analysis: SafetyAnalysis = case.analysis
        self.scale = scale_of(case)
        self.started, self.compiling = time.perf_counter(), 0.0
        self.told: dict[float, Told] = {}  # only of the values next to the answer
        self.runs: list[dict[str, Any]] = []
        self.answers: dict[float, bool] = {}
        self.warnings: list[str] = []
        self.steps, self.closure = 0, 0.0

    def run(self) -> Outcome:
        """Limit analysis where it can tell, then the runs, then what is to be seen of them."""
        known = self._bound()
        guess = Ends(known.carried, known.impossible) if isinstance(known, Bound) else None
        start = min(max(1.0, self.scale.low), self.scale.high) if self.analysis.of_strength else None
        status, ends = "ok", Ends(None, None)
        try:
            ends = bisection.search(
                self._stands, self.scale, self.analysis.resolution, guess, self.analysis.scan, start
            )
        except Undecided as undecided:
            ends = self._nearest()
            what = self._named(undecided.value)
            status = f"{NOT_CONVERGED}: neither equilibrium nor failure was proven at {what}"
        if status == "ok" and None in ends:
            status = self._nowhere(ends)
        self._check(ends, known)
        self._show(ends)
        return Outcome(self._answer(status, ends, known) | self._facts(ends))

    # -- runs --------------------------------------------------------------------------------------

    def variant(self, value: float) -> tuple[Case, Model]:
        """Case and model at a value."""
        if self.analysis.of_strength:
            return weaker(self.case, value), self.model
        case = changed(self.case, self.analysis.vary, value)
        return case, checked_model(case, value)

    def _stands(self, value: float) -> bool:
        """Whether the structure stands at a value; each is run once. Raises Undecided."""
        if value not in self.answers:
            self._run(value)
        return self.answers[value]

    def _run(self, value: float) -> None:
        text = f"{len(self.runs) + 1}. run: {self._named(value)}"
        self.observer.progress(text, math.nan, math.nan, None)
        try:
            told = decide(*self.variant(value), OnlyProgress(self.observer), value)
        except CaseError as error:  # both ends of the range are possible
            self.warnings.append(str(error))
            raise Undecided(value) from None
        self.steps += told.run.steps
        self.compiling += told.job.clock.compiling
        self.runs.append(told.run.summary())
        self.warnings += [text for text in told.job.warnings if text not in self.warnings]
        if told.run.stands is None:
            self.warnings.append(f"{self._named(value)}: {told.run.why}")
            raise Undecided(value)
        self.answers[value] = told.run.stands
        if told.run.stands:
            self.closure = max(self.closure, told.run.closure, key=abs)
        self.told[value] = told
        near = {v for v in self._nearest() if v is not None}
        self.told = {v: kept for v, kept in self.told.items() if v in near}

    def _nearest(self) -> Ends:
        """The values tried that are next to the change."""
        tried = sorted(self.answers.items())
        return bisection.first_change(tried) if tried else Ends(None, None)

    def _bound(self) -> Bound | str | None:
        if not self.analysis.limit:
            return None
        self.observer.progress("limit analysis", 0.0, 0.0, None)
        return bound(self.variant, self.scale, self.analysis.resolution)

    # -- what they say -----------------------------------------------------------------------------

    def _named(self, value: float) -> str:
        return f"F = {value:.5g}" if self.analysis.of_strength else f"{self.analysis.vary} = {value:.6g}"

    def _nowhere(self, ends: Ends) -> str:
        """The status where all values have the same end."""
        low, high = self.scale.low, self.scale.high
        if not self.analysis.of_strength:
            return f"{'stands' if ends.fails is None else 'fails'} at both {self._named(low)} and {high:.6g}"
        if ends.fails is None:
            return f"no failure up to F = {high:g}: strength does not decide"
        return f"fails even at F = {low:g}, with {1.0 / low:.4g} times the strength: strength does not decide"

    def _check(self, ends: Ends, known: Bound | str | None) -> None:
        """Words about answers that contradict each other."""
        if bisection.changes(self.answers) > 1:
            tried = ", ".join(f"{v:.5g} {'stands' if s else 'fails'}" for v, s in sorted(self.answers.items()))
            self.warnings.append(
                f"not monotone: {tried}; the answer is the first failure from the side that stands"
            )
        if isinstance(known, Bound) and ends.stands is not None:
            past = (ends.stands - known.impossible) * math.copysign(1.0, known.impossible - known.carried)
            if past > BEYOND * abs(known.impossible):
                self.warnings.append(
                    f"it stands at {self._named(ends.stands)}, where limit analysis proves that nothing can "
                    f"({known.impossible:.5g} and beyond): do not trust this run"
                )
        if abs(self.closure) > CLOSURE:
            self.warnings.append(f"the energy does not close: {self.closure:.2%} is missing; do not trust this run")

    def _answer(self, status: str, ends: Ends, known: Bound | str | None) -> dict[str, Any]:
        bracket = sorted(ends) if None not in ends else None
        of_strength = self.analysis.of_strength
        name = "safety_factor" if of_strength else "critical_value"
        found = ends.stands if status == "ok" else None
        answer: dict[str, Any] = {"status": status, "vary": self.analysis.vary}
        answer |= {name: found, f"{name}_bracket": bracket, "stands_at": ends.stands, "fails_at": ends.fails}
        if of_strength:
            answer["reduce"] = list(self.analysis.reduce)
            if found is not None:
                answer["strengths_needed"] = {
                    joint: strengths(table) for joint, table in weaker(self.case, found).joints.items()
                }
        failing = self.told.get(ends.fails) if ends.fails is not None else None
        if failing is not None:
            answer |= failing.run.mechanism
            answer["proof_of_failure"] = failing.run.proof or {"why": failing.run.why}
        answer["load"] = self.analysis.constant_load
        if known is not None:
            answer["limit_analysis"] = known.summary() if isinstance(known, Bound) else {"note": known}
        answer["runs"] = self.runs
        return answer

    def _facts(self, ends: Ends) -> dict[str, Any]:
        """How it was obtained; joints and contacts are those of the structure next to failure."""
        told = next(iter(self.told.values()), None)
        return {
            "joints": told.sim.first_joints if told else None,
            "contacts": told.sim.first_points if told else None,
            "kinematics": told.sim.kinematics if told else None,
            "steps": self.steps,
            "time_step": 1.0,
            "solve_seconds": time.perf_counter() - self.started - self.compiling,
            "compile_seconds": self.compiling,
            "energy_closure": self.closure,
            "skipped": told.job.skipped if told else [],
            "warnings": self.warnings,
        }

    # -- what is to be seen ------------------------------------------------------------------------

    def _show(self, ends: Ends) -> None:
        """Rows and frames of the last structure that stands and of the first that fails, and its collapse."""
        standing, failing = (self.told.get(v) if v is not None else None for v in ends)
        base = failing or standing
        if base is None:
            return
        if base.model is not self.model:
            self.observer.structure(base.model)
        if standing is not None and standing.model.n_blocks == base.model.n_blocks:
            self._hand_over(standing, base)
        if failing is None:
            return
        if self.analysis.follow == 0.0:
            self._hand_over(failing, base)
            return
        quiet = fall(failing, self.observer, self.analysis.follow, self.case.output.frames)
        if quiet is not None:
            self.warnings.append(f"the collapse was not followed to its end: {quiet}")

    def _hand_over(self, told: Told, base: Told) -> None:
        """Rows, and the frame as a displacement of the structure that is drawn."""
        for row in told.rows:
            self.observer.row(row)
        if self.case.output.frames == 0:
            return
        frame, shift = told.frame, base.model.centroids - told.model.centroids
        contacts = frame.contacts
        moved = contacts._replace(points=contacts.points + shift[contacts.blocks[:, 0]])
        self.observer.frame(frame._replace(positions=frame.positions + shift, contacts=moved))


def scale_of(case: Case) -> Scale:
    """The values that a case asks for. Raises CaseError where they are impossible."""
    analysis: SafetyAnalysis = case.analysis
    low, high = analysis.ends
    if analysis.of_strength:
        _check_strengths(case)
        return Scale(low, high, ratio=True)
    now = value_at(case, analysis.vary)
    whole = isinstance(now, int)
    if whole and not (low.is_integer() and high.is_integer()):
        message = f"[{low:g}, {high:g}] is not allowed; {analysis.vary} = {now} is a whole number"
        raise CaseError([CaseProblem(("analysis", "between"), message)])
    for end in (low, high):
        checked_model(changed(case, analysis.vary, end), end)
    return Scale(low, high, ratio=False, whole=whole)


def expected(case: Case) -> tuple[int, int]:
    """Fewest and most runs that are likely: two next to the guess of limit analysis, or a bisection of the range."""
    analysis, scale = case.analysis, scale_of(case)
    width = math.log(scale.high / scale.low) if scale.ratio else (scale.high - scale.low) / max(abs(scale.high), abs(scale.low))
    finest = 1.0 / (scale.high - scale.low) if scale.whole else analysis.resolution
    return 2 + analysis.scan, 2 + analysis.scan + math.ceil(math.log2(max(width / finest, 1.0)))


def changed(case: Case, key: str, value: float) -> Case:
    """The case with another value of a key, a whole number where it is one."""
    return with_value(case, key, int(value) if isinstance(value_at(case, key), int) else value)


def checked_model(case: Case, value: float) -> Model:
    """The model of a changed case. Raises CaseError, at analysis.between, where it is no structure."""
    try:
        made = assembly(case)
        found = problems(case, made.model, made.blocks)
    except CaseError as error:
        found = list(error.problems)
    if found:
        raise impossible(f"{case.analysis.vary} = {value:.6g}", found)
    return made.model


def weaker(case: Case, factor: float) -> Case:
    """The case with strengths divided by a factor. Raises CaseError where a law does not allow what comes out."""
    joints = {}
    for name, joint in case.joints.items():
        try:
            joints[name] = reduced(joint, factor, case.analysis.reduce)
        except ValidationError as error:
            said = error.errors(include_url=False)[0]["msg"].removeprefix("Value error, ")
            raise impossible(f"F = {factor:.5g}", [CaseProblem(("joints", name), said)]) from None
    return case.model_copy(update={"joints": joints})


def _check_strengths(case: Case) -> None:
    """Raises CaseError where a factor would change nothing, or cannot be put into a joint."""
    which = case.analysis.reduce
    for name, joint in case.joints.items():
        if joint.law not in UNLIMITED and not strengths(joint):
            message = f"'{joint.law}' has no friction, cohesion or tension that a factor divides; vary one of its keys"
            raise CaseError([CaseProblem(("joints", name, "law"), message)])
    if not any(strengths(joint).get(key) for joint in case.joints.values() for key in which):
        listed = " or ".join(which)
        raise CaseError([CaseProblem(("analysis", "reduce"), f"no joint has any {listed} that could be reduced")])
    for factor in case.analysis.ends:
        weaker(case, factor)
