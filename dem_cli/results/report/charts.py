"""Charts of a report page as plain JSON: lines, levels, bands, and the place of each frame of the view."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.results.output.reader import Results
from dem_cli.results.output.reference import from_summary
from dem_cli.results.output.series import BASE
from dem_cli.results.post import style
from dem_cli.results.post.capacity import capacity_axis, of_frames, off_the_load, with_breaks
from dem_cli.results.post.energy import across
from dem_cli.results.post.fragility import has_curve
from dem_cli.results.post.histories import curve, of_quantity, thinned
from dem_cli.results.report.packed_arrays import pack

Chart = dict[str, Any]
_ZOOM_FROM = 6.0  # the collapse goes this many times farther than failure: the chart opens with a look at failure
_MOST_MONITORS = 6
_ENERGY = {  # the colour of each entry, as energy.png has them
    "external": "0", "gravity": "5", "friction": "1", "dashpots": "6", "mass_damping": "4", "maxwell": "8",
    "damping": "9", "elastic": "2", "kinetic": "3", "supports": "7", "reweighting": "ink",
}  # fmt: skip
_PALETTE = 10  # colours in assets/page.css: --line-0 and on


def charts(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    """Create every chart that the results allow; the first one stands beside the view. frames: as the view has them."""
    found = [build(results, frames) for build in _BUILDERS]
    return [chart for group in found for chart in group]


def line(name: str, x: np.ndarray, y: np.ndarray, colour: str, **look: Any) -> dict[str, Any]:
    """Create a line. colour: end of a variable in assets/page.css; look: width, points (dot radius), bare (dots
    only).
    """
    return {"name": name, "x": pack(np.asarray(x, float)), "y": pack(np.asarray(y, float)), "colour": colour, **look}


def _capacity(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    history, kind = results.history, kind_of(results.kind)
    if kind.timed or kind.shapes or not len(history.get("load", ())) or not (history["load"] != 0.0).any():
        return []
    along = capacity_axis(results)
    factor, unit = style.length_unit(along.farthest)
    lines = []
    for name in dict.fromkeys(history["stage"].tolist()):
        rows = np.flatnonzero(history["stage"] == name)
        rows = np.concatenate((rows[:1] - 1, rows)) if rows[0] > 0 else rows
        x, y = with_breaks(history["step"][rows], factor * along.values[rows], history["load"][rows])
        lines.append(line(name, x, y, name))
    lines += _beside(results.summary, factor)
    chart: Chart = {
        "id": "capacity",
        "title": f"Collapse: {off}" if (off := off_the_load(results.summary)) else "Capacity curve",
        "x": f"{along.label} [{unit}]",
        "y": "load multiplier λ",
        "lines": lines,
        "levels": _answers(results.summary),
        "marks": [
            [factor * at, frame["load"]] for at, frame in zip(of_frames(results, along, frames), frames, strict=True)
        ],
    }
    if along.failure and along.farthest > _ZOOM_FROM * along.failure and not results.summary.get("capacity_curve"):
        chart["zooms"] = [{"name": "up to failure", "to": 2.0 * factor * along.failure}]
    return [chart]


def _beside(summary: Mapping[str, Any], factor: float) -> list[dict[str, Any]]:
    """Create the bilinear system of a capacity curve, and its reference curves."""
    lines = []
    if system := (summary.get("capacity_curve") or {}).get("bilinear"):
        x = factor * np.array([0.0, system["yield_displacement"], system["ultimate_displacement"]])
        lines.append(line("bilinear system", x, np.array([0.0, *[system["yield_load"]] * 2]), "1", width=1))
    curves = [one for one in from_summary(summary.get("reference")) if one.get("displacements")]
    for i, one in enumerate(curves):
        x = factor * np.array(one["displacements"])
        lines.append(line(f"reference curve {i + 1}, {one['kind']}", x, one["value"], str(4 + i), width=1, points=2))
    return lines


def _answers(summary: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Create horizontal lines: the failure load with its bracket, limit analysis."""
    levels = []
    load, bracket = summary.get("failure_load"), summary.get("failure_load_bracket")
    if load is not None:
        band = list(bracket) if bracket and None not in bracket else None
        levels.append({"name": f"failure load {load:.4g}", "value": load, "band": band, "colour": "failure"})
    limits = summary.get("limit_analysis") or {}
    for name in ("associated", "non_associated"):
        if isinstance(limits.get(name), (int, float)):
            text = f"limit analysis, {name.replace('_', '-')} {limits[name]:.4g}"
            levels.append({"name": text, "value": limits[name], "colour": "limit", "dash": "6 3"})
    return levels


