"""Write summary.json: the answer and how it was obtained, in a fixed order and in strict JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.core.records.statuses import ABOVE
from dem_cli.results.output.folder import SUMMARY
from dem_cli.results.output.scalars import plain

ORDER = (
    "title",
    "kind",
    "version",
    "status",
    "failure_load",
    "failure_load_bracket",
    "failure_mode",
    "displacement_at_failure",
    "capacity_curve",
    "check",
    "highest_load",
    "lowest_load",
    "turning_points",
    "loops",
    "moved_far",
    "settlement_at_collapse",
    "vary",
    "safety_factor",
    "safety_factor_bracket",
    "critical_value",
    "critical_value_bracket",
    "collapsed",
    "collapse_time",
    "fallen_blocks",
    "ending",
    "at_rest",
    "followed",
    "contradictions",
    "peaks",
    "monitors",
    "joint_state",
    "after_collapse",
    "repeats",
    "median",
    "dispersion",
    "confidence",
    "records",
    "collapse_intensities",
    "energy_shares",
    "limit_analysis",
    "no_bound",
    "bound_where_it_rests",
    "above_the_bound",
    "certificates",
    "reference",
    "blocks",
    "joints",
    "contacts",
    "steps",
    "time_step",
    "solve_seconds",
    "solve_cpu_seconds",
    "wall_seconds",
    "energy_closure",
    "reweighting",
    "warnings",
)


def ordered(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Order a summary: known keys first, the rest as it came; all values plain and finite or None."""
    keys = [key for key in ORDER if key in summary] + [key for key in summary if key not in ORDER]
    return {key: plain(summary[key]) for key in keys}


def to_json(summary: Mapping[str, Any]) -> str:
    """Format a summary as one JSON object, a key per line."""
    return json.dumps(ordered(summary), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_summary(folder: Path, summary: Mapping[str, Any]) -> None:
    """Write a summary atomically."""
    part = folder / f".{SUMMARY}.part"
    part.write_text(to_json(summary), encoding="utf-8", newline="\n")
    part.replace(folder / SUMMARY)


def exit_code(summary: Mapping[str, Any]) -> int:
    """Return the exit code of `dem run`: 0 solved, 1 outside a reference, above its bound or does not stand, 3 gave up,
    130 interrupted.
    """
    status = str(summary["status"])
    if status == "interrupted":
        return 130
    if status.startswith("not converged"):
        return 3
    from dem_cli.results.output.reference import as_declared, from_summary, unexpected_fall

    answers = from_summary(summary.get("reference"))
    return 1 if status == ABOVE or unexpected_fall(summary, answers) or not all(map(as_declared, answers)) else 0
