"""Fragility curves and the spread of repeats in words, for the answer of `dem run`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dem_cli.results.output.ending import median_words

Rows = list[tuple[str, str]]
MOST_LISTED = 8  # levels, records or monitors that are listed


def fragility_rows(summary: Mapping[str, Any]) -> Rows:
    """Return label and text of each line of a fragility study or of repeats; empty for other runs."""
    if summary.get("kind") == "fragility":
        return _study(summary) if summary.get("collapse_intensities") else []
    return _repeats(summary["repeats"]) if summary.get("repeats") else []


def _study(summary: Mapping[str, Any]) -> Rows:
    unit = summary["unit_acceleration"]
    rows = [("intensity", f"peak ground acceleration over {unit:g} m/s²")]
    median = summary.get("median")
    if summary.get("median_between"):
        rows.append(("median", f"{median_words(summary)}: the levels do not resolve it"))
    elif median is None:
        rows.append(("collapse", "no median: " + _why_no_median(summary)))
    else:
        sure = summary.get("confidence")
        text = f"{median:.4g} ({median * unit:.3g} m/s²), dispersion {summary['dispersion']:.2g}"
        if sure:
            (low, high), (least, most) = sure["median"], sure["dispersion"]
            text += f"; {100 * sure['level']:.0f} % confidence {low:.4g} to {high:.4g}"
            text += f", of the dispersion {least:.2g} to {most:.2g}"
        rows.append(("median", text))
    found = [value for value in summary["collapse_intensities"] if value is not None]
    if found:
        never = len(summary["collapse_intensities"]) - len(found)
        text = f"{min(found):.4g} to {max(found):.4g}, mean {sum(found) / len(found):.4g}, {len(found)} records"
        if len(summary["collapse_intensities"]) == 1:
            stood = summary["stood_up_to"][0]
            text = f"{found[0]:.4g}" + (f", and it stood at {stood:.4g}" if stood else "") + "; 1 record"
        rows.append(("collapse at", text + (f"; {never} never collapsed" if never else "")))
    rows += _shares(summary)
    split = (summary.get("repeats") or {}).get("dispersion")
    if split:
        text = f"{split['records']:.2g} between records, {split['perturbation']:.2g} between perturbed structures"
        rows.append(("dispersion", text))
    rows += _non_monotone(summary["non_monotone"])
    before = f", {summary['runs_done_before']:,} of them before" if summary["runs_done_before"] else ""
    rows.append(("runs", f"{summary['runs']:,}{before}; {summary['seconds']:.3g} s of CPU"))
    if summary.get("still_moving"):
        rows.append(("not known", f"{summary['still_moving']} still moved in the end: neither standing nor fallen"))
    return rows


def _why_no_median(summary: Mapping[str, Any]) -> str:
    if all(value is None for value in summary["collapse_intensities"]):
        moving = summary.get("still_moving")
        known = "nothing collapsed as far as is known; a longer analysis.coda or" if moving else "nothing collapsed;"
        return f"{known} higher intensities are needed"
    if len(summary["collapse_intensities"]) == 1 and summary["stood_up_to"][0]:
        return "one record is one draw; more are needed"
    return "every record collapsed at the lowest intensity; lower ones are needed"


def _shares(summary: Mapping[str, Any]) -> Rows:
    """Describe the share that collapsed at each level of a grid."""
    levels = list(zip(summary.get("levels") or (), summary.get("share") or ()))
    if not levels:
        return []
    told = levels if len(levels) <= MOST_LISTED else [p for p in levels if p[1] not in (0.0, 1.0)][:MOST_LISTED]
    text = ", ".join(f"{100 * share:.0f} % at {level:g}" for level, share in told if share is not None)
    return [("share", text)] if text else []


def _non_monotone(found: list[dict[str, Any]]) -> Rows:
    """Describe records that a structure survived above a collapse."""
    rows = []
    for one in found[:MOST_LISTED]:
        who = one["record"] + (f", structure {one['structure']}" if one["structure"] else "")
        survived = ", ".join(f"{level:g}" for level in one["survived"])
        rows.append(("not monotone", f"{who}: collapsed at {one['collapsed']:g}, survived {survived}"))
    if len(found) > MOST_LISTED:
        rows.append(("", f"and {len(found) - MOST_LISTED} more in summary.json"))
    return rows


def _repeats(repeats: Mapping[str, Any]) -> Rows:
    """Describe the spread of the peaks over perturbed structures."""
    moving = repeats.get("still_moving")
    also = f", {moving} still moved in the end" if moving else ""
    rows = [("repeats", f"{repeats['collapsed']} of {repeats['runs']} perturbed structures collapsed{also}")]
    for name, spread in list(repeats["peaks"].items())[:MOST_LISTED]:
        if spread is None:
            rows.append(("", f"{name}: none of them stood"))
            continue
        text = f"median {spread['median']:.3g}, 16 to 84 % {spread['p16']:.3g} to {spread['p84']:.3g}"
        unit = spread["unit"]
        rows.append(("", f"{name}: {text}, all {spread['min']:.3g} to {spread['max']:.3g} {unit}, of those that stood"))
    return rows
