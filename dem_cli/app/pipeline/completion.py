"""Complete the summary of a run: progress of a stopped one, verdicts, names, times."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase
    from dem_cli.core.model.model import Model
    from dem_cli.results.output.store import ResultWriter

# What a run that was stopped does not know, by kind.
ANSWERS = {
    "pushover": ("failure_load", "failure_load_bracket", "failure_mode", "displacement_at_failure"),
    "time-history": ("collapsed", "collapse_time", "ending"),
    "safety": ("safety_factor", "safety_factor_bracket", "critical_value", "critical_value_bracket"),
    "fragility": ("median", "dispersion", "collapse_intensities"),
}


def stopped(status: str, writer: ResultWriter, warnings: list[str]) -> dict[str, Any]:
    """Create the summary of a run that did not reach its end."""
    last = writer.last_row or writer.last_frame
    reached = last and {"stage": last.stage, "load": last.load, "displacement": last.displacement}
    if last and writer.kind == "time-history":
        reached = {"stage": last.stage, "time": last.time, "displacement": last.displacement}
    points = writer.last_frame.contacts.joint if writer.last_frame else None
    unknown = ANSWERS.get(writer.kind, ANSWERS["pushover"])
    return {
        "status": status,
        **dict.fromkeys(unknown),
        "reached": reached,
        "joints": None if points is None else len(set(points.tolist())),
        "contacts": None if points is None else len(points),
        "steps": last.step if last else 0,
        "time_step": None,
        "solve_seconds": None,
        "energy_closure": None,
        "warnings": warnings,
    }


def completed(found: dict[str, Any], loaded: LoadedCase, model: Model, started: float) -> dict[str, Any]:
    """Add everything to the summary that does not come from the solver."""
    from dem_cli.results.output.reference import in_summary, verdicts
    from dem_cli.results.output.summary import ordered

    case = loaded.case
    summary = dict(found)
    summary |= {"title": case.title or loaded.name, "kind": case.analysis.kind, "version": __version__}
    summary["blocks"] = model.n_blocks
    summary["warnings"] = [*loaded.warnings, *found.get("warnings", ())]
    if case.compared and found["status"] != "interrupted":
        summary["reference"] = in_summary(verdicts(summary, case.compared))
    summary["wall_seconds"] = time.perf_counter() - started
    return ordered(summary)


def with_names(found: dict[str, Any], names: Sequence[str], quantities: Sequence[str]) -> dict[str, Any]:
    """Name the peaks of repeats by their monitors and add units."""
    repeats = found.get("repeats")
    if not repeats or "peaks" not in repeats:
        return found
    from dem_cli.core.records.history_rows import MONITOR_UNITS

    spreads = [
        spread and spread | {"unit": MONITOR_UNITS[q]} for spread, q in zip(repeats["peaks"], quantities, strict=True)
    ]
    return found | {"repeats": repeats | {"peaks": dict(zip(names, spreads, strict=True))}}
