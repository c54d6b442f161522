"""Draw line charts of any two columns of one or several runs: a curve for each, a panel for each unit."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.errors import UsageError
from dem_cli.results.output.reader import Results
from dem_cli.results.post import chart, style
from dem_cli.results.post.chart import ChartOptions
from dem_cli.results.post.histories import thinned
from dem_cli.results.post.labels import Quantity
from dem_cli.results.post.run_columns import find, tables

_PANEL = 0.62  # of the height of a chart: every panel after the first adds so much
_MOST_BESIDE = 16  # names in a legend at the side


class FamilyMember(NamedTuple):
    """Run of a family of curves."""

    name: str  # as the legend has it
    value: Any  # by which it is coloured
    results: Results


class Curve(NamedTuple):
    """Curve of a chart."""

    member: FamilyMember
    column: str  # of y
    x: np.ndarray
    y: np.ndarray


def draw_curves(
    members: Sequence[FamilyMember],
    x: str,
    ys: Sequence[str],
    path: Path,
    options: ChartOptions,
    title: str,
    family: str = "",
) -> None:
    """Draw one line per run and column of y. `family`: the key whose values colour the runs.

    Raises UsageError where a run lacks a column.
    """
    quantities, curves = _gathered(members, x, ys)
    units = list(dict.fromkeys(quantities[c.column].unit or c.column for c in curves))
    panels = [[c for c in curves if (quantities[c.column].unit or c.column) == unit] for unit in units]
    width, height = options.inches
    if options.size is None:
        height *= 1.0 + _PANEL * (len(panels) - 1)
    with style.figure(path, figsize=(width, height)) as figure:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        keys = chart.FamilyColours([member.value for member in members])
        factor, label = chart.fitted(quantities["x"], [curve.x for curve in curves])
        for axis, panel in zip(axes, panels):
            _draw_panel(axis, panel, factor, quantities, keys, list(ys), options)
        axes[-1].set_xlabel(label)
        figure.align_ylabels(axes)
        if keys.bar:
            chart.draw_bar(figure, axes, keys, family)
        _legend(figure, axes, members, keys, ys, quantities, family)
        chart.title(figure, title)


def _gathered(members: Sequence[FamilyMember], x: str, ys: Sequence[str]) -> tuple[dict[str, Quantity], list[Curve]]:
    quantities: dict[str, Quantity] = {}
    curves = []
    for member in members:
        try:
            table, (at, *columns) = find(tables(member.results), (x, *ys))
        except UsageError as error:
            raise UsageError(f"{member.name}: {error}" if len(members) > 1 else str(error)) from None
        quantities["x"] = table.quantities[at]
        for asked, column in zip(ys, columns):
            quantities[asked] = table.quantities[column]
            first, second = (np.insert(table.values(n).astype(float), table.breaks, np.nan) for n in (at, column))
            curves.append(Curve(member, asked, first, second))
    return quantities, curves


def _draw_panel(
    axis: Any, curves: Sequence[Curve], x_factor: float, quantities: dict[str, Quantity], keys: chart.FamilyColours,
    ys: list[str], options: ChartOptions,
) -> None:  # fmt: skip
    columns = list(dict.fromkeys(curve.column for curve in curves))
    factor, label = chart.fitted(quantities[columns[0]], [curve.y for curve in curves])
    alone = len(keys.values) == 1
    for curve in curves:
        i = ys.index(curve.column)
        colour = chart.COLOURS[i % len(chart.COLOURS)] if alone else keys.colour(curve.member.value)
        dashes = "-" if alone else chart.DASHES[i % len(chart.DASHES)]
        x, y = x_factor * curve.x, factor * curve.y
        if np.all(np.diff(x) > 0.0):
            x, y = thinned(x, y)
        axis.plot(x, y, color=colour, ls=dashes, lw=1.6 if len(curves) <= 12 else 1.1)
    axis.set_ylabel(label if len(columns) == 1 else _in_common([quantities[name].words for name in columns], label))
    if options.x_limits is not None:
        _fit_heights(axis, options.x_limits)
    low, high = axis.get_ylim()
    if low < 0.0 < high and "y" not in options.log:
        axis.axhline(0.0, color=style.GREY, lw=0.6, zorder=1)
    chart.dress(axis, options)


def _in_common(words: list[str], label: str) -> str:
    """Find the common beginning of the names of several columns, with their unit."""
    same = takewhile(lambda row: len(set(row)) == 1, zip(*(text.replace(",", "").split() for text in words)))
    start = " ".join(row[0] for row in same)
    unit = f"[{label.rsplit(' [', 1)[1]}" if label.endswith("]") else ""
    return f"{start} {unit}".strip()


def _fit_heights(axis: Any, limits: tuple[float, float]) -> None:
    """Scale the y axis to the data between the limits of x."""
    seen = [line.get_ydata()[(line.get_xdata() >= limits[0]) & (line.get_xdata() <= limits[1])] for line in axis.lines]
    inside = np.concatenate(seen)
    inside = inside[np.isfinite(inside)]
    if len(inside):
        margin = 0.05 * float(np.ptp(inside)) or 1.0
        axis.set_ylim(inside.min() - margin, inside.max() + margin)


def _legend(
    figure: Any, axes: Any, members: Sequence[FamilyMember], keys: chart.FamilyColours, ys: Sequence[str],
    quantities: dict[str, Quantity], family: str,
) -> None:  # fmt: skip
    """Draw the legend: runs by colour; columns by colour where there is one run, else by dashes."""
    from matplotlib.lines import Line2D

    alone = len(keys.values) == 1
    handles = []
    if not alone and not keys.bar:
        names = {member.value: member.name for member in members}
        handles = [Line2D([], [], color=keys.colour(value), label=names[value]) for value in keys.values]
    if len(ys) > 1:
        for i, name in enumerate(ys):
            look = {"color": chart.COLOURS[i % len(chart.COLOURS)]} if alone else {
                "color": style.GREY, "ls": chart.DASHES[i % len(chart.DASHES)]
            }  # fmt: skip
            handles.append(Line2D([], [], label=quantities[name].words, **look))
    if handles:
        if len(handles) > _MOST_BESIDE:
            raise UsageError(f"{len(handles)} curves are too many for a legend; colour them by a number with --by KEY")
        heading = chart.wrapped(family) if len(handles) > len(ys) or len(ys) == 1 else None
        figure.legend(handles=handles, loc="outside right center", title=heading, fontsize=9, title_fontsize=9,
                      alignment="left")  # fmt: skip
