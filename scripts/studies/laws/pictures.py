"""Pictures: what a law answers along displacement paths, as panels of lines."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.post import style
from studies.laws.driven_point import Graph, LawPage

COLOURS = {"blue": style.THRUST, "red": style.STAGE_COLOURS["collapse"], "green": style.LIMIT, "ink": style.INK,
           "orange": style.STATE_COLOURS["sliding"], "grey": style.GREY}  # fmt: skip


def draw(page: LawPage, file: Path) -> None:
    """One picture with the panels of a page side by side."""
    panels = page.panels(page)
    with style.figure(file, figsize=(4.2 * len(panels), 3.4)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for ax, panel in zip(axes, panels, strict=True):
            ax.set_title(panel.title)
            ax.set_xlabel(panel.x)
            ax.set_ylabel(panel.y)
            if panel.log:
                ax.set_xscale("log")
            for line in panel.lines:
                plot(ax, line)
            if any(line.label for line in panel.lines):
                ax.legend(fontsize=8, loc=panel.legend)


def plot(ax: Any, line: Graph) -> None:
    """One line with arrows along it, or points with their scatter."""
    colour = COLOURS[line.colour]
    if line.points:
        ax.errorbar(line.x, line.y, yerr=line.scatter, fmt="o", color=colour, ms=4, capsize=2, lw=1, label=line.label)
        return
    ax.plot(line.x, line.y, line.dash, color=colour, lw=line.width, label=line.label)
    x, y = np.asarray(line.x), np.asarray(line.y)
    for share in line.arrows:
        i = min(int(share * len(x)), len(x) - 2)
        tip = style.INK if line.width > 3.0 else colour
        ax.annotate(
            "", xy=(x[i + 1], y[i + 1]), xytext=(x[i], y[i]),
            arrowprops={"arrowstyle": "-|>", "color": tip, "lw": 0, "mutation_scale": 14},
        )  # fmt: skip
