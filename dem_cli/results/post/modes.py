"""Draw modes.png: natural modes, each with its frequency and effective mass."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.core.records.frames import Frame
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.reader import Results
from dem_cli.results.post import style
from dem_cli.results.post.collapse import window
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint
from dem_cli.results.post.scene.drawing import drawing_of

MOST_MODES = 12  # modes in one picture
STAGE = "mode"  # of their frames, whose step is the number of the mode
_TITLE_ROOM = 0.55  # inches
_WIDEST, _HIGHEST = 10.5, 2.9  # inches: of the picture, of a panel


def draw_modes(results: Results, path: Path, asked: Standpoint = AS_BEST) -> None:
    """Draw a panel for each mode at the scale of its frame; dashed: undeformed."""
    model, frames = results.model, shapes(results)
    drawing = drawing_of(model, frames[0], asked)
    corners = [placed_vertices(model, frame.positions, frame.orientations) for frame in frames]
    low, high = window(model, [drawing.flat(places) for places in (rest_vertices(model), *corners)])
    width, height, rows, columns = _layout(high - low, len(frames))
    with style.figure(path, figsize=(width, height)) as figure:
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis in axes:
            axis.axis("off")
        for axis, frame, moved in zip(axes, frames, corners):
            drawing.draw_blocks(axis, low, high)(moved)
            drawing.draw_rest(axis, low, high)
            axis.set_aspect("equal")
            axis.set_xlim(low[0], high[0])
            axis.set_ylim(low[1], high[1])
            drawing.finish(axis)
            axis.set_title(_panel_title(results.summary, frame.step), fontsize=9, fontweight="normal")
        title = f"{results.summary.get('title', '')}: natural modes"
        size = min(12.0, 12.0 * 8.5 * width / len(title))
        figure.suptitle(title, x=0.01, ha="left", fontsize=size, fontweight="bold")


def shapes(results: Results) -> list[Frame]:
    """Return the frames of the first modes."""
    found: list[Frame] = [frame for frame in results.frames if frame.stage == STAGE]
    return found[:MOST_MODES]


def _panel_title(summary: Mapping[str, Any], number: int) -> str:
    frequency = summary["frequencies"][number - 1]
    shares = [
        f"{axis} {100 * masses[number - 1] / summary['total_mass']:.2g} %"
        for axis, masses in summary["effective_masses"].items()
        if masses[number - 1] >= 0.005 * summary["total_mass"]
    ]
    return f"{number}: {frequency:.4g} Hz\n" + (f"mass along {', '.join(shares)}" if shares else "")


def _layout(extent: Any, n_panels: int) -> tuple[float, float, int, int]:
    """Compute figure size [inches] and grid: as many panels side by side as fit."""
    height = min(_HIGHEST, 0.5 * _WIDEST * extent[1] / extent[0])
    width = max(height * extent[0] / extent[1], 1.5)
    columns = max(1, min(n_panels, int(_WIDEST / width)))
    rows = math.ceil(n_panels / columns)
    columns = math.ceil(n_panels / rows)
    return max(columns * width, 5.0), rows * (height + _TITLE_ROOM) + 0.4, rows, columns
