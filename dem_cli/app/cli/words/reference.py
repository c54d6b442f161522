"""Format the comparison with the `[reference]` of a case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def reference_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return a line for each reference of a run."""
    from dem_cli.results.output.reference import from_summary

    return [("reference", one_line(answer)) for answer in from_summary(summary.get("reference"))]


def one_line(answer: Mapping[str, Any]) -> str:
    """Format a verdict of results/output/reference.py; a failure load that was found stands above it."""
    if "displacements" in answer:
        return f"{curve_words(answer)}: {judged(answer)}"
    load = answer["quantity"] == "failure_load"
    found = "" if load or "found" not in answer else f"{answer['quantity']} is {shown(answer['found'])}, expected "
    return f"{found}{expected(answer)}: {judged(answer)}"


def expected(answer: Mapping[str, Any]) -> str:
    """Format an expected value: `0.64 ± 0.001`, `[0.3, 0.4] ± 0.01`, `ok` or `false`."""
    slack = f" ± {answer['tolerance']:.2g}" if answer["tolerance"] else ""
    return f"{shown(answer['value'])}{slack}"


def curve_words(answer: Mapping[str, Any]) -> str:
    """Format a curve verdict: `curve of 13 points, peak 102500: 8.7 % of that off on average, at most +45 %, 5 %
    allowed`.
    """
    peak = max(answer["value"])
    text = f"curve of {len(answer['value'])} points, peak {shown(peak)}"
    if "mean_error" not in answer:
        return text
    mean, most, allowed = (100.0 * answer[key] / peak for key in ("mean_error", "largest_error", "tolerance"))
    return f"{text}: {mean:.2g} % of that off on average, at most {most:+.2g} %, {allowed:.2g} % allowed"


def judged(answer: Mapping[str, Any]) -> str:
    """Format the verdict."""
    if "problem" in answer:
        return f"FAILED, {answer['problem']}"
    if "missed" in answer:
        return "FAILED, met but declared as missed" if answer["passed"] else f"missed, as known: {answer['missed']}"
    return "passed" if answer["passed"] else "FAILED"


def shown(value: Any) -> str:
    """Format a number, text, truth value or interval as in a case file, with six digits."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "–"}[value]
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(shown, value))}]"
    return value if isinstance(value, str) else f"{value:.6g}"
