"""imperfections.png: the wall with the failure load of each low block; case_imperfections.png: what errors do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib import colormaps
from matplotlib.colors import Normalize
from matplotlib.patches import Rectangle

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.results.post import style

LENGTH, HEIGHT, BLOCKS = 40.0, 17.5, 3  # [mm], [mm], in a full course
LOW, HIGH = 0.4, 0.6  # ends of the colour scale
DARK = 0.5  # of it: from there on letters are white
THESIS, NEAR = {1.0: 0.51, 0.5: 0.54}, 0.03  # loads by error [mm]; blocks with a load as near are framed
PANELS = [(size, way) for size in (1.0, 0.5) for way in ("first", "last")]
TITLES = {"first": "first motion", "last": "collapse"}


def draw(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """One panel for each size of the error and way to fail; whole top lower."""
    colours, scale = colormaps["Oranges"], Normalize(-HIGH, -LOW)
    with style.figure(path, figsize=(9.0, 8.4)) as figure:
        for axis, (size, way) in zip(figure.subplots(2, 2).flat, PANELS):
            for row in rows:
                usual = row["laid"] and not row["step"] and row["shape"] == "whole top"
                if usual and row["size"] == size:
                    _block(axis, row["block"], row[way]["load"], THESIS[size], lambda load: colours(scale(-load)))
            axis.set_title(f"{size:g} mm lower: {TITLES[way]} (thesis {THESIS[size]:g})")
            axis.set(xlim=(-2.0, LENGTH * BLOCKS + 2.0), ylim=(-6.0, HEIGHT * 6 + 2.0), aspect="equal")
            axis.axis("off")
            axis.axhspan(-6.0, 0.0, color=style.GROUND, lw=0)


def _block(axis: Any, name: str, load: float | None, thesis: float, colour: Callable[[float], Any]) -> None:
    """A rectangle with its load, framed where that comes near the load of the thesis."""
    course, number = (int(word) for word in name.split("-")[1:])
    half = course % 2 == 1  # courses 1, 3 and 5 begin and end with half blocks
    left = max((number - 1.5) * LENGTH, 0.0) if half else (number - 1) * LENGTH
    right = min((number - 0.5) * LENGTH, BLOCKS * LENGTH) if half else number * LENGTH
    place = (left, (course - 1) * HEIGHT)
    face = "white" if load is None else colour(load)
    near = load is not None and abs(load / thesis - 1.0) < NEAR
    axis.add_patch(
        Rectangle(place, right - left, HEIGHT, facecolor=face, edgecolor=style.LIMIT if near else style.STONE_EDGE,
                  lw=3.0 if near else 0.8, zorder=2 if near else 1)
    )  # fmt: skip
    ink = "white" if load is not None and load < HIGH - DARK * (HIGH - LOW) else style.INK
    text = "–" if load is None else f"{load:.3f}"
    middle = ((left + right) / 2.0, place[1] + HEIGHT / 2.0)
    axis.text(*middle, text, ha="center", va="center", fontsize=9, color=ink, zorder=3)


WALL = {"kind": "wall", "block": [0.4, 0.2], "courses": 6, "blocks_per_course": 4}
ERRORS = {
    "height and length drawn, laid again": {"height": [-0.02, 0.02], "length": [-0.02, 0.02]},
    "wedges and leaning, laid again": {"wedge": [-0.02, 0.02], "lean": 0.1},
    "lower, left in place": {"height": [-0.02, 0.0], "restack": False},
}


def walls(path: Path) -> None:
    """Walls with errors large enough to be seen."""
    with style.figure(path, figsize=(11.0, 3.6)) as figure:
        for axis, (title, errors) in zip(figure.subplots(1, len(ERRORS)), ERRORS.items()):
            tables = {"materials": {"stone": {"density": 2000.0}}, "joints": {"dry": {"friction": 0.6}}}
            tables |= {"structure": [WALL], "imperfection": [errors]}
            for block in assembly(validate(tables, make_case_model(), CaseSource(path, ""))).blocks:
                colour = style.GROUND if block.fixed else style.STONE
                for part in block.parts:
                    axis.fill(*part.T, facecolor=colour, edgecolor=style.STONE_EDGE, lw=0.8)
            axis.set_title(title)
            axis.set_aspect("equal")
            axis.axis("off")
