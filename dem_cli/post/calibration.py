"""calibration.png: displacement against failure load of all profiles tried (thesis Figure 7-40)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.post import style

_MARKERS = "osD^vP<>Xph*"
_COLOURS = ("#1f5fa8", "#e08214", "#2a8c5b", "#8250a8", "#5aa0d8", "#a6761d", "#c51b7d")
_MEASURED = "#c0392b"


def draw_calibration(summary: Mapping[str, Any], path: Path) -> None:
    """One marker per shape, larger with the aperture; the measured point, and a ring around the closest one.

    summary: that of `dem calibrate`.
    """
    measured, best = summary["measured"], summary["closest"]
    answered = [row for row in summary["trials"] if row["distance"] is not None]
    shapes = list(dict.fromkeys(row["shape"] for row in answered if row["shape"] is not None))
    apertures = sorted({row["aperture"] for row in answered if row["shape"] is not None})
    largest = max([measured["displacement"], *(row["displacement"] for row in answered)])
    factor, unit = style.length_unit(largest)
    with style.figure(path, figsize=(7.4, 4.6)) as figure:
        axis = figure.subplots()
        for i, shape in enumerate(shapes):
            rows = sorted((row for row in answered if row["shape"] == shape), key=lambda row: row["aperture"])
            loads, places = [row["failure_load"] for row in rows], [factor * row["displacement"] for row in rows]
            colour = _COLOURS[i % len(_COLOURS)]
            axis.plot(loads, places, color=colour, lw=1.0, alpha=0.5)
            sizes = [25.0 + 18.0 * apertures.index(row["aperture"]) for row in rows]
            axis.scatter(
                loads, places, s=sizes, marker=_MARKERS[i % len(_MARKERS)], color=colour, lw=0, zorder=3, label=shape
            )
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
        _shares(axis, summary["trials"][0]["failure_load"])
        figure.legend(loc="outside right center", title="shape")
        title = f"{summary['title']}: shape {best['shape']} with {1e3 * best['aperture']:.3g} mm comes closest"
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")


def _shares(axis: Any, plane: float | None) -> None:
    """A second scale above: loads as shares of that of plane joints."""
    if not plane:
        return
    above = axis.secondary_xaxis("top", functions=(lambda load: load / plane, lambda share: share * plane))
    above.set_xlabel("λ / λ of plane joints")
