"""Natural frequencies in words: a table, and the calibrated joint stiffness for [joints]."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MOST_LINES = 20  # lines of the table


def mode_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and text of each line of a modal analysis; empty for other runs."""
    frequencies = summary.get("frequencies")
    if frequencies is None:
        return []
    total, masses = summary["total_mass"], summary["effective_masses"]
    rows = []
    for i, frequency in enumerate(frequencies[:MOST_LINES]):
        shares = "  ".join(f"{axis} {100 * values[i] / total:5.1f} %" for axis, values in masses.items())
        rows.append((f"mode {i + 1}", f"{frequency:10.4g} Hz   mass along {shares}"))
    if len(frequencies) > MOST_LINES:
        rows.append(("", f"and {len(frequencies) - MOST_LINES} more in summary.json"))
    if not len(frequencies):
        return [("modes", "none: no joint holds any block")]
    sums = "  ".join(f"{axis} {100 * sum(values) / total:5.1f} %" for axis, values in masses.items())
    rows.append(("all of these", f"{'':13}   mass along {sums}"))
    rows += _springs(summary)
    return rows + _calibration(summary.get("calibration"))


def _springs(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe the number of active contact points, and the effect of the others."""
    springs, first = summary["springs"], summary["first_frequency"]
    if springs["pressed"] == springs["touching"]:
        return [("springs", f"all {springs['pressed']:,} contact points that touch are pressed together")]
    values = {name: "–" if value is None else f"{value:.4g} Hz" for name, value in first.items()}
    text = (
        f"{springs['pressed']:,} of {springs['touching']:,} contact points that touch are pressed together; "
        f"mode 1: {values['pressed']} with these, {values['touching']} with all"
    )
    return [("springs", text)]


def _calibration(found: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    if not found:
        return []
    what = "calibrated" if found["met"] else "not met"
    rows = [(what, f"mode {found['mode']} at {found['measured']:g} Hz: kn and ks times {found['factor']:.4g}; write")]
    for name, values in found["joints"].items():
        points = f", points = {values['points']}" if "points" in values else ""
        rows.append((f"[joints.{name}]", f"kn = {values['kn']:.5g}, ks = {values['ks']:.5g}{points}"))
    rows += [(f"[materials.{name}]", f"young = {young:.5g}") for name, young in found.get("young", {}).items()]
    return rows