def _histories(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    series = results.series
    if series is None or not len(series.time):
        return []
    found: list[Chart] = []
    instant = {"x": "time [s]", "marks": [[frame["time"], None] for frame in frames], "verticals": _collapse(results)}
    for quantity, unit in MONITOR_UNITS.items():
        lines = of_quantity(series, quantity)
        if not lines:
            continue
        until = series.time <= (results.summary.get("collapse_time") or np.inf)
        before = np.concatenate([values[until] for values in lines.values()])
        before = before[np.isfinite(before)]
        factor, unit = style.length_unit(float(np.abs(before).max(initial=0.0))) if unit == "m" else (1.0, unit)
        drawn = [
            line(name, *curve(series.time, factor * values, quantity), str(i % _PALETTE))
            for i, (name, values) in enumerate(lines.items())
        ]
        chart: Chart = {"id": quantity.replace(" ", "-"), "title": f"Monitors: {quantity}", "y": f"{quantity} [{unit}]"}
        if len(before) and not until.all():  # a fall would flatten everything before
            chart["limits"] = [1.15 * factor * min(before.min(), 0.0), 1.15 * factor * max(before.max(), 0.0)]
        found.append({**chart, **instant, "lines": drawn})
    shaken = series.base[:, BASE.index("acceleration")]
    moved = [k for k in range(shaken.shape[1]) if (shaken[:, k] != 0.0).any()]
    if moved:
        drawn = [line("xyz"[k], *thinned(series.time, shaken[:, k]), str(k)) for k in moved]
        chart = {"id": "base", "title": "Base acceleration", "y": f"acceleration [{MONITOR_UNITS['acceleration']}]"}
        found.append({**chart, **instant, "lines": drawn})
    return found


def _collapse(results: Results) -> list[dict[str, Any]]:
    at = results.summary.get("collapse_time")
    return [] if at is None else [{"name": f"collapse, {at:.3g} s", "value": at, "colour": "collapse"}]


def _modes(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    """Create the chart of the effective mass of each mode."""
    summary = results.summary
    if results.kind != "modes" or not summary.get("frequencies"):
        return []
    at = np.asarray(summary["frequencies"])
    drawn = [
        line(f"along {axis}", at, 100.0 * np.asarray(masses) / summary["total_mass"], str(i), points=4, bare=True)
        for i, (axis, masses) in enumerate(summary["effective_masses"].items())
    ]
    marks = [[summary["frequencies"][frame["step"] - 1], None] for frame in frames]
    chart = {"id": "modes", "title": "Mass that each mode moves", "x": "frequency [Hz]", "y": "share of the mass [%]"}
    return [{**chart, "lines": drawn, "marks": marks if frames[0]["stage"] == "mode" else None}]


def _monitors(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    """Create charts of static runs: the load against each monitor, or a monitor against the control."""
    history = results.history
    if results.series is not None or results.kind == "modes" or len(history.get("step", ())) < 3:
        return []
    loaded = bool((history["load"] != 0.0).any())
    found: list[Chart] = []
    for name, values in list(results.monitors.items())[:_MOST_MONITORS]:
        if not np.isfinite(values).any():
            continue
        steps, control = history["step"], history["displacement"]
        factor, unit = _unit(name, values)
        metre, length = style.length_unit(float(control.max()))
        x, y = (factor * values, history["load"]) if loaded else (metre * control, factor * values)
        curve = with_breaks(steps, x, y)
        drawn = [line(name, curve[0], curve[1], "0")]
        labels = f"{name} [{unit}]", "load multiplier λ"
        labels = labels if loaded else (f"control displacement [{length}]", labels[0])
        rows = [_row_of(history, frame) for frame in frames]
        marks = [[float(x[row]), float(y[row])] for row in rows]
        found.append({"id": f"monitor-{len(found)}", "title": f"Monitor: {name}", "x": labels[0], "y": labels[1],
                      "lines": drawn, "marks": marks})  # fmt: skip
    return found


def _unit(name: str, values: np.ndarray) -> tuple[float, str]:
    """Return factor and unit of a monitor, by the quantity in its name; user names may not contain one."""
    unit = next((MONITOR_UNITS[word] for word in reversed(name.split()) if word in MONITOR_UNITS), "SI")
    return style.length_unit(float(np.nanmax(np.abs(values)))) if unit == "m" else (1.0, unit)


def _row_of(history: Mapping[str, np.ndarray], frame: Mapping[str, Any]) -> int:
    """Return the row of the history nearest to a frame of the same stage."""
    rows = np.flatnonzero(history["stage"] == frame["stage"])
    rows = rows if len(rows) else np.arange(len(history["step"]))
    return int(rows[np.abs(history["step"][rows] - frame["step"]).argmin()])


def _energy(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    history = results.history
    rows = np.arange(len(history.get("step", ())))
    if len(rows) < 2:
        return []
    along = across(results)
    drawn = []
    for name in [*_ENERGY, *(name for name in results.energy if name not in _ENERGY)]:
        values = results.energy.get(name)
        if values is not None and (values != 0.0).any():
            text, colour = name.replace("_", " "), _ENERGY.get(name, "ink")
            curve = with_breaks(history["step"], along.factor * history[along.column], values)
            drawn.append(line(text, curve[0], curve[1], colour))
    marks = [[along.factor * frame[along.column], None] for frame in frames]
    chart = {"id": "energy", "title": "Energy balance", "x": along.label, "y": "energy since the start [J]"}
    return [{**chart, "lines": drawn, "marks": marks, "verticals": _collapse(results)}] if drawn else []


def _fragility(results: Results, frames: Sequence[Mapping[str, Any]]) -> list[Chart]:
    if not has_curve(results):
        return []
    summary = results.summary
    curve, sure = summary.get("curve"), summary.get("confidence")
    drawn, bands = [], []
    if curve:
        at = np.asarray(curve["intensity"])
        drawn.append(line(f"lognormal: median {summary['median']:.3g}, dispersion {summary['dispersion']:.2g}",
                          at, np.asarray(curve["share"]), "0"))  # fmt: skip
        if sure:
            text = f"{100 * sure['level']:.0f} % confidence"
            low, high = (pack(np.asarray(curve[end], float)) for end in ("low", "high"))
            bands.append({"name": text, "x": pack(at.astype(float)), "low": low, "high": high, "colour": "0"})
    drawn += _found(summary, curve)
    tried = [(a, b) for a, b in zip(summary.get("levels") or (), summary.get("share") or ()) if b is not None]
    if tried:
        x, y = np.array(tried).T
        drawn.append(line("collapsed at this level", x, y, "1", points=4, bare=True))
    unit = "" if summary["unit_acceleration"] == 1.0 else f" (× {summary['unit_acceleration']:.4g} m/s²)"
    chart = {"id": "fragility", "title": "Fragility", "x": f"intensity{unit}", "y": "share collapsed"}
    if unit == "":
        chart["x"] = "peak ground acceleration [m/s²]"
    return [{**chart, "lines": drawn, "bands": bands, "limits": [0.0, 1.0]}]


def _found(summary: Mapping[str, Any], curve: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """Create the steps of the collapse intensities; records without collapse count as not reached."""
    repeats = summary.get("repeats")
    rows = repeats["collapse_intensities"] if repeats else [[a] for a in summary["collapse_intensities"]]
    every = [value for row in rows for value in row]
    found = np.sort(np.array([value for value in every if value is not None], dtype=float))
    if not len(found):
        return []
    ends = curve["intensity"] if curve else found
    at = np.concatenate([[min(ends[0], found[0])], found, [max(ends[-1], found[-1])]])
    shares = np.concatenate([np.arange(len(found) + 1), [len(found)]]) / len(every)
    corners = np.repeat(at, 2)[1:], np.repeat(shares, 2)[:-1]  # each share holds up to the next intensity
    return [line(f"collapse at or below, {len(every)} runs", *corners, "ink", width=1.2)]


_BUILDERS: tuple[Callable[[Results, Sequence[Mapping[str, Any]]], list[Chart]], ...] = (
    _capacity, _fragility, _modes, _histories, _monitors, _energy,
)  # fmt: skip
