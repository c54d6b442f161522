"""Pictures of benchmarks: work-precision diagrams and growth, in the style of all pictures."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.results.post import style

COLOURS = ("#1f5fa8", "#e08214", "#2a8c5b", "#c51b7d", "#8250a8", "#26262b", "#b8860b", "#3aa6b9", "#c0392b", "#7c7c86")
MARKERS = "os^Dv<>Phd"
FLOOR = 1e-5  # smaller errors are drawn here: references have six digits
PANELS_PER_ROW = 3

Points = Sequence[tuple[float, float | None]]  # (CPU seconds, relative error)


def work_precision(
    path: Path, panels: Mapping[str, Mapping[str, Points]], joined: Collection[str] | None = None
) -> None:
    """|Error| against CPU seconds, both logarithmic. panels: title -> line -> points.

    joined: the lines whose points are connected (None: all). Settings without an answer are left out.
    """
    names = list(dict.fromkeys(line for panel in panels.values() for line in panel))
    columns = min(PANELS_PER_ROW, len(panels))
    rows = -(-len(panels) // columns)
    with style.figure(path, figsize=(0.8 + 3.9 * columns, 0.9 + 3.1 * rows)) as figure:
        axes = figure.subplots(rows, columns, squeeze=False, sharey=True)
        for axis, (title, lines) in zip(axes.flat, panels.items(), strict=False):
            _panel(axis, title, lines, names, joined)
        for axis in axes.flat[len(panels) :]:
            axis.set_visible(False)
        for row in axes:
            row[0].set_ylabel("|error|")
        legend(figure, axes.flat[: len(panels)])


def _panel(
    axis: Any, title: str, lines: Mapping[str, Points], names: Sequence[str], joined: Collection[str] | None
) -> None:
    for name, points in lines.items():
        number = names.index(name)
        answered = [(time, max(abs(error), FLOOR)) for time, error in points if error is not None]
        if not answered:
            continue
        dashes = "-" if joined is None or name in joined else ""
        axis.plot(
            *zip(*answered, strict=True), ls=dashes, lw=1.2, marker=MARKERS[number % len(MARKERS)], ms=5, mew=0.6,
            mec="white", color=COLOURS[number % len(COLOURS)], label=name,
        )  # fmt: skip
    axis.set(xscale="log", yscale="log", xlabel="CPU seconds")
    style.number_logs(axis.xaxis)
    axis.set_title(title)


def growth(path: Path, panels: Mapping[str, Mapping[str, Sequence[tuple[float, float]]]], xlabel: str) -> None:
    """Lines on logarithmic axes. panels: label of the vertical axis -> line -> points."""
    names = list(dict.fromkeys(line for panel in panels.values() for line in panel))
    with style.figure(path, figsize=(0.8 + 4.2 * len(panels), 3.9)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for axis, (label, lines) in zip(axes, panels.items(), strict=True):
            for name, points in lines.items():
                number = names.index(name)
                axis.plot(*zip(*points, strict=True), "o-", ms=5, color=COLOURS[number], label=name)
            axis.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=label)
        if len(names) > 1:
            legend(figure, axes)


def legend(figure: Any, axes: Any) -> None:
    """One legend for all panels, below them."""
    handles: dict[str, Any] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        columns = min(len(handles), 5)
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=columns, columnspacing=1.4)
