"""Draw histories.png: the base motion above, the monitors of a time history below, a panel per quantity."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.results.output.reader import Results
from dem_cli.results.output.series import BASE, HistorySeries
from dem_cli.results.post import style

_COLOURS = ("#1f5fa8", "#e08214", "#2a8c5b", "#8250a8", "#c51b7d", "#5aa0d8", "#a6761d", "#7c7c86")
_MOST_POINTS = 4000  # per line: more are drawn as the lowest and highest of each stretch
_BEYOND = 1.15  # of what happened up to collapse: a fall would flatten everything before
_LONGEST_LABEL = 34


def draw_histories(results: Results, path: Path) -> None:
    """Draw the base acceleration and every monitor against time; the collapse is marked."""
    series = results.series
    assert series is not None
    collapse, ends = results.summary.get("collapse_time"), results.summary.get("duration")
    if collapse is not None and collapse > series.time[-1]:
        collapse = None  # after the motion, of earlier versions: nothing of it is drawn
    panels = {quantity: of_quantity(series, quantity) for quantity in MONITOR_UNITS}
    panels = {quantity: lines for quantity, lines in panels.items() if lines}
    moved = [name for i, name in enumerate(BASE) if (series.base[:, i] != 0.0).any()]
    rows = [1.0] * bool(moved) + [1.4] * len(panels) or [1.0]
    with style.figure(path, figsize=(8.6, 0.9 + 1.45 * sum(rows))) as figure:
        axes = figure.subplots(len(rows), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0]
        if moved:
            _draw_base(axes[0], series)
        for axis, (quantity, lines) in zip(axes[bool(moved) :], panels.items()):
            _draw_panel(axis, series.time, quantity, lines, collapse)
        for axis in axes:
            if ends is not None and ends < series.time[-1]:
                axis.axvline(ends, color=style.GREY, lw=0.9, ls=(0, (1, 2)))  # what follows is the coda
            if collapse is not None:
                axis.axvline(collapse, color=style.COLLAPSE, lw=1.1, ls=(0, (4, 2)))
        if collapse is not None:
            axes[0].annotate(
                f" collapse, {collapse:.3g} s", (collapse, 1.0), xycoords=("data", "axes fraction"), va="bottom",
                ha="center", fontsize=9, color=style.COLLAPSE,
            )  # fmt: skip
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(0.0, float(series.time[-1]) or 1.0)
        figure.align_ylabels(axes)
        style.headline(figure, results.summary)


def of_quantity(series: HistorySeries, quantity: str) -> dict[str, np.ndarray]:
    """Return all monitors of one quantity, by name."""
    return {name: values for name, values in series.monitors.items() if series.quantities[name] == quantity}


def base_colours(series: HistorySeries) -> list[str]:
    """Return the colours of the base components: x, in space y as well, and the vertical one."""
    return [*(style.INK, style.THRUST)[: series.base.shape[2] - 1], style.GREY]


def _draw_base(axis: Any, series: HistorySeries) -> None:
    """Draw the base acceleration in every direction where it is not zero."""
    for i, name in enumerate("xyz"[: series.base.shape[2]]):
        values = series.base[:, 0, i]
        if (values != 0.0).any():
            axis.plot(*thinned(series.time, values), color=base_colours(series)[i], lw=0.9, label=name)
    axis.set_ylabel("base\n[m/s2]")
    if len(axis.get_lines()) > 1:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def _draw_panel(
    axis: Any, time: np.ndarray, quantity: str, lines: Mapping[str, np.ndarray], collapse: float | None
) -> None:
    before = time <= (np.inf if collapse is None else collapse)
    shown = np.concatenate([values[before] if before.any() else values for values in lines.values()])
    shown = shown[np.isfinite(shown)]
    factor, unit = 1.0, MONITOR_UNITS[quantity]
    if unit == "m":
        factor, unit = style.length_unit(float(np.abs(shown).max(initial=0.0)))
    for i, (name, values) in enumerate(lines.items()):
        label = name if len(name) <= _LONGEST_LABEL else f"{name[: _LONGEST_LABEL - 1]}…"
        axis.plot(*curve(time, factor * values, quantity), color=_COLOURS[i % len(_COLOURS)], lw=1.1, label=label)
    axis.axhline(0.0, color=style.GREY, lw=0.6)
    if collapse is not None and len(shown):
        low, high = factor * min(0.0, shown.min()), factor * max(0.0, shown.max())
        margin = (_BEYOND - 1.0) * (high - low)
        axis.set_ylim(low - (margin or 1.0), high + (margin or 1.0))
    axis.set_ylabel("\n".join([*quantity.split(), f"[{unit}]"]))
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=9)


def curve(time: np.ndarray, values: np.ndarray, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a line, thinned; a rotation vector that wraps around leaves a break, nan."""
    x, y = thinned(time, values)
    if quantity != "rotation":
        return x, y
    at = np.flatnonzero(np.abs(np.diff(y)) > np.pi) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)


def thinned(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thin a line without visible change: the lowest and the highest point of every stretch, in order."""
    n = len(time)
    if n <= _MOST_POINTS:
        return time, values
    each = -(-2 * n // _MOST_POINTS)
    starts = np.arange(0, n, each)
    finite = np.where(np.isfinite(values), values, 0.0)
    ends = np.append(starts[1:], n)
    picked = [(a + finite[a:b].argmin(), a + finite[a:b].argmax()) for a, b in zip(starts, ends)]
    rows = np.unique(np.array([0, *(i for pair in picked for i in pair), n - 1]))
    return time[rows], values[rows]
