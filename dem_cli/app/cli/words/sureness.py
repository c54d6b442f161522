"""Accuracy of a failure load in words: bracket, second histories, bound by limit analysis, energy, reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dem_cli.app.cli.words.limit_loads import WEDGED, wedged
from dem_cli.app.cli.words.numbers import load_text, seconds
from dem_cli.app.cli.words.reference import reference_rows

RAISED = "raised from gravity"  # a history of the explicit solver
IMPLICIT = "implicit history"  # start of a search that was led from gravity in implicit steps
STARTS = {"path": "the zero-dilation path", "limit": "the forces of limit analysis"}  # analysis.start


def sureness_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and text of each line on the accuracy of an answer and its search."""
    rows = []
    parts = _of_load(summary)
    if summary.get("energy_closure") is not None:
        parts.append(f"energy closes to {abs(summary['energy_closure']):.1g}")
    if parts:
        rows.append(("how sure", ", ".join(parts)))
    start = summary.get("start") or {}
    if start.get("kind") in STARTS and start.get("load") is not None:
        rows.append(
            ("started from", f"{STARTS[start['kind']]} at {load_text(start['load'])}, {seconds(start['seconds'])}")
        )
    if start.get("kind") == IMPLICIT:
        loads = f"{start['loads']} loads in implicit steps, {seconds(start['seconds'])}"
        raised = next(one["load"] for one in summary["histories"] if one["method"] == RAISED)
        rows.append(("from gravity", f"{loads}; motion step by step up to {load_text(raised)}, and at both ends"))
    limits = summary.get("limit_analysis") or {}
    known = [key for key in ("associated", "non_associated") if limits.get(key) is not None]
    if known:
        text = ", ".join(f"{load_text(limits[key])} {key.replace('_', '-')}" for key in known)
        rows.append(("limit analysis", text))
        if wedged(limits):
            rows.append(("", f"associated: {WEDGED}"))
    rests = summary.get("bound_where_it_rests")
    if rests:
        rows.append(("limit analysis", f"{load_text(rests['bound'])} associated, where blocks rest at this load"))
    if summary.get("no_bound"):
        rows.append(("no bound", str(summary["no_bound"])))
    return rows + reference_rows(summary)


def _of_load(summary: Mapping[str, Any]) -> list[str]:
    """Describe the bracket of the failure load, and its agreement with other methods."""
    load, bracket = summary.get("failure_load"), summary.get("failure_load_bracket")
    if not load or not bracket or None in bracket:
        return []
    within = f"±{50 * (bracket[1] - bracket[0]) / abs(load):.2g} %"
    spread = summary.get("load_range")
    if spread:
        between = f"histories from {load_text(spread['lowest'])} to {load_text(spread['highest'])}"
        return [f"{within} under this history", between]
    if summary.get("unique"):
        return [within, "no other load is possible"]
    agrees = any(history["finished"] for history in (summary.get("histories") or [])[1:])
    parts = [within, "a second history agrees"] if agrees else [f"{within} under this history"]
    bound = (summary.get("limit_analysis") or {}).get("associated")
    above = bound is not None and bound > 1.005 * bracket[1]
    return [*parts, f"no history carries more than {load_text(bound)}"] if above else parts
