"""Draw a heat map of a sweep over two keys: numbers as colours with their values, text as areas of one colour."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.errors import UsageError
from dem_cli.results.post import chart, style
from dem_cli.results.post.chart import ChartOptions
from dem_cli.results.post.labels import Quantity
from dem_cli.results.post.sweep_table import SweepTable, distinct, is_answer_in_words, numeric, shown

_MOST_NUMBERS = 160  # cells that are small enough to be read
_DARK = 0.55  # luminance below which numbers are white
_BOTH = 0.05  # of the largest value: less on the other side of zero is neglected
_AREAS = ("#5aa0d8", "#e0a458", "#8fbf8f", "#b39ddb", "#d98cb3", "#c9c4ba")
_TRUTHS = {"collapsed": {False: "stands", True: "falls"}}  # what truths of a column are called
_MOST_TICKS = 16  # names along a side
_FULL = 0.5  # of the cells must have a run, else the keys are no grid


def draw_map(
    table: SweepTable, x: str, y: str, z: str, path: Path, options: ChartOptions, quantities: Mapping[str, Quantity]
) -> None:
    """Draw z over the keys x and y. Raises UsageError where other keys vary too: their value is ambiguous."""
    others = [key for key in table.ranked() if key not in (x, y)]
    if others and len({(table.columns[x][i], table.columns[y][i]) for i in range(table.count)}) < table.count:
        raise UsageError(f"--map has two keys; choose of the others with --where {others[0]}=VALUE")
    across, upwards = distinct(table.columns[x]), distinct(table.columns[y])
    grid = table.count >= _FULL * len(across) * len(upwards)
    with style.figure(path, figsize=options.inches) as figure:
        axis = figure.add_subplot()
        axis.grid(False)
        if grid:
            _draw_cells(figure, axis, table, (x, y, z), (across, upwards), quantities[z])
        else:
            _draw_points(figure, axis, table, (x, y, z), quantities[z])
        axis.set_xlabel(quantities[x].label())
        axis.set_ylabel(quantities[y].label())
        chart.title(figure, table.title)


def _draw_cells(
    figure: Any, axis: Any, table: SweepTable, names: tuple[str, str, str], sides: tuple[list[Any], list[Any]],
    quantity: Quantity,
) -> None:  # fmt: skip
    x, y, z = names
    across, upwards = sides
    values = np.full((len(upwards), len(across)), np.nan)
    words = distinct(table.columns[z]) if is_answer_in_words(table.columns[z]) else []
    for i in range(table.count):
        v = table.columns[z][i]
        if v is not None:
            value = words.index(v) if words else v
            values[upwards.index(table.columns[y][i]), across.index(table.columns[x][i])] = value
    axis.set_facecolor(style.FAINT)  # where there is no answer
    scale, limits = _scale(words, values)
    mesh = axis.pcolormesh(np.ma.masked_invalid(values), cmap=scale, edgecolors="white", linewidth=0.8, **limits)
    axis.set_xticks(*_ticks(across))
    axis.set_yticks(*_ticks(upwards))
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)
    bar = figure.colorbar(mesh, ax=axis, pad=0.02, aspect=26)
    bar.outline.set_visible(False)
    bar.set_label(quantity.label())
    if words:
        bar.set_ticks(range(len(words)), labels=[_TRUTHS.get(z, {}).get(word) or shown(word) for word in words])
        bar.ax.tick_params(length=0)
    elif values.size <= _MOST_NUMBERS:
        _write_numbers(axis, values, mesh)


def _ticks(values: list[Any]) -> tuple[np.ndarray, list[str]]:
    """Return places and names of the tick labels of a key: not all where they are many."""
    every = max(1, -(-len(values) // _MOST_TICKS))
    return np.arange(0, len(values), every) + 0.5, [shown(v) for v in values[::every]]


def _write_numbers(axis: Any, values: np.ndarray, mesh: Any) -> None:
    size = float(np.clip(78.0 / max(values.shape[1], 6), 5.5, 9.5))
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    digits = int(np.clip(2 - np.floor(np.log10(largest or 1.0)), 0, 6))  # three of the largest
    for (row, column), v in np.ndenumerate(values):
        text, colour = "–", style.INK
        if np.isfinite(v):
            red, green, blue, _ = mesh.cmap(mesh.norm(v))
            dark = 0.299 * red + 0.587 * green + 0.114 * blue < _DARK
            text, colour = _number(float(v), digits), "white" if dark else style.INK
        axis.text(column + 0.5, row + 0.5, text, ha="center", va="center", fontsize=size, color=colour)


def _number(v: float, digits: int) -> str:
    """Format a number with the common number of decimals; none too long for its cell."""
    text = f"{v:.{digits}f}"
    text = text.lstrip("-") if float(text) == 0.0 else text
    return (text if len(text) <= 8 else f"{v:.2e}").replace("-", "−")


def _draw_points(figure: Any, axis: Any, table: SweepTable, names: tuple[str, str, str], quantity: Quantity) -> None:
    """Draw a point per run, for keys that form no grid."""
    if not all(numeric(table.columns[name]) for name in names):
        raise UsageError("--map of points needs numbers: these keys are no grid")
    columns = [np.array([np.nan if v is None else v for v in table.columns[name]], float) for name in names]
    there = np.isfinite(columns[2])
    scale, limits = _scale([], columns[2])
    points = axis.scatter(*(c[there] for c in columns[:2]), c=columns[2][there], s=34, cmap=scale, lw=0, **limits)
    axis.plot(*(c[~there] for c in columns[:2]), "x", color="#c0392b", label="no answer")
    axis.grid(True)
    bar = figure.colorbar(points, ax=axis, pad=0.02, aspect=26)
    bar.outline.set_visible(False)
    bar.set_label(quantity.label())
    if not there.all():
        figure.legend(loc="outside lower right")


def _scale(words: list[Any], values: np.ndarray) -> tuple[Any, dict[str, float]]:
    """Return the colour map and its limits: a colour per text value; symmetric for values on both sides of zero."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    if words:
        colours = [_AREAS[i % len(_AREAS)] for i in range(len(words))]
        return ListedColormap(colours), {"vmin": -0.5, "vmax": len(words) - 0.5}
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    if np.nanmin(values, initial=0.0) < -_BOTH * largest and np.nanmax(values, initial=0.0) > _BOTH * largest:
        return colormaps["PuOr"], {"vmin": -largest, "vmax": largest}
    return colormaps["viridis"], {}
