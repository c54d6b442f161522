"""Capacity curves and their checks in words: peak, end, bilinear system, demand of a spectrum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dem_cli.app.cli.words.numbers import load_text, metres

Rows = list[tuple[str, str]]
MOST_LOADS = 6  # at displacements, in one line


def curve_rows(summary: Mapping[str, Any]) -> Rows:
    """Return label and text of each line of a capacity curve; empty for runs without one."""
    rows: Rows = []
    curve = summary.get("capacity_curve")
    if curve:
        peak, last = load_text(curve["peak_load"]), load_text(curve["last_load"])
        share = curve.get("residual_share")
        rest = "" if share is None else f", {100.0 * share:.0f} % of it"
        of = "" if curve.get("of") is None else f" of {curve['of']}"
        rows.append(("capacity curve", f"peak {peak} at {metres(curve['peak_displacement'])}{of}"))
        rows.append(("", f"{last} in the end, at {metres(curve['last_displacement'])}{rest}".replace("-", "−")))
        rows += _system(curve.get("bilinear"))
        listed = curve.get("loads_at") or []
        if listed:
            text = ", ".join(
                f"{load_text(one['load'])} at {metres(one['displacement'])}" for one in listed[:MOST_LOADS]
            )
            rows.append(("loads", text + (", …" if len(listed) > MOST_LOADS else "")))
    rows += _check(summary.get("check") or {})
    return rows + _loops(summary.get("loops") or [])


def _system(system: Mapping[str, Any] | None) -> Rows:
    if not system:
        return []
    end = f"where {100 * system['drop']:g} % of the peak is left" if system["softened"] else "the end of the curve"
    text = f"yields at {metres(system['yield_displacement'])} with {load_text(system['yield_load'])}, ultimate "
    text += f"{metres(system['ultimate_displacement'])} ({end}), ductility {system['ductility']:.3g}"
    text += "; elastic part: joints of the solver's choice" if system.get("automatic_joints") else ""
    return [("bilinear", text)]


def _check(found: Mapping[str, Any]) -> Rows:
    """Describe the check against a spectrum."""
    if not found:
        return []
    asked, has = metres(found["target_displacement"]), metres(found["displacement_capacity"])
    text = f"asks for {asked} of {has}, {100 * found['demand_over_capacity']:.3g} %; "
    text += f"capacity at a ground acceleration of {found['ground_acceleration_at_capacity']:.3g} m/s²"
    if found["method"] == "n2":
        return [("N2", f"T* {found['period']:.3g} s, q {found['force_ratio']:.3g}: {text}")]
    first = (
        f"activated at {found['activation_acceleration']:.3g} m/s², {found['required_acceleration']:.3g} m/s² needed"
    )
    return [("mechanism", f"{first}, {100 * found['linear_demand_over_capacity']:.3g} %"),
            ("", f"T_s {found['period']:.3g} s: {text}")]  # fmt: skip


def _loops(loops: list[Mapping[str, Any]]) -> Rows:
    shown = [f"{one['energy']:.3g} J, damping {100 * one['damping']:.3g} %" for one in loops[:MOST_LOADS]]
    return [("loops", "; ".join(shown) + ("; …" if len(loops) > MOST_LOADS else ""))] if shown else []
