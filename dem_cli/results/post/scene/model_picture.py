"""Picture of a model before a run (`dem check --plot`): blocks, hatched supports, loads as arrows, caption."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.results.output.paraview.vertices import rest_vertices
from dem_cli.results.post import style
from dem_cli.results.post.collapse import window
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint
from dem_cli.results.post.scene.drawing import Drawing, drawing_of

DEAD, LIVE = style.THRUST, style.COLLAPSE
_LONGEST = 0.14  # of the size of what is shown: the arrow of the largest force
_SHORTEST = 0.3  # of that: arrows are no shorter
_WIDE, _MARGIN = 2.0, 0.02  # ground so much wider than what stands on it is cut off; empty space around all
_NONE = 1e-9  # of the largest force
_WIDTH, _NARROWEST, _TALLEST, _ROOM = 8.0, 5.4, 8.5, 1.15  # inches: of a picture, of its drawing, for words


class ModelFacts(NamedTuple):
    """Text beside the drawing of a model."""

    title: str
    lines: Sequence[str]  # what the model is made of
    gravity: float  # [m/s2]
    pushed: np.ndarray | None = None  # unit direction of live loads that are a share of the weight, (d,)
    shaken: np.ndarray | None = None  # unit direction in which the ground moves, (d,)
    marks: Sequence[tuple[str, np.ndarray]] = ()  # monitors: name and place


def draw_model(model: Model, facts: ModelFacts, path: Path, asked: Standpoint = AS_BEST) -> None:
    """Draw the model. Raises UsageError for an impossible viewpoint."""
    drawing = drawing_of(model, None, asked)
    corners = rest_vertices(model)
    low, high = _shown(model, drawing.flat(corners))
    reach = _LONGEST * float((high - low).max())
    arrows = _forces(model, facts, drawing, reach)
    if arrows:
        ends = np.concatenate([np.stack([tail, tip]) for tail, tip, _ in arrows])
        low, high = np.minimum(low, ends.min(axis=0) - 0.1 * reach), np.maximum(high, ends.max(axis=0) + 0.1 * reach)
    extent = high - low
    height = min(_TALLEST, _WIDTH * extent[1] / extent[0])
    width = max(_NARROWEST, min(_WIDTH, height * extent[0] / extent[1]))
    with style.figure(path, figsize=(width, height + _ROOM)) as figure:
        axis = figure.subplots()
        drawing.draw_blocks(axis, low, high)(corners)
        drawing.draw_supports(axis, style.GREY)
        for tail, tip, colour in arrows:
            shape = {"arrowstyle": "-|>,head_width=0.25,head_length=0.5", "color": colour, "lw": 1.6, "shrinkA": 0}
            axis.annotate("", tip, tail, arrowprops={**shape, "shrinkB": 0}, zorder=5, annotation_clip=False)
        for name, place in facts.marks:
            at = drawing.flat(place[np.newaxis])[0]
            axis.plot(*at, "o", ms=4.5, mfc="white", mec=style.INK, zorder=6)
            axis.annotate(name, at, (4, 4), textcoords="offset points", fontsize=8, zorder=6, annotation_clip=False)
        axis.set_aspect("equal")
        axis.set_xlim(low[0], high[0])
        axis.set_ylim(low[1], high[1])
        axis.axis("off")
        drawing.finish(axis)
        axis.set_title("\n".join(facts.lines), fontsize=9, fontweight="normal")
        size = min(12.0, 12.0 * 8.5 * width / max(len(facts.title), 1))
        figure.suptitle(facts.title, x=0.01, ha="left", fontsize=size, fontweight="bold")
        _legend(figure, model, facts, {colour for _, _, colour in arrows})


def _shown(model: Model, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the limits of the picture; ground far wider than the structure is cut."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    free = ~model.fixed[model.vertex_blocks]
    standing = np.ptp(corners[free] if free.any() else corners, axis=0)
    if (high - low).max() > _WIDE * standing.max():
        return window(model, [corners])
    margin = _MARGIN * float((high - low).max())
    return low - margin, high + margin


def _forces(
    model: Model, facts: ModelFacts, drawing: Drawing, reach: float
) -> list[tuple[np.ndarray, np.ndarray, str]]:
    """Return arrows of all forces except self-weight: tail, tip and colour in the picture.

    A force acts along its line; where it stands at a distance from the centroid, that is where its moment puts it.
    """
    d = model.dimension
    dead = model.dead_loads.copy()
    dead[:, d - 1] += model.masses * facts.gravity
    live = np.zeros_like(dead) if facts.pushed is not None else model.live_loads
    sizes = [np.linalg.norm(loads[:, :d], axis=1) for loads in (dead, live)]
    weight = _NONE * float(model.masses.max() * facts.gravity)
    largest = [float(size.max(initial=0.0)) for size in sizes]
    found = []
    for loads, size, most, colour in zip((dead, live), sizes, largest, (DEAD, LIVE)):
        for k in np.flatnonzero(size > max(weight, _NONE * most)) if most > weight else ():
            force = loads[k, :d]
            tip = model.centroids[k] + _arm(force, loads[k, d:])
            along = drawing.flat(np.stack([tip - force / size[k], tip]))
            length = reach * max(_SHORTEST, size[k] / most)
            found.append((along[1] - length * (along[1] - along[0]), along[1], colour))
    found += _as_a_whole(model, facts, drawing, reach)
    return found


def _arm(force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the arm from the centroid to the line of action of a force with a moment [m]."""
    if len(force) == 2:
        return moment[0] * np.array([-force[1], force[0]]) / float(force @ force)
    return np.cross(force, moment) / float(force @ force)


def _as_a_whole(
    model: Model, facts: ModelFacts, drawing: Drawing, reach: float
) -> list[tuple[np.ndarray, np.ndarray, str]]:
    """Return one arrow for a load on all blocks, at the middle of all that can move, or of the ground below it."""
    free = ~model.fixed if not model.fixed.all() else model.fixed
    found = []
    if facts.pushed is not None:
        middle = np.average(model.centroids[free], axis=0, weights=model.masses[free])
        tail, tip = drawing.flat(np.stack([middle, middle + facts.pushed]))
        found.append((tail, tail + 1.3 * reach * (tip - tail), LIVE))
    if facts.shaken is not None:
        corners = rest_vertices(model)
        foot = corners.mean(axis=0)
        foot[-1] = corners[:, -1].min()
        middle, tip = drawing.flat(np.stack([foot, foot + facts.shaken]))
        found += [(middle, middle + sign * reach * (tip - middle), LIVE) for sign in (1.0, -1.0)]
    return found


def _legend(figure: Any, model: Model, facts: ModelFacts, drawn: set[str]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if model.fixed.any():
        handles.append(Patch(facecolor=style.GROUND, edgecolor=style.GREY, hatch="////", label="fixed"))
    if DEAD in drawn:
        handles.append(Line2D([], [], color=DEAD, lw=2, marker=">", label="dead load"))
    words = "λ × weight" if facts.pushed is not None else "ground motion" if facts.shaken is not None else "live load"
    if LIVE in drawn:
        handles.append(Line2D([], [], color=LIVE, lw=2, marker=">", label=words))
    if facts.marks:
        handles.append(Line2D([], [], color=style.INK, lw=0, marker="o", mfc="white", label="monitor"))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9, handlelength=1.8)
