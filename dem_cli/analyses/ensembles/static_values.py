"""Vary the structure of a safety analysis: weaker joints, or another value of a key."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pydantic import ValidationError

from dem_cli.analyses.ensembles.bisection import Scale
from dem_cli.case.variation import impossible, impossible_table, value_at, with_value
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.static_settings import SafetySettings
from dem_cli.core.laws.strength import reduced, strengths
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseError, CaseProblem, dotted
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.sanity import odd_loads
from dem_cli.masonry.assembly.validate import problems

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.tables.safety import SafetyAnalysis

UNLIMITED = ("elastic",)  # laws without any strength


def scale_of(case: Case, settings: SafetySettings = DEFAULT.safety) -> Scale:
    """Return the range of values of a safety analysis. Raises CaseError where they are impossible."""
    analysis: SafetyAnalysis = case.analysis
    low, high = analysis.ends
    if analysis.of_strength:
        _check_strengths(case)
        return Scale(low, high, ratio=True, nothing=settings.nothing)
    now = value_at(case, analysis.vary)
    whole = isinstance(now, int)
    if whole and not (low.is_integer() and high.is_integer()):
        message = f"[{low:g}, {high:g}] is not allowed; {analysis.vary} = {now} is a whole number"
        raise CaseError([CaseProblem(("analysis", "between"), message)])
    for end in (low, high):
        checked_model(changed(case, analysis.vary, end), end)
    return Scale(low, high, ratio=False, whole=whole, nothing=settings.nothing)


def expected(case: Case) -> tuple[int, int]:
    """Estimate the fewest and most runs: two next to the guess of limit analysis, or a bisection of the range."""
    analysis, scale = case.analysis, scale_of(case, DEFAULT.safety)
    largest = max(abs(scale.low), abs(scale.high))
    width = math.log(scale.high / scale.low) if scale.ratio else (scale.high - scale.low) / largest
    finest = 1.0 / largest if scale.whole else analysis.resolution
    return 2 + analysis.scan, 2 + analysis.scan + math.ceil(math.log2(max(width / finest, 1.0)))


def changed(case: Case, key: str, value: float) -> Case:
    """Return the case with another value of a key, rounded to an integer where it is one."""
    return with_value(case, key, int(value) if isinstance(value_at(case, key), int) else value)


def checked_model(case: Case, value: float) -> Model:
    """Create the model of a changed case. Raises CaseError, at analysis.between, where it is invalid."""
    try:
        made = assembly(case)
        found = problems(case, made.model, made.blocks)
    except CaseError as error:
        found = list(error.problems)
    if found:
        raise impossible(f"{case.analysis.vary} = {value:.6g}", found)
    return made.model


def load_doubts(case: Case, value: float) -> list[str]:
    """Warn about loads that do not follow the blocks of a changed case: they stay at the place given by `at`."""
    changed_case = changed(case, case.analysis.vary, value)
    found = [problem for problem in odd_loads(changed_case, assembly(changed_case).model) if "at" in problem.path]
    if not found:
        return []
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    where = dotted(found[0].path)
    return [
        f"at {case.analysis.vary} = {value:.6g}, {where}{more}: {found[0].message}; `at` does not follow the blocks"
    ]


def weaker(case: Case, factor: float) -> Case:
    """Divide all strengths of a case by a factor. Raises CaseError where a law does not allow the result."""
    joints = {}
    for name, joint in case.joints.items():
        try:
            joints[name] = reduced(joint, factor, case.analysis.reduce)
        except ValidationError as error:
            raise impossible_table(f"F = {factor:.5g}", ("joints", name), type(joint), error) from None
    return case.model_copy(update={"joints": joints})


def _check_strengths(case: Case) -> None:
    """Raise CaseError where a strength reduction has no effect, or cannot be applied to a joint."""
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
