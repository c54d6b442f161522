"""Draw charts of a sweep: any column over any other, in families; brackets as bars, missing answers as crosses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.errors import UsageError
from dem_cli.results.post import chart, style
from dem_cli.results.post.chart import ChartOptions
from dem_cli.results.post.labels import Quantity
from dem_cli.results.post.sweep_table import SweepTable, distinct, numeric, shown

_SCATTERED = 0.5  # of the runs: more families than that are no families, but points
_FAILED = "#c0392b"
_ALONE = (0, (2, 2))  # dashes of a bracket without an answer
MOST_ENTRIES = 24  # of a legend


class RunFamily(NamedTuple):
    """Family of runs that differ in x alone."""

    first: Any  # value of the first key by which families differ: the colour
    rest: tuple[Any, ...]  # of the others: dashes and marker
    rows: list[int]  # of the table, in the order of x


def draw_sweep(
    table: SweepTable, x: str, ys: Sequence[str], by: Sequence[str], path: Path, options: ChartOptions,
    quantities: Mapping[str, Quantity],
) -> None:  # fmt: skip
    """Draw ys over x, a line for each combination of the keys `by`; exact names. quantities: of all columns."""
    families = _families(table, x, by)
    points = len(families) > max(1.0, _SCATTERED * table.count) or (x not in table.keys and not by)
    if points and len(by) > 1:  # a colour says one key
        by = by[:1]
        families = _families(table, x, by)
    keys = chart.FamilyColours([family.first for family in families])
    rests = list(dict.fromkeys(family.rest for family in families))
    units = list(dict.fromkeys(quantities[y].unit for y in ys))
    panels = [[y for y in ys if quantities[y].unit == unit] for unit in units]
    width, height = options.inches
    height *= 1.0 + 0.6 * (len(panels) - 1) if options.size is None else 1.0
    factor, name = _fitted(table, quantities, [x])
    at = _AxisPositions(table.columns[x], factor)
    with style.figure(path, figsize=(width, height)) as figure:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        missing = []
        for axis, panel in zip(axes, panels):
            factor, label = _fitted(table, quantities, panel)
            heights = {y: _AxisPositions(table.columns[y], factor) for y in panel}
            for y in panel:
                for family in families:
                    look = _look(family, keys, rests, list(ys), y, points)
                    _draw_family(axis, table, (at, heights[y]), y, family.rows, look)
            axis.set_ylabel(label)
            at.dress(axis, "x")
            heights[panel[0]].dress(axis, "y")
            chart.dress(axis, options)
            missing.append(_mark_missing(axis, table, at, panel[0]))
        axes[-1].set_xlabel(name)
        if keys.bar:
            chart.draw_bar(figure, axes, keys, quantities[by[0]].label())
        alone = any(
            table.columns[y][i] is None and _bracket(table, y, i)[0] is not None for y in ys for i in range(table.count)
        )
        _legend(figure, families, keys, rests, ys, by, quantities, (alone, any(missing)))
        chart.title(figure, table.title)


class _AxisPositions:
    """Axis positions of the values of a column: numbers at their value, text values side by side."""

    def __init__(self, values: Sequence[Any], factor: float = 1.0):
        self.values, self.factor = values, factor
        self.words = [] if numeric(values) else distinct(values)

    def __getitem__(self, row: int) -> float:
        value = self.values[row]
        return float(self.words.index(value)) if self.words else self.factor * float(value)

    def dress(self, axis: Any, name: str) -> None:
        """Label the ticks of text values."""
        if self.words:
            crowded = name == "x" and sum(len(shown(word)) for word in self.words) > 60
            turned = {"rotation": 20, "ha": "right"} if crowded else {}
            getattr(axis, f"set_{name}ticks")(range(len(self.words)), list(map(shown, self.words)), **turned)
        elif all(float(v).is_integer() for v in self.values if v is not None):  # counts
            axis.locator_params(axis=name, integer=True)


def _fitted(table: SweepTable, quantities: Mapping[str, Quantity], names: Sequence[str]) -> tuple[float, str]:
    """Return a common factor for columns of the same unit, and the axis label."""
    columns = [table.columns[name] for name in names if numeric(table.columns[name])]
    numbers = [np.array([v for v in column if v is not None], float) for column in columns]
    factor, label = chart.fitted(quantities[names[0]], numbers)
    if len(names) > 1:
        label = f"[{label.rsplit(' [', 1)[1]}" if label.endswith("]") else ""
    return factor, label


def _families(table: SweepTable, x: str, by: Sequence[str]) -> list[RunFamily]:
    """Group rows by their values of `by`; in each group sorted by x."""
    found: dict[tuple[Any, ...], list[int]] = {}
    for i in range(table.count):
        if table.columns[x][i] is not None:
            found.setdefault(tuple(table.columns[key][i] for key in by), []).append(i)
    if not found:
        raise UsageError(f"no run has a value of {x}")
    order = {v: k for k, v in enumerate(distinct(table.columns[x]))}
    orders = [{v: k for k, v in enumerate(distinct(table.columns[key]))} for key in by]
    families = []
    for values in sorted(found, key=lambda values: [o.get(v, -1) for o, v in zip(orders, values)]):
        rows = sorted(found[values], key=lambda i: order[table.columns[x][i]])
        families.append(RunFamily(values[0] if by else None, values[1:], rows))
    return families


def _look(
    family: RunFamily, keys: chart.FamilyColours, rests: Sequence[tuple[Any, ...]], ys: list[str], y: str, points: bool
) -> dict[str, Any]:
    """Return colour by the first key, marker by the others, dashes by column where there are several."""
    column, rest = ys.index(y), rests.index(family.rest)
    alone = len(keys.values) == 1 and len(rests) == 1 and len(ys) > 1
    colour = chart.COLOURS[column % len(chart.COLOURS)] if alone else keys.colour(family.first)
    dashes = 0 if alone else column if len(ys) > 1 else rest
    return {
        "color": colour,
        "marker": chart.MARKERS[(rest if rests[1:] else _rank(keys, family)) % len(chart.MARKERS)],
        "ls": "none" if points else chart.DASHES[dashes % len(chart.DASHES)],
    }


def _rank(keys: chart.FamilyColours, family: RunFamily) -> int:
    """Return the number of a family's colour, for markers that work without colours."""
    return 0 if keys.bar else keys.values.index(family.first)


