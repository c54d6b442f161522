"""Draw collapse.png: the structure at failure and at the end, joints by state, thrust line or force vectors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, Frame
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.reader import Results
from dem_cli.results.post import frame_measures, style
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint
from dem_cli.results.post.scene.drawing import Drawing, drawing_of

MECHANISM = "mechanism"  # of limit analysis
_WIDEST_FORCE = 6.0  # points
_HAIRLINE = 0.02  # joints open by less than this share of the largest displacement are faint
_LEGEND_ROOM = 0.85  # inches


def draw_collapse(results: Results, path: Path, asked: Standpoint = AS_BEST) -> None:
    """Draw one panel at failure and one at the last frame; only one where they are the same."""
    model, panels = results.model, _panels(results)
    drawing = drawing_of(model, panels[-1][1], asked)
    corners = [drawing.flat(rest_vertices(model))]
    drawn = []
    scales = [frame_measures.visible_scale(model, frame) for _, frame in panels]
    if kind_of(results.kind).timed:  # the same structure before and after
        scales = [min(scales)] * len(scales)
    for (name, frame), scale in zip(panels, scales, strict=True):
        shown = frame_measures.scaled(model, frame, scale)
        corners.append(drawing.flat(placed_vertices(model, shown.positions, shown.orientations)))
        drawn.append((name, frame, shown, scale))
    low, high = window(model, corners)
    width, height, rows, columns = _layout(high - low, len(panels))
    with style.figure(path, figsize=(width, height)) as figure:
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis, (name, frame, shown, scale) in zip(axes, drawn, strict=True):
            _draw_panel(axis, drawing, model, shown, scale, low, high)
            axis.set_title(_panel_title(name, frame, scale, results.kind), fontsize=10, fontweight="normal")
        chained = any(len(frame_measures.chains(model, frame_measures.resultants(f.contacts))) for _, f in panels)
        _legend(figure, drawing.legend, chained, any(f.links is not None for _, f in panels))
        style.headline(figure, results.summary)


def _panels(results: Results) -> list[tuple[str, Frame]]:
    """Choose the frame at failure, or the last one under load where there is no failure, and the last one of all."""
    frames = results.frames
    if not len(frames):
        return []
    if results.summary.get("kind") == "limit":
        return [(f"{frame.stage} {MECHANISM}", frame) for frame in frames]
    if kind_of(results.kind).timed:
        return _instants(results)
    if results.kind == "safety":
        return _last_and_first(results)
    last = len(frames) - 1
    first = failure_frame(results)
    if first is None:
        name = "last state under load"
        first = max((i for i in range(len(frames)) if frames[i].stage != "collapse"), default=last)
    else:
        load = results.summary["failure_load"]
        name = "at failure" if abs(frames[first].load - load) <= 0.02 * abs(load) else "near failure"
    panels = [(name, frames[first])]
    if first != last:
        panels.append((frames[last].stage, frames[last]))
    return panels


def _last_and_first(results: Results) -> list[tuple[str, Frame]]:
    """Choose the frames of a safety analysis: the last standing structure, and the first that fails at its end."""
    summary, frames = results.summary, results.frames
    name = "F" if summary["vary"] == "strength" else summary["vary"]
    chosen = {frame.stage == "collapse": frame for frame in (frames[i] for i in range(len(frames)))}
    return [
        (f"{'fails' if fails else 'stands'} at {name} = {summary['fails_at' if fails else 'stands_at']:.5g}", frame)
        for fails, frame in sorted(chosen.items(), key=lambda item: item[0])
    ]


def _instants(results: Results) -> list[tuple[str, Frame]]:
    """Choose the frames of a time history: the start, the collapse or else the largest displacement, and the end."""
    frames, at = results.frames, results.summary.get("collapse_time")
    last = len(frames) - 1
    if at is not None:
        name, middle = "collapse", int(np.abs([frame.time - at for frame in frames]).argmin())
    else:
        name, middle = "farthest", int(np.argmax([frame.displacement for frame in frames]))
    chosen = {0: "start"} | {middle: name} | {last: "end"}
    return [(text, frames[i]) for i, text in sorted(chosen.items())]


def failure_frame(results: Results) -> int | None:
    """Return the frame that leads to failure, under the lowest load that the structure did not carry."""
    if results.summary.get("failure_load") is None:
        return None
    high = results.summary["failure_load_bracket"][1]
    return min(range(len(results.frames)), key=lambda i: abs(results.frames[i].load - high))


def _panel_title(name: str, frame: Frame, scale: float, kind: str) -> str:
    if name.endswith(MECHANISM):
        return f"{name}: λ = {frame.load:.4g}\nof any size: rigid blocks have no displacement at failure"
    factor, unit = style.length_unit(frame.displacement)
    instant = f": {frame.time:.3g} s" if kind_of(kind).timed else f": λ = {frame.load:.4g}"
    instant = "" if kind == "safety" and frame.load == 0.0 else instant
    drawn = "true scale" if scale == 1.0 else f"displacements × {scale:,.0f}"
    return f"{name}{instant}\nmoved {factor * frame.displacement:.3g} {unit}, {drawn}"


def window(model: Model, corners: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Compute the limits of all panels: all blocks with a margin, only the nearby ground. corners: (n_vertices, 2)."""
    free = ~model.fixed[model.vertex_blocks]
    moving = np.concatenate([c[free] if free.any() else c for c in corners])
    everything = np.concatenate(corners)
    margin = 0.05 * np.ptp(moving, axis=0).max()
    low = np.maximum(everything.min(axis=0), moving.min(axis=0) - 2.0 * margin)
    high = np.minimum(everything.max(axis=0), moving.max(axis=0) + 2.0 * margin)
    return low - 0.3 * margin, high + 0.3 * margin


