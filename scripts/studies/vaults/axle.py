"""Influence line of a masonry arch: the axle that it carries at each place, bare and under fill."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.post import style
from studies.solution import bracket_of
from studies.template import table
from studies.vaults.runs import solved

SPAN, RISE, RING = 6.0, 1.5, 0.45
CROWN = RISE + RING
PLACES = np.round(np.arange(0.3, SPAN - 0.29, 0.15), 3)
BRIDGE = {"kind": "bridge", "span": SPAN, "rise": RISE, "ring": RING, "voussoirs": 21}
FILL = {"structure": "bridge", "density": 1900.0, "level": CROWN + 0.2, "extent": [-0.5, SPAN + 0.5]}
FRICTION = 0.7


def measure() -> dict[str, Any]:
    """Failure load of an axle of 1 kN per metre of width at each place [kN/m]."""
    found = {}
    for name, fill, spread in (("bare ring", [], 0.0), ("under fill", [FILL], 0.5)):
        found[name] = [_carried(float(x), fill, spread) for x in PLACES]
    return found


def _carried(x: float, fill: list[dict[str, Any]], spread: float) -> dict[str, Any]:
    load = {"at": [x, FILL["level"]], "force": [0.0, -1000.0], "kind": "live"} | ({"spread": spread} if spread else {})
    analysis = {"kind": "pushover", "pattern": "live", "resolution": 2e-3}
    tables = {"dimension": 2, "load": [load], "fill": fill}
    summary = solved(BRIDGE, {"friction": FRICTION}, analysis, **tables).summary
    limit = summary.get("limit_analysis") or {}
    return {
        "x": x,
        "status": summary["status"],
        "dem": bracket_of(summary, 3),
        "associated": limit.get("associated") and round(float(limit["associated"]), 3),
    }


def error(row: dict[str, Any]) -> float:
    """How far the middle of the bracket lies above the associated load, relative."""
    return sum(row["dem"]) / 2.0 / row["associated"] - 1.0


def values(found: dict[str, Any]) -> dict[str, str]:
    """Table of the page."""
    rows = []
    for name, line in found.items():
        there = [row for row in line if row["dem"][1] is not None and row["associated"]]
        least = min(there, key=lambda row: row["dem"][0])
        errors = [error(row) for row in there]
        rows.append(
            [
                name,
                f"{len(there)} of {len(line)}",
                f"{least['dem'][0]:.1f}",
                f"{least['x'] / SPAN:.3f}",
                f"{100.0 * min(errors):+.2f} to {100.0 * max(errors):+.2f} %",
            ]
        )
    head = ["arch", "places where it fails", "least axle [kN/m]", "at x / span", "dem over associated limit analysis"]
    return {"axle": table(head, rows), "span": f"{SPAN:g}", "rise": f"{RISE:g}", "ring": f"{RING:g}"}


def draw(found: dict[str, Any], path: Path) -> None:
    """Failure load over the place of the axle."""
    with style.figure(path, figsize=(6.4, 4.2)) as figure:
        axis = figure.subplots()
        for (name, line), colour in zip(found.items(), (style.STAGE_COLOURS["loading"], style.COLLAPSE), strict=True):
            there = [row for row in line if row["dem"][1] is not None and row["associated"]]
            at = [row["x"] / SPAN for row in there]
            axis.plot(at, [row["associated"] for row in there], color=colour, lw=1.0, label=f"{name}, limit analysis")
            axis.plot(at, [sum(row["dem"]) / 2.0 for row in there], "o", ms=3.5, color=colour, label=f"{name}, dem")
        axis.set(xlabel="place of the axle / span", ylabel="failure load [kN/m]", yscale="log", xlim=(0.0, 1.0))
        axis.legend(loc="lower center", fontsize=8)


PICTURES = {"axle": draw}
