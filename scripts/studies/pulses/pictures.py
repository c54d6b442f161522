"""The pictures of pulses.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from reference import result

from dem_cli.results.post import style
from studies.pulses import column, domain

Row = Mapping[str, Any]
BOOK, VAULT_BOOK = "dimitri_column_arch", "lemos_arch_pulse"
STYLES = {
    "0.1 of critical": ("#1f5fa8", (0, (4, 2))), "critical": ("#2a8c5b", (0, (1, 1.2))),
    "housner": ("#8250a8", (0, (5, 1.5, 1, 1.5))), "none": ("#e08214", "-"),
}  # fmt: skip
NAMES = {"elastic_s5": "elastic joints, 5 % stiffness", "elastic_mx5": "elastic joints, Maxwell",
         "s5": "no tension, 5 % stiffness", "mx5": "no tension, Maxwell"}  # fmt: skip


def draw_domain(table: Mapping[str, Any], path: Path) -> None:
    """Least amplitudes of all dampings with both published series; on the right where overturning changes its kind."""
    with style.figure(path, figsize=(11.0, 5.2)) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
        for axis in (left, right):
            _least(axis, table)
            axis.set(xlabel="tp [s]", ylabel="amplitude a [g]", yscale="log")
        left.set(xscale="log", xlim=(0.095, 1.05), ylim=(0.18, 5.2))
        _ticks(left.set_xticks, (0.1, 0.2, 0.3, 0.5, 1.0))
        _ticks(left.set_yticks, (0.2, 0.5, 1, 2, 5))
        left.set_title("Least amplitude that overturns the column")
        left.legend(loc="upper right", fontsize=8.5)
        for row in table["column"]:
            _answers(right, row)
        right.set(xlim=(0.293, 0.407), ylim=(0.26, 1.05))
        _ticks(right.set_yticks, (0.3, 0.4, 0.5, 0.6, 0.8, 1.0))
        right.set_title("Bars: falls, 0.35 of critical")
        for axis in (left, right):
            axis.minorticks_off()


def _ticks(put: Any, values: Sequence[float]) -> None:
    put(values, [f"{value:g}" for value in values])


def _least(axis: Any, table: Mapping[str, Any]) -> None:
    rigid = [row for row in table["rigid"] if row["least"]]
    axis.plot([r["tp"] for r in rigid], [r["least"] for r in rigid], color=style.GREY, lw=1.2, label="one rigid block")
    rows = table["column"]
    label = f"dem, {column.MAIN}"
    axis.plot([r["tp"] for r in rows], [r["least"] for r in rows], "-o", ms=4, color=style.COLLAPSE, label=label)
    for name, found in table["others"].items():
        colour, dashes = STYLES[name]
        axis.plot(
            [r["tp"] for r in found],
            [r["least"] for r in found],
            ls=dashes,
            lw=1.3,
            marker=".",
            ms=5,
            color=colour,
            label=f"dem, {name}",
        )
    for key, marker, label in (("col_domain_udec", "s", "UDEC"), ("col_domain_lmgc", "^", "LMGC90")):
        book = result(BOOK, key)
        axis.plot(book["tp_s"], book["value"], marker, ms=6, mfc="none", color=style.INK, label=f"{label} (published)")


def _answers(axis: Any, row: Row) -> None:
    """Bars over the amplitudes of the grid that fall."""
    half = domain.RATIO**0.5
    for amplitude, falls in row["answers"]:
        if falls:
            ends = [amplitude / half, amplitude * half]
            axis.plot([row["tp"]] * 2, ends, color=style.COLLAPSE, alpha=0.25, lw=7, solid_capstyle="butt")


def draw_histories(vault: Mapping[str, Any], path: Path) -> None:
    """Displacement of the crown in the four runs, with the published peaks."""
    with style.figure(path, figsize=(10.5, 6.0)) as figure:
        for axis, (name, title) in zip(figure.subplots(2, 2).flat, NAMES.items()):
            values, step = vault["histories"][name]
            book = result(VAULT_BOOK, f"pulse_{name}")
            axis.plot(step * np.arange(len(values)), values, color=style.COLLAPSE, lw=1.4, label="dem")
            peaks, times = np.atleast_1d(book["value"]), np.atleast_1d(book["time_s"])
            axis.plot(times, 1e3 * peaks, "s", ms=7, mfc="none", color=style.INK, label="3DEC (published)")
            axis.set_title(title)
            axis.set(xlabel="time [s]", ylabel="crown [mm]", xlim=(0.0, 0.8 if "elastic" in name else 2.0))
        figure.axes[0].legend(loc="upper right")


def draw_points(vault: Mapping[str, Any], path: Path) -> None:
    """Peaks against the first frequency, by the places of the contact points."""
    rows = [row for row in vault["variants"] if row["group"] in ("", "points across the ring")]
    with style.figure(path, figsize=(10.0, 4.2)) as figure:
        left, right = figure.subplots(1, 2)
        labels = [row["label"] if row["group"] else "3 points (1/4, 1/2, 1/4)" for row in rows]
        for axis, name, title in ((left, "elastic_s5", "Elastic joints"), (right, "s5", "No-tension joints")):
            values = [1e3 * row[name]["values"][0] for row in rows]
            axis.barh(labels, values, color=[style.COLLAPSE if not row["group"] else style.FAINT for row in rows])
            axis.axvline(1e3 * float(np.atleast_1d(result(VAULT_BOOK, f"pulse_{name}")["value"])[0]), color=style.INK)
            axis.set(xlabel="peak of the crown [mm]; line: 3DEC", title=title)
            axis.invert_yaxis()
        right.set(xlim=(0.0, 30.0), yticklabels=[])
        for k, row in enumerate(rows):
            if row["s5"]["values"][0] > 0.03:
                right.text(29.5, k, "falls", ha="right", va="center", color=style.INK)
