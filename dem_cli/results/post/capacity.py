"""Draw capacity.png: load multiplier over displacement, up to failure and beyond, bilinear system, test curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.results.output.reader import Results
from dem_cli.results.output.reference import from_summary
from dem_cli.results.post import style

LIVE, LARGEST = "displacement of the live load", "control displacement"
MONITOR = "displacement of {}"  # that is controlled (analysis.of)
_ZOOM_FROM = 6.0  # a second panel where the collapse goes this many times farther than failure


class CapacityAxis(NamedTuple):
    """Displacement axis of a capacity curve."""

    values: np.ndarray  # of each row of the history [m]
    label: str
    failure: float | None  # displacement at failure, or at the peak [m]; None: not known

    @property
    def farthest(self) -> float:
        """Largest absolute displacement [m]."""
        return float(np.abs(self.values).max(initial=0.0))

    @property
    def signed(self) -> bool:
        """Tell whether the displacement is the controlled one, which has a sign."""
        return self.label != LARGEST


def capacity_axis(results: Results) -> CapacityAxis:
    """Return the displacement axis of the loads of a run."""
    history, summary = results.history, results.summary
    curve = summary.get("capacity_curve")
    turns: list[dict[str, Any]] = summary.get("turning_points") or [{}]
    name = (curve or turns[0]).get("of")
    if name is not None and name in results.monitors:
        return _of_monitor(results, name, curve)
    if (curve or "turning_points" in summary) and "live_displacement" in history:
        return CapacityAxis(history["live_displacement"], LIVE, curve["peak_displacement"] if curve else None)
    values, given = history["displacement"], summary.get("displacement_at_failure")
    if given:
        return CapacityAxis(values, LARGEST, float(given))
    loading = values[history["stage"] == "loading"]
    return CapacityAxis(values, LARGEST, float(loading.max()) if len(loading) and loading.max() > 0 else None)


def _of_monitor(results: Results, name: str, curve: Mapping[str, Any] | None) -> CapacityAxis:
    """Return the displacement axis of the controlled monitor from rest, positive where a curve begins."""
    values = results.monitors[name]
    rest = np.flatnonzero(results.history["stage"] == "gravity")
    values = values - (values[rest[-1]] if len(rest) else 0.0)
    if curve and len(values) > 1 and values[rest[-1] + 1 if len(rest) else 1] < 0.0:
        values = -values
    return CapacityAxis(values, MONITOR.format(name), curve["peak_displacement"] if curve else None)


def of_frames(results: Results, axis: CapacityAxis, frames: Sequence[Mapping[str, Any]]) -> list[float]:
    """Return the displacement of frames on an axis [m], by their step and load. frames: as the view has them."""
    if not axis.signed:
        return [frame["displacement"] for frame in frames]
    steps, loads = results.history["step"], results.history["load"]
    top = float(np.abs(loads).max(initial=0.0)) or 1.0
    rows = [int(np.argmin(abs(steps - f["step"]) + abs(loads - f["load"]) / top)) for f in frames]
    return [float(axis.values[row]) for row in rows]


def draw_capacity(results: Results, path: Path) -> None:
    """Draw the capacity curve; one panel more where the way to failure would be invisible."""
    summary, along = results.summary, capacity_axis(results)
    farthest, to_failure = along.farthest, along.failure
    panels = [farthest]
    if to_failure and farthest > _ZOOM_FROM * to_failure and not summary.get("capacity_curve"):
        panels = [2.0 * to_failure, farthest]
    with style.figure(path, figsize=(7.4 if len(panels) == 1 else 11.0, 4.3)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for i, (axis, limit) in enumerate(zip(axes, panels, strict=True)):
            _draw_curve(axis, results, along, limit)
            _draw_answers(axis, summary, labelled=i == len(axes) - 1)
            if title := _title(summary, i, len(panels)):
                axis.set_title(title, fontweight="normal", color=style.GREY, fontsize=10)
            if i == 0 and not off_the_load(summary):
                _mark_failure(axis, summary, to_failure)
        if off_the_load(summary):
            _say(axes[-1], off_the_load(summary))
        axes[0].set_ylabel("load multiplier λ")
        _limit_loads(axes[0], results)
        _draw_legend(figure, *axes[-1].get_legend_handles_labels())
        style.headline(figure, summary)


def _title(summary: Mapping[str, Any], panel: int, panels: int) -> str:
    """Return the title of a panel, with the stiffness of elastic displacements in the first one."""
    parts = [("up to failure", "whole collapse")[panel]] if panels > 1 else []
    ratio = summary.get("curve_joint_stiffness")
    if ratio and panel == 0:
        parts.append(f"elastic part: joints of the solver's choice, kn·h/W = {ratio:.1g}")
    return "; ".join(parts)


def off_the_load(summary: Mapping[str, Any]) -> str:
    """Return the remark on a curve that misses the failure load by more than a tolerance; else empty."""
    peak, load = summary.get("peak_of_curve"), summary.get("failure_load")
    if not summary.get("curve_off_the_load") or not peak or not load:
        return ""
    share, where = 100.0 * abs(peak / load - 1.0), "above" if peak > load else "below"
    return f"no capacity curve: peaks {share:.2g} % {where} the failure load, only its shape counts"


def _say(axis: Any, words: str) -> None:
    """Write a remark over a curve, which stays part of the picture."""
    box = {"boxstyle": "round", "fc": "white", "ec": style.FAILURE, "alpha": 0.9}
    axis.text(
        0.98, 0.97, words, transform=axis.transAxes, ha="right", va="top", fontsize=9, color=style.FAILURE, bbox=box,
        wrap=True, zorder=6,
    )  # fmt: skip


def _draw_legend(figure: Any, handles: list[Any], labels: list[str]) -> None:
    """Draw the legend below the panels, in as few rows as fit the width of the figure."""
    for rows in range(1, max(1, len(labels)) + 1):
        columns = -(-max(1, len(labels)) // rows)
        legend = figure.legend(handles, labels, loc="outside lower center", ncols=columns, columnspacing=1.4)
        if rows >= len(labels) or legend.get_window_extent(figure.canvas.get_renderer()).width <= figure.bbox.width:
            return
        legend.remove()


def _draw_curve(axis: Any, results: Results, along: CapacityAxis, limit: float) -> None:
    history = results.history
    factor, unit = style.length_unit(limit)
    x, y = factor * along.values, history["load"]
    lowest = min(float(x.min(initial=0.0)), 0.0) if along.signed else 0.0
    highest = float(x.max(initial=0.0)) if lowest < 0.0 else factor * limit  # of cycles, or of the panel
    for stage, colour in style.STAGE_COLOURS.items():
        rows = np.flatnonzero(history["stage"] == stage)
        if len(rows):
            before = max(0, rows[0] - 1)
            if history["step"][before] <= history["step"][rows[0]]:
                rows = np.concatenate(([before], rows))  # joined to the stage before
            places, loads = with_breaks(history["step"][rows], x[rows], y[rows])
            axis.plot(places, loads, color=colour, lw=1.2 if lowest < 0.0 else None, label=stage)
    axis.set_xlim(1.03 * lowest - 0.02 * factor * limit, 1.03 * highest or 1.0)
    axis.locator_params(axis="x", nbins=6)
    axis.set_xlabel(f"{along.label} [{unit}]")
    if lowest < 0.0:  # cycles
        for line in (axis.axhline, axis.axvline):
            line(0.0, color=style.GREY, lw=0.8, zorder=0.5)
    _draw_system(axis, results.summary.get("capacity_curve") or {}, factor)
    _draw_tests(axis, results.summary, factor)


def _draw_system(axis: Any, curve: Mapping[str, Any], factor: float) -> None:
    """Draw the bilinear system over its curve."""
    system = curve.get("bilinear")
    if system:
        ends = [0.0, factor * system["yield_displacement"], factor * system["ultimate_displacement"]]
        loads = [0.0, system["yield_load"], system["yield_load"]]
        axis.plot(ends, loads, color=style.SYSTEM, lw=1.4, ls=(0, (5, 2)), label="bilinear system")


def _draw_tests(axis: Any, summary: Mapping[str, Any], factor: float) -> None:
    """Draw the reference curves of the case."""
    curves = [one for one in from_summary(summary.get("reference")) if one.get("displacements")]
    for i, one in enumerate(curves):
        x = factor * np.array(one["displacements"])
        name = f"reference curve{f' {i + 1}' if len(curves) > 1 else ''}, {one['kind']}"
        axis.plot(x, one["value"], color=style.REFERENCE, lw=0.9, marker="os^D"[i % 4], ms=3, label=name)


def with_breaks(steps: np.ndarray, *columns: np.ndarray) -> list[np.ndarray]:
    """Insert a gap into the columns wherever the steps start anew: another simulation of the same run."""
    starts = np.flatnonzero(np.diff(steps) < 0) + 1
    return [np.insert(column.astype(float), starts, np.nan) for column in columns]


def _draw_answers(axis: Any, summary: dict[str, Any], labelled: bool) -> None:
    """Draw horizontal lines: failure load with its bracket, limit analysis, reference."""
    load, bracket = summary.get("failure_load"), summary.get("failure_load_bracket")
    if load is not None:
        if bracket and None not in bracket:
            axis.axhspan(*bracket, color=style.FAILURE, alpha=0.13, lw=0, label="bracket")
        axis.axhline(load, color=style.FAILURE, lw=0.9, label=f"failure load {load:.4g}")
    limits = summary.get("limit_analysis") or {}
    for name, dashes in (("associated", (5, 2)), ("non_associated", (2, 2))):
        if isinstance(limits.get(name), (int, float)):
            label = f"limit analysis, {name.replace('_', '-')} {limits[name]:.4g}"
            axis.axhline(limits[name], color=style.LIMIT, lw=1.2, ls=(0, dashes), label=label)
    for answer in from_summary(summary.get("reference")):
        if answer["quantity"] == "failure_load":
            ends = answer["value"] if isinstance(answer["value"], list) else [answer["value"]]
            words = " to ".join(f"{end:g}" for end in ends)
            for end, label in zip(ends, (f"reference {words} ± {answer['tolerance']:.2g}", "_")):
                axis.axhline(end, color=style.REFERENCE, lw=1.2, ls=(0, (1, 1.5)), label=label)


def _mark_failure(axis: Any, summary: dict[str, Any], displacement: float | None) -> None:
    load = summary.get("failure_load")
    if load is None or not displacement:
        return
    factor = {"m": 1.0, "mm": 1e3, "µm": 1e6}[axis.get_xlabel().split("[")[1].rstrip("]")]
    place = (factor * displacement, load)
    axis.plot(*place, "o", ms=7, mfc="white", mec=style.FAILURE, mew=1.6, zorder=5)
    if summary.get("capacity_curve"):  # what is drawn over it leaves no room for words
        return
    bracket = summary.get("failure_load_bracket")
    text = f"λ = {load:.4g}"
    if bracket and None not in bracket:
        text += f"\n{bracket[0]:.4g} … {bracket[1]:.4g}"
    if place[0] > 0.6 * axis.get_xlim()[1]:  # beside the point it would lie on the curve
        axis.text(0.98, 0.05, text, transform=axis.transAxes, ha="right", fontsize=9, color=style.FAILURE)
    else:
        axis.annotate(text, place, (10, -12), textcoords="offset points", va="top", fontsize=9, color=style.FAILURE)


def _limit_loads(axis: Any, results: Results) -> None:
    loads = [results.history["load"].max(initial=0.0), results.summary.get("failure_load") or 0.0]
    limits = results.summary.get("limit_analysis") or {}
    loads += [limits.get(name) or 0.0 for name in ("associated", "non_associated")]
    for one in from_summary(results.summary.get("reference")):
        loads += one["value"] if one.get("displacements") else []
    top = max(loads) or 1.0
    axis.set_ylim(min(0.0, 1.1 * results.history["load"].min(initial=0.0)) - 0.02 * top, 1.12 * top)
