"""Draw fragility.png: share of records that a structure does not survive, against intensity (thesis Figure 6-8)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.output.ending import median_words
from dem_cli.results.output.reader import Results
from dem_cli.results.post import style

_FIT, _BAND, _STEPS, _LEVELS = "#1f5fa8", "#c9daec", style.INK, "#e08214"


def has_curve(results: Results) -> bool:
    """Test whether the results have a fragility curve."""
    return results.kind == "fragility" and bool(results.summary.get("collapse_intensities"))


def draw_fragility(results: Results, path: Path) -> None:
    """Draw collapse intensities as steps, the lognormal fit with its confidence, shares at given levels as points."""
    summary = results.summary
    with style.figure(path, figsize=(7.2, 4.6)) as figure:
        axis = figure.add_subplot()
        _draw_fit(axis, summary)
        _draw_steps(axis, summary)
        _draw_levels(axis, summary)
        unit = summary["unit_acceleration"]
        axis.set_ylim(-0.02, 1.02)
        axis.set_ylabel("share collapsed")
        axis.set_xlabel("intensity" if unit != 1.0 else "peak ground acceleration [m/s²]")
        if unit != 1.0:
            above = axis.secondary_xaxis("top", functions=(lambda a: a * unit, lambda a: a / unit))
            above.set_xlabel("peak ground acceleration [m/s²]")
        figure.legend(loc="outside lower center", ncols=2, fontsize=9)
        _headline(figure, summary)


def _draw_fit(axis: Any, summary: Mapping[str, Any]) -> None:
    curve, sure = summary.get("curve"), summary.get("confidence")
    if not curve:
        return
    if sure:
        label = f"{100 * sure['level']:.0f} % confidence"
        axis.fill_between(curve["intensity"], curve["low"], curve["high"], color=_BAND, lw=0, label=label)
    label = f"lognormal: median {summary['median']:.3g}, dispersion {summary['dispersion']:.2g}"
    axis.plot(curve["intensity"], curve["share"], color=_FIT, label=label)


def _draw_steps(axis: Any, summary: Mapping[str, Any]) -> None:
    """Draw the cumulative share of collapse intensities; records without collapse count as not reached."""
    repeats = summary.get("repeats")
    rows = repeats["collapse_intensities"] if repeats else [[a] for a in summary["collapse_intensities"]]
    values = [np.inf if a is None else a for row in rows for a in row]
    found = np.sort([a for a in values if np.isfinite(a)])
    if not len(found):
        return
    tried = summary.get("curve", None) or {"intensity": [found[0], found[-1]]}
    low, high = min(tried["intensity"][0], found[0]), max(tried["intensity"][-1], found[-1])
    at = np.concatenate([[low], found, [high]])
    shares = np.concatenate([[0.0], np.arange(1, len(found) + 1), [len(found)]]) / len(values)
    n_structures = len(rows[0])
    what = f"{len(rows)} records" + (f" × {n_structures} structures" if n_structures > 1 else "")
    axis.step(at, shares, where="post", color=_STEPS, lw=1.2, label=f"collapse at or below, {what}")


def _draw_levels(axis: Any, summary: Mapping[str, Any]) -> None:
    """Draw the share that collapsed at each level, below the steps where structures survived above a collapse."""
    tried = zip(summary.get("levels") or (), summary.get("share") or ())
    levels = [(level, share) for level, share in tried if share is not None]
    if levels:
        axis.plot(*zip(*levels), "o", color=_LEVELS, ms=4.5, label="collapsed at this level", clip_on=False, zorder=3)


def _headline(figure: Any, summary: Mapping[str, Any]) -> None:
    median, title = median_words(summary, 3), str(summary.get("title", ""))
    at = "" if summary.get("median_between") else "at "
    text = title + (f": half collapse {at}{median}" if median else ": no median")
    figure.suptitle(text, x=0.01, ha="left", fontsize=min(12.0, 740.0 / len(text)), fontweight="bold")
