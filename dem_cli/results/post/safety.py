"""Draw safety.png: the runs of a safety analysis, whether they stand or fail, and the steps of their proofs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.results.output.reader import Results
from dem_cli.results.post import style

_STANDS, _FAILS, _UNDECIDED = "#2a8c5b", style.COLLAPSE, style.GREY
_MARKS = {  # answer -> mark, colour, label
    True: ("o", _STANDS, "stands"),
    False: ("X", _FAILS, "fails"),
    None: ("D", _UNDECIDED, "neither proven"),
}
_MARGIN = 0.12  # of the range of values, on both sides
_WIDE = 3.0  # ratio of factors from which their axis is logarithmic


def has_runs(results: Results) -> bool:
    """Test whether the results have runs of a safety analysis."""
    return results.kind == "safety" and bool(results.summary.get("runs"))


def draw_safety(results: Results, path: Path) -> None:
    """Draw solver steps against the value; two panels where the runs next to the answer overlap."""
    summary, runs = results.summary, results.summary["runs"]
    values = [run["value"] for run in runs]
    near = _next_to_the_answer(values, summary)
    panels = [values] if near is None else [values, near]
    with style.figure(path, figsize=(7.2 if len(panels) == 1 else 11.0, 4.2)) as figure:
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, shown in zip(axes, panels, strict=True):
            _draw_runs(axis, runs)
            _draw_answer(axis, summary)
            _range(axis, shown, summary)
        if near is not None:
            for axis, title in zip(axes, ("all runs", "next to the answer"), strict=True):
                axis.set_title(title, fontweight="normal", color=style.GREY)
        axes[0].set_ylabel("solver steps until it was proven")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, columnspacing=1.4)
        style.headline(figure, summary)


def _draw_runs(axis: Any, runs: Sequence[Mapping[str, Any]]) -> None:
    for answer, (mark, colour, label) in _MARKS.items():
        chosen = [(run["value"], run["steps"]) for run in runs if run["stands"] is answer]
        if chosen:
            axis.plot(*zip(*chosen), mark, ms=7, color=colour, mec="white", mew=0.7, label=label, zorder=4)
    axis.set_yscale("log")
    style.number_logs(axis.yaxis, "{x:,.0f}")


def _draw_answer(axis: Any, summary: Mapping[str, Any]) -> None:
    """Draw the bracket and the bound of limit analysis."""
    stands, fails = summary.get("stands_at"), summary.get("fails_at")
    if stands is not None and fails is not None:
        axis.axvspan(*sorted((stands, fails)), color=style.FAILURE, alpha=0.15, lw=0, label="bracket")
        axis.axvline(stands, color=style.FAILURE, lw=0.9)
    impossible = (summary.get("limit_analysis") or {}).get("impossible_at")
    if impossible is not None:
        axis.axvline(impossible, color=style.LIMIT, lw=1.2, ls=(0, (5, 2)), label="limit analysis: nothing beyond")


def _range(axis: Any, values: Sequence[float], summary: Mapping[str, Any]) -> None:
    low, high = min(values), max(values)
    of_strength = summary["vary"] == "strength"
    if of_strength and high > _WIDE * low:
        ratio = (high / low) ** _MARGIN
        axis.set_xscale("log")
        axis.set_xlim(low / ratio, high * ratio)
    else:
        margin = _MARGIN * ((high - low) or abs(low) or 1.0)
        axis.set_xlim(low - margin, high + margin)
        axis.ticklabel_format(axis="x", useOffset=False)
        axis.locator_params(axis="x", nbins=5)
    axis.set_xlabel("factor F on " + ", ".join(summary["reduce"]) if of_strength else summary["vary"])


def _next_to_the_answer(values: Sequence[float], summary: Mapping[str, Any]) -> list[float] | None:
    """Return the values around the bracket, where all values together hide them."""
    stands, fails = summary.get("stands_at"), summary.get("fails_at")
    if stands is None or fails is None:
        return None
    width, span = abs(stands - fails), max(values) - min(values)
    if span <= 20.0 * width:
        return None
    return [min(stands, fails) - 3.0 * width, max(stands, fails) + 3.0 * width]
