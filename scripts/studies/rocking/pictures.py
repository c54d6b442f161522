"""The pictures of rocking.md."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from oracle.housner import Block, rock

from dem_cli.results.post import style
from studies.rocking import free_rocking, overturning
from studies.rocking.ensembles import CHANGE, FALLS

Row = Mapping[str, Any]
FINER, HIGHER = 150, 240  # cells of the shaded picture across and up


def draw_swings(rows: Sequence[Row], path: Path) -> None:
    """Angles over time, one panel per slenderness: lines exact, dots where dem turns back."""
    with style.figure(path, figsize=(10.0, 6.2)) as figure:
        for axis, row in zip(figure.subplots(2, 2).flat, rows):
            block = Block(free_rocking.HEIGHT / row["aspect"], free_rocking.HEIGHT)
            times, peaks = row["turns"]
            exact = rock(block, duration=times[-1] + 0.1, angle=free_rocking.START * block.alpha)
            axis.plot(exact.times, exact.angles / block.alpha, color=style.GREY, lw=1.2, label="exact")
            signs = -((-1.0) ** np.arange(len(peaks)))
            axis.plot(times, signs * np.array(peaks) / block.alpha, "o", ms=4, color=style.COLLAPSE, label="dem")
            axis.set_title(f"h/b = {row['aspect']:g}")
            axis.set(xlabel="time [s]", ylabel="θ / α", ylim=(-0.65, 0.65))
        figure.axes[0].legend(loc="upper right")


def draw_bounds(rows: Sequence[Row], path: Path) -> None:
    """Where the oracle overturns, and the bounds that dem has."""
    ratios = np.linspace(min(overturning.RATIOS), max(overturning.RATIOS), FINER)
    strengths = np.exp(np.linspace(0.0, math.log(overturning.HIGHEST), HIGHER))
    falls = np.array([[overturning.exact(overturning.BLOCK, ratio, x) for ratio in ratios] for x in strengths])
    with style.figure(path, figsize=(7.5, 5.0)) as figure:
        axis = figure.subplots()
        axis.pcolormesh(
            ratios, strengths, np.where(falls, 1.0, np.nan), cmap="Oranges", vmin=0.0, vmax=3.0, rasterized=True
        )
        found = [row for row in rows if row["error"] is not None]
        axis.plot([r["ratio"] for r in found], [r["bound"] * (1.0 + r["error"]) for r in found], "o", ms=5,
                  color=style.COLLAPSE, label="bound of dem")  # fmt: skip
        missed = [row for row in rows if row["error"] is None]
        if missed:
            axis.plot(
                [r["ratio"] for r in missed], [r["bound"] for r in missed], "x", color=style.INK, label="not found"
            )
        axis.fill_between([], [], [], color="#fdd0a2", label="exact: overturns")
        axis.set(xlabel="ω / p", ylabel="A / (g tan α)", yscale="log", ylim=(1.0, overturning.HIGHEST))
        axis.set_yticks([1, 2, 4, 8, 16], ["1", "2", "4", "8", "16"])
        axis.minorticks_off()
        axis.legend(loc="lower right")
        axis.set_title("One sine: h/b = 4")


def draw_pairs(rows: Sequence[Row], path: Path) -> None:
    """Distributions of peaks, and dem and a slightly stronger record against the oracle, pair by pair."""
    exact = np.array([row["exact"] for row in rows])
    others = {"dem": style.COLLAPSE, "changed": style.THRUST}
    names = {"dem": "dem", "changed": f"oracle, records × {CHANGE:g}"}
    with style.figure(path, figsize=(10.5, 4.6)) as figure:
        left, right = figure.subplots(1, 2)
        share = np.arange(1, len(exact) + 1) / len(exact)
        left.step(np.sort(exact), share, color=style.INK, lw=2.4, label="oracle", where="post")
        for name, colour in others.items():
            values = np.sort([row[name] for row in rows])
            left.step(values, share, color=colour, lw=1.2, label=names[name], where="post")
        left.set(
            xlabel="peak |θ| / α (2: overturned)", ylabel="share of pairs", xlim=(0.0, FALLS + 0.05), ylim=(0.0, 1.0)
        )
        left.set_title(f"{len(exact)} pairs")
        left.legend(loc="lower right", bbox_to_anchor=(0.94, 0.0))
        for name, marker in (("changed", "x"), ("dem", "o")):
            right.plot(
                exact, [row[name] for row in rows], marker, ms=4, alpha=0.7, color=others[name], label=names[name]
            )
        right.plot([0.0, FALLS], [0.0, FALLS], color=style.GREY, lw=0.8, zorder=0)
        right.set(xlabel="peak |θ| / α of the oracle", ylabel="peak |θ| / α", xlim=(0.0, 2.05), ylim=(0.0, 2.05))
        right.set_title("Pair by pair")
        right.legend(loc="lower right", bbox_to_anchor=(0.95, 0.0))
