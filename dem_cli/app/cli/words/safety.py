"""Safety factors in words: the factor or the value, its bracket, and the deciding runs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

Rows = list[tuple[str, str]]
STRENGTH_UNITS = {"friction": "", "cohesion": " Pa", "tension": " Pa"}
NO_CHANGE = ("no failure", "fails even")  # how the status begins where all factors end alike
MOST_JOINTS = 8  # joints that are listed


def safety_rows(summary: Mapping[str, Any]) -> Rows:
    """Return label and text of each line of a safety analysis; empty for other runs."""
    if summary.get("kind") != "safety" or "runs" not in summary:
        return []
    rows = _answer(summary) + _needed(summary)
    limit = summary.get("limit_analysis")
    if limit:
        text = str(limit.get("note", "")).removeprefix("limit analysis ") or (
            f"proves that nothing stands at {limit['impossible_at']:.6g}, finds forces in equilibrium at "
            f"{limit['carried_at']:.6g}"
        )
        rows.append(("limit analysis", text))
    runs = summary["runs"]
    stand, fall = (sum(run["stands"] is answer for run in runs) for answer in (True, False))
    undecided = len(runs) - stand - fall
    text = f"{len(runs)}: {stand} stand, {fall} fail" + (f", {undecided} undecided" if undecided else "")
    rows.append(("runs", text + (f"; {limit['programs']} linear programs" if limit and "programs" in limit else "")))
    return rows


def _answer(summary: Mapping[str, Any]) -> Rows:
    of_strength = summary["vary"] == "strength"
    value = summary.get("safety_factor" if of_strength else "critical_value")
    stands, fails = summary.get("stands_at"), summary.get("fails_at")
    label = "safety factor" if of_strength else "critical value"
    name = "F" if of_strength else summary["vary"]
    known = [f"{word} at {number:.5g}" for word, number in (("stands", stands), ("fails", fails)) if number is not None]
    rows = [] if value is None else [(label, f"{value:.5g}" + (f"  (fails at {fails:.5g})" if fails else ""))]
    if value is None and known:
        rows.append((name, ", ".join(known)))
    if of_strength and str(summary["status"]).startswith(NO_CHANGE):
        rows.append(("strength", _no_change(stands, fails)))
    if of_strength:
        rows.append(("divided by F", ", ".join(summary["reduce"])))
    elif stands is not None and fails is not None:
        rows.append(("varied", f"{name}, stands {'above' if stands > fails else 'below'}"))
    if summary.get("load") and summary["vary"] != "analysis.load":
        rows.append(("under", f"live load × {summary['load']:g}"))
    return rows


def _no_change(stands: float | None, fails: float | None) -> str:
    """Describe the result where all tried factors end alike."""
    from dem_cli.case.tables.safety import FACTORS

    if (stands or 0.0) >= FACTORS[1] or (fails or math.inf) <= FACTORS[0]:
        return "does not decide: geometry and loads do"
    return f"decides {'above' if fails is None else 'below'} analysis.between, if at all: give it a wider range"


def _needed(summary: Mapping[str, Any]) -> Rows:
    """Describe the strengths at which the structure just stands."""
    rows = []
    for joint, values in list((summary.get("strengths_needed") or {}).items())[:MOST_JOINTS]:
        text = ", ".join(f"{name} {value:.4g}{STRENGTH_UNITS[name]}" for name, value in values.items())
        if text:
            rows.append(("just stands", f"'{joint}': {text}"))
    return rows
