"""Describe how a run ended: collapsed, stood, still moving, a load that was not found; for titles and reports."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dem_cli.core.records.statuses import COLLAPSED, MOVES, ROCKS, STOOD

MOVES_WORDS = "still moving at the end: whether it falls is not known, and a larger peak may follow"
_KNOWN = {STOOD: STOOD, ROCKS: f"stood, {ROCKS}", MOVES: MOVES_WORDS}


def ending_words(summary: Mapping[str, Any], digits: int = 4) -> str:
    """Describe the end of a run, its time, and contradictions; empty where a summary has none.

    digits: of the time of a collapse.
    """
    how = _how(summary, digits)
    return "; ".join([how, *(summary.get("contradictions") or ())]) if how else ""


def _how(summary: Mapping[str, Any], digits: int) -> str:
    """Describe the end of a run as recorded in its summary."""
    fell = summary.get("collapsed")
    how = summary.get("ending") or (None if fell is None else COLLAPSED if fell else STOOD)
    if how != COLLAPSED:
        return _KNOWN.get(str(how), "")
    at, after = summary.get("collapse_time"), summary.get("followed") or 0.0
    if at is None:
        return COLLAPSED
    return f"{COLLAPSED} at {at:.{digits}g} s" + (f", {after:.{digits - 1}g} s after the motion" if after else "")


def last_words(summary: Mapping[str, Any]) -> str:
    """Describe the time of the last monitor values: at rest, or still moving."""
    return "in the end" if summary.get("at_rest", True) else "at the end, still moving"


def median_words(summary: Mapping[str, Any], digits: int = 4) -> str:
    """Format the median collapse intensity, or its bounds; empty where it is not known."""
    if summary.get("median") is not None:
        return f"{summary['median']:.{digits}g}"
    between = summary.get("median_between")
    if not between:
        return ""
    low, high = between
    if high is None:
        return f"above {low:.{digits}g}"
    return f"between {low:.{digits}g} and {high:.{digits}g}" if low else f"below {high:.{digits}g}"


def unfound_load(summary: Mapping[str, Any]) -> str:
    """Describe the result of a search that ended without a failure load; empty where there is one, or no search."""
    bracket = summary.get("failure_load_bracket")
    if summary.get("status") != "not converged" or summary.get("failure_load") is not None or not bracket:
        return ""
    low = bracket[0]
    return "no equilibrium was proven" if low is None else f"it stands at {low:.4g}"