def _draw_family(
    axis: Any,
    table: SweepTable,
    places: tuple[_AxisPositions, _AxisPositions],
    y: str,
    rows: Sequence[int],
    look: dict[str, Any],
) -> None:
    """Draw connected points of answers, and bars of their brackets, dashed where there is no answer."""
    at, heights = places
    answered = [i for i in rows if table.columns[y][i] is not None]
    size = 5.0 if len(rows) <= 30 else 3.0
    axis.plot([at[i] for i in answered], [heights[i] for i in answered], lw=1.5, ms=size, mew=0.0, **look)
    for i in rows:
        low, high = _bracket(table, y, i)
        if low is None:
            continue
        alone = {"ls": _ALONE} if table.columns[y][i] is None else {}
        ends = [heights.factor * end for end in (low, high) if end is not None]
        mark = "_" if high is not None else "^"  # a lower bound alone
        axis.plot([at[i]] * len(ends), ends, color=look["color"], lw=1.0, marker=mark, ms=6.0, mew=1.0, **alone)


def _bracket(table: SweepTable, y: str, row: int) -> tuple[float | None, float | None]:
    """Return the bracket of the answer of a run; None: an unknown end."""
    low, high = (table.columns.get(f"{y}_bracket.{end}", [None] * table.count)[row] for end in (0, 1))
    return low, high


def _mark_missing(axis: Any, table: SweepTable, at: _AxisPositions, y: str) -> bool:
    """Mark runs without answer and bracket by crosses on the axis; returns whether there are any."""
    rows = [
        i
        for i in range(table.count)
        if table.columns[y][i] is None and at.values[i] is not None and _bracket(table, y, i)[0] is None
    ]
    if rows:
        axis.plot([at[i] for i in rows], [0.015] * len(rows), "x", color=_FAILED, ms=6.0, mew=1.6, clip_on=False,
                  transform=axis.get_xaxis_transform(), zorder=4)  # fmt: skip
    return bool(rows)


def _legend(
    figure: Any, families: Sequence[RunFamily], keys: chart.FamilyColours, rests: Sequence[tuple[Any, ...]],
    ys: Sequence[str], by: Sequence[str], quantities: Mapping[str, Quantity], gaps: tuple[bool, bool],
) -> None:  # fmt: skip
    """Draw the legend: colours for the first key, markers for the others, dashes for columns.

    gaps: whether there are runs that have a bracket alone, and runs that have nothing.
    """
    from matplotlib.lines import Line2D

    handles: list[Any] = []
    nothing: dict[str, Any] = {"color": "none", "lw": 0.0}
    if len(keys.values) > 1 and not keys.bar:
        handles.append(Line2D([], [], label=chart.wrapped(quantities[by[0]].label()), **nothing))
        marks = [chart.MARKERS[i % len(chart.MARKERS)] if len(rests) == 1 else "" for i in range(len(keys.values))]
        handles += [
            Line2D([], [], color=keys.colour(v), lw=2.0, marker=mark, ms=5.0, mew=0.0, label=shown(v))
            for v, mark in zip(keys.values, marks)
        ]
    if len(rests) > 1:
        heading = chart.wrapped(", ".join(quantities[key].label() for key in by[1:]))
        handles.append(Line2D([], [], label=heading, **nothing))
        for i, rest in enumerate(rests):
            look = {"marker": chart.MARKERS[i % len(chart.MARKERS)], "ls": chart.DASHES[i % len(chart.DASHES)]}
            look = look if len(ys) == 1 else look | {"ls": "none"}
            handles.append(Line2D([], [], color=style.GREY, ms=5.0, label=", ".join(map(shown, rest)), **look))
    if len(ys) > 1:
        for i, y in enumerate(ys):
            alone = len(families) == 1
            look = {"color": chart.COLOURS[i % len(chart.COLOURS)]} if alone else {"color": style.GREY}
            dashes = "-" if alone else chart.DASHES[i % len(chart.DASHES)]
            handles.append(Line2D([], [], ls=dashes, label=quantities[y].words, **look))
    alone, missing = gaps
    if alone:
        handles.append(Line2D([], [], color=style.GREY, ls=_ALONE, lw=1.0, label="bracket, no answer"))
    if missing:
        handles.append(Line2D([], [], color=_FAILED, marker="x", ls="none", mew=1.6, label="no answer"))
    if len(handles) > MOST_ENTRIES:
        raise UsageError(f"{len(handles)} names are too many for a legend; choose rows with --where KEY=VALUE")
    if handles:
        figure.legend(handles=handles, loc="outside right upper", fontsize=9)