def _layout(extent: np.ndarray, n_panels: int) -> tuple[float, float, int, int]:
    """Compute figure size [inches] and grid: side by side for tall structures, one above the other for long ones."""
    columns = n_panels if extent[0] < 2.2 * extent[1] else 1
    rows = n_panels // columns if n_panels else 1
    columns = max(1, columns)
    width = 5.4 if columns > 1 else 8.0
    panel = (width, width * extent[1] / extent[0])
    if panel[1] > 6.0:
        panel = (max(3.8, 6.0 * extent[0] / extent[1]), 6.0)
    return max(6.4, columns * panel[0]), rows * (panel[1] + 0.35) + _LEGEND_ROOM, rows, columns


def _draw_panel(
    axis: Any, drawing: Drawing, model: Model, frame: Frame, scale: float, low: np.ndarray, high: np.ndarray
) -> None:
    drawing.draw_blocks(axis, low, high)(placed_vertices(model, frame.positions, frame.orientations))
    drawing.draw_rest(axis, low, high)
    drawing.draw_joints(axis, frame, _HAIRLINE * frame_measures.largest_displacement(model, frame) / scale)
    drawing.draw_links(axis, frame)
    _draw_thrust(axis, drawing, model, frame)
    axis.set_aspect("equal")
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.axis("off")
    drawing.finish(axis)


def _draw_thrust(axis: Any, drawing: Drawing, model: Model, frame: Frame) -> None:
    """Draw the thrust line, as thick as the force: through arches and columns, one stroke per joint in walls."""
    from matplotlib.collections import LineCollection

    found = frame_measures.resultants(frame.contacts)
    sizes = np.linalg.norm(found.forces, axis=1)
    if not len(sizes):
        return
    widest = drawing.force_width * _WIDEST_FORCE * min(1.0, 60 / model.n_blocks) ** 0.35
    widths = np.maximum(0.4, widest * sizes / sizes.max())
    lines = frame_measures.chains(model, found)
    if lines:
        points = drawing.flat(found.points)
        strokes = [(points[a], points[b]) for chain in lines for a, b in zip(chain, chain[1:])]
        widths = [(widths[a] + widths[b]) / 2 for chain in lines for a, b in zip(chain, chain[1:])]
    else:
        reach = 0.4 * frame_measures.block_reach(model, found.blocks)
        arms = found.forces / sizes[:, np.newaxis] * reach[:, np.newaxis]
        strokes = list(zip(drawing.flat(found.points - arms), drawing.flat(found.points + arms)))
    axis.add_collection(
        LineCollection(strokes, colors=style.THRUST, linewidths=widths, alpha=0.8, capstyle="round", zorder=4)
    )


def _legend(figure: Any, states: tuple[str, ...], has_line: bool, linked: bool) -> None:
    from matplotlib.lines import Line2D

    columns = 5 if figure.get_figwidth() > 9.0 else 3
    labels = {name: f"{name} joint" for name in STATES} | {"open": "open joint (faint: hairline)"}
    handles = [Line2D([], [], color=style.STATE_COLOURS[name], lw=4, label=labels[name]) for name in states]
    thrust = "thrust line" if has_line else "joint force"
    handles.append(Line2D([], [], color=style.THRUST, lw=3, alpha=0.8, label=f"{thrust} (thickness: size)"))
    if linked:
        handles.append(Line2D([], [], color=style.STEEL, lw=3, label="tie or bar (force)"))
    handles.append(Line2D([], [], color=style.REST, lw=1, ls=(0, (3, 2)), label="undeformed"))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=9, handlelength=1.8)
