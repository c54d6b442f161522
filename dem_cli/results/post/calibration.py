"""Draw calibration.png: displacement against failure load of all profiles tried (thesis Figure 7-40)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.results.post import style

_MARKERS = "osD^vP<>Xph*"
_COLOURS = ("#1f5fa8", "#e08214", "#2a8c5b", "#8250a8", "#5aa0d8", "#a6761d", "#c51b7d")
_MEASURED = "#c0392b"


def draw_calibration(summary: Mapping[str, Any], path: Path) -> None:
    """Draw one marker per shape, larger with the aperture; the measured point, and a ring around the closest one.

    summary: that of `dem calibrate`.
    """
    answered = [row for row in summary["trials"] if row["distance"] is not None]
    tried = dict.fromkeys(row["shape"] for row in answered if row["shape"] is not None)
    looks = {name: (_COLOURS[i % len(_COLOURS)], _MARKERS[i % len(_MARKERS)]) for i, name in enumerate(tried)}
    with style.figure(path, figsize=(7.4, 4.6)) as figure:
        columns = figure.add_gridspec(1, 2, width_ratios=(3.6, 1.0))
        _draw_points(figure.add_subplot(columns[0]), summary, answered, looks)
        _draw_shapes(figure, columns[1].subgridspec(max(4, len(looks)), 1), summary["shapes"], looks)
        best = summary["closest"]
        title = f"{summary['title']}: shape {best['shape']} with {1e3 * best['aperture']:.3g} mm comes closest"
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")


def _draw_points(
    axis: Any, summary: Mapping[str, Any], answered: Sequence[dict[str, Any]], looks: Mapping[str, tuple[str, str]]
) -> None:
    measured, best = summary["measured"], summary["closest"]
    apertures = sorted({row["aperture"] for row in answered if row["shape"] is not None})
    largest = max([measured["displacement"], *(row["displacement"] for row in answered)])
    factor, unit = style.length_unit(largest)
    for shape, (colour, marker) in looks.items():
        rows = sorted((row for row in answered if row["shape"] == shape), key=lambda row: row["aperture"])
        loads, places = [row["failure_load"] for row in rows], [factor * row["displacement"] for row in rows]
        axis.plot(loads, places, color=colour, lw=1.0, alpha=0.5)
        sizes = [25.0 + 18.0 * apertures.index(row["aperture"]) for row in rows]
        axis.scatter(loads, places, s=sizes, marker=marker, color=colour, lw=0, zorder=3)
    axis.scatter(
        best["failure_load"], factor * best["displacement"], s=230, marker="o", fc="none", ec=style.INK, lw=1.3,
        zorder=4, label="closest",
    )  # fmt: skip
    axis.scatter(
        measured["failure_load"], factor * measured["displacement"], s=150, marker="*", color=_MEASURED,
        zorder=5, label="measured",
    )  # fmt: skip
    axis.set_ylim(0.0, 1.1 * factor * largest)
    axis.margins(x=0.08)
    axis.locator_params(axis="x", nbins=6)
    axis.set_xlabel("failure load multiplier λ")
    axis.set_ylabel(f"displacement before failure [{unit}]")
    axis.legend(loc="lower left", markerscale=0.7)
    plane = summary["trials"][0]["failure_load"]
    if plane:
        above = axis.secondary_xaxis("top", functions=(lambda load: load / plane, lambda share: share * plane))
        above.set_xlabel("λ / λ of plane joints")


def _draw_shapes(figure: Any, cells: Any, shapes: Mapping[str, Any], looks: Mapping[str, tuple[str, str]]) -> None:
    """Draw the legend of the shapes: the polygon on its flat surface, heights exaggerated."""
    for i, (shape, (colour, marker)) in enumerate(looks.items()):
        axis = figure.add_subplot(cells[i])
        places, rises = shapes[shape]["places"], shapes[shape]["rises"]
        top = 2.2 * max(rises)
        axis.fill([*places, 1.0, 0.0], [*rises, top, top], fc=style.STONE, lw=0)
        axis.plot(places, rises, color=colour, lw=1.4)
        axis.axhline(0.0, color=style.STONE_EDGE, lw=1.0)
        axis.scatter(-0.12, 0.5 * top, s=60, marker=marker, color=colour, lw=0, clip_on=False)
        axis.set_title(shape, fontsize=10)
        axis.set_xlim(-0.2, 1.02)
        axis.axis("off")
