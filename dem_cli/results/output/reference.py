"""Compare results with reference values: one verdict per `[reference]` table of the case."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.results.output.scalars import scalars

Value = float | int | str | bool | None
STRENGTH = "strength"  # what a safety analysis varies where it does not vary a key
TOLD_BY = ("status", "safety_factor", "stands_at", "fails_at")  # quantities of references that expect a fall, or not


class ReferenceTable(Protocol):
    """Reference table as the comparison needs it."""

    @property
    def path(self) -> str:
        """Key of the summary that is compared."""

    @property
    def expected(self) -> bool | float | tuple[float, ...] | str:
        """Expected value, interval, or loads of a curve."""

    @property
    def displacements(self) -> tuple[float, ...] | None:
        """Displacements of a reference curve [m]; None of anything else."""

    @property
    def allowance(self) -> float | None:
        """Absolute tolerance of a number."""

    @property
    def kind(self) -> str:
        """Kind of the reference."""

    @property
    def missed(self) -> str | None:
        """Reason why the case declares this reference as missed; None: it is to be met."""


def verdicts(summary: Mapping[str, Any], references: Sequence[ReferenceTable]) -> list[dict[str, Any]]:
    """Compare a summary with all references; returns the verdicts of summary.json.

    value, tolerance and passed, as the contract of `dem run` has them; quantity, kind, found; `missed`, why the case
    says that this is missed; `problem`, why there is nothing to compare.
    """
    known = scalars(summary)
    return [
        verdict(known, one) if one.displacements is None else curve_verdict(summary.get(one.path), one)
        for one in references
    ]


def verdict(known: Mapping[str, Value], reference: ReferenceTable) -> dict[str, Any]:
    """Compare one reference with the values of a summary by their paths."""
    found = known.get(reference.path)
    value = list(reference.expected) if isinstance(reference.expected, tuple) else reference.expected
    answer = {
        "value": value,
        "tolerance": reference.allowance,
        "passed": passes(found, reference.expected, reference.allowance),
        "quantity": reference.path,
        "kind": reference.kind,
        "found": found,
    }
    if reference.missed is not None:
        answer["missed"] = reference.missed
    problem = why_nothing(known, reference)
    return answer | ({"problem": problem} if problem else {})


def curve_verdict(curve: Any, reference: ReferenceTable) -> dict[str, Any]:
    """Compare a reference curve with the curve of a summary: `displacements` and `loads`.

    found: our loads at its displacements, between the points of ours in proportion. What counts is mean_error, the mean
    size of the differences; it and largest_error, that of largest size with its sign, are in the unit of the loads.
    """
    loads, places = np.array(reference.expected, float), np.array(reference.displacements, float)
    answer: dict[str, Any] = {
        "value": loads.tolist(), "displacements": places.tolist(), "tolerance": reference.allowance, "passed": False,
        "quantity": reference.path, "kind": reference.kind, "found": None,
    }  # fmt: skip
    if reference.missed is not None:
        answer["missed"] = reference.missed
    if not isinstance(curve, Mapping) or "loads" not in curve:
        return answer | {"problem": f"the summary has no '{reference.path}': only control = 'displacement' finds one"}
    ours = np.maximum.accumulate(np.array(curve["displacements"], float))  # of a monitor that turns back: its way out
    end = float(ours[-1])
    if end < places.max():
        return answer | {"problem": f"the curve ends at {end:.3g} m, before {places.max():.3g} m of the reference"}
    found = np.interp(places, ours, curve["loads"])
    differences = found - loads
    mean = float(np.abs(differences).mean())
    answer |= {"mean_error": mean, "largest_error": float(differences[np.abs(differences).argmax()])}
    return answer | {"found": found.tolist(), "passed": mean <= (reference.allowance or 0.0)}


def passes(found: Value, expected: bool | float | tuple[float, ...] | str, allowance: float | None) -> bool:
    """Test whether a found value matches the expected one; no value never does."""
    if isinstance(expected, (bool, str)):
        return type(found) is type(expected) and found == expected
    off = error(found, expected)
    return off is not None and abs(off) <= (allowance or 0.0)


def error_of(answer: Mapping[str, Any]) -> float | None:
    """Return the error of a verdict: of a curve the mean size of its differences, else `error`."""
    return answer.get("mean_error") if "displacements" in answer else error(answer["found"], answer["value"])


def error(found: Value, expected: bool | float | tuple[float, ...] | list[float] | str) -> float | None:
    """Return the signed error of a number beyond the expected value or interval; None of anything else."""
    if isinstance(expected, (bool, str)) or isinstance(found, (bool, str)) or found is None:
        return None
    low, high = expected if isinstance(expected, (list, tuple)) else (expected, expected)
    return min(found - low, 0.0) + max(found - high, 0.0)


def why_nothing(known: Mapping[str, Value], reference: ReferenceTable) -> str | None:
    """Return the reason why there is nothing to compare; None where there is something."""
    if reference.path in known:
        found, wanted = known[reference.path], _sort(reference.expected)
        fits = found is None or _sort(found) == wanted
        return None if fits else f"'{reference.path}' is {_sort(found)}, not {wanted}"
    if reference.path == "failure_load":
        return "this kind of analysis has no failure load"
    close = difflib.get_close_matches(reference.path, known, 1, 0.6)
    hint = f", did you mean '{close[0]}'?" if close else ""
    below = [path for path in known if path.startswith(f"{reference.path}.")]
    hint = f", but {', '.join(repr(path) for path in below[:3])}" if below else hint
    return f"the summary has no '{reference.path}'{hint}"


def as_declared(answer: Mapping[str, Any]) -> bool:
    """Test whether a verdict is as declared: passed, or missed where the case declares that."""
    return "problem" not in answer and bool(answer["passed"]) != ("missed" in answer)


def in_summary(answers: Sequence[Mapping[str, Any]]) -> Any:
    """Return the key `reference` of summary.json: value, tolerance and passed of one plain failure load; else a
    list.
    """
    if len(answers) != 1:
        return list(answers)
    (answer,) = answers
    plain = answer["quantity"] == "failure_load" and answer["kind"] == "exact"
    short = plain and not {"missed", "problem"} & set(answer) and isinstance(answer["value"], float)
    return {key: answer[key] for key in ("value", "tolerance", "passed")} if short else answer


def from_summary(reference: Any) -> list[dict[str, Any]]:
    """Return the verdicts in the key `reference` of a summary; none where it has none."""
    if not reference:
        return []
    answers = reference if isinstance(reference, list) else [reference]
    return [{"quantity": "failure_load", "kind": "exact", **answer} for answer in answers]


def unexpected_fall(summary: Mapping[str, Any], references: Sequence[Mapping[str, Any]]) -> bool:
    """Test whether a structure fails under its given loads alone although no reference of its case says so.

    That is the status of any kind of analysis, or a safety analysis that proved failure at the strengths of the case.
    references: verdicts; one that is about how the run ended has the last word.
    """
    fails_at = summary.get("fails_at") if summary.get("vary") == STRENGTH else None
    falls = summary["status"] in (FALLS, BUCKLED) or (fails_at is not None and fails_at <= 1.0)
    return falls and not any(answer["quantity"] in TOLD_BY for answer in references)


def _sort(value: Any) -> str:
    """Name the type of a value in words."""
    return "true or false" if isinstance(value, bool) else "a word" if isinstance(value, str) else "a number"
