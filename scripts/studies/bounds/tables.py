"""The table of bounds, what is wrong in a row of it, and the error of joints of a few points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from bench.table import percent
from oracle.strong_joints import Points, stress_block_load, toppling_load

from dem_cli.core.contact.layout import lobatto
from studies.template import table

HEAD = ("case", "blocks", "joints", "reduced", "lower bound", "least load", "of", "DEM", "path", "associated",
        "DEM over least", "CPU [s]")  # fmt: skip
LEAST_OF = {"all": "all states", "local": "local", "some": "one state", "none": "none found"}
SAME = 2e-6  # relative: what solvers leave open
ABOVE = 0.002  # relative, over the associated load: the resolution of DEM


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    rows = [row for name, row in found.items() if name != "machine"]
    below = [row for row in rows if row["least"] and row["dem"][0] > (1.0 + 0.005) * row["least"]]
    return {
        "rows": table(HEAD, map(cells, rows)),
        "n": len(rows),
        "met": sum(closed(row) for row in rows),
        "below": ", ".join(f"`{row['name'].split('/')[-1]}`" for row in below),
        "points": table(("points", "inside", "outside"), map(off_the_stress_block, (2, 3, 5, 9))),
    }


def cells(row: Mapping[str, Any]) -> list[str]:
    """A row as text."""
    dem = row["dem"][0]
    over = percent(dem / row["least"] - 1.0) if row["least"] else "–"
    bounds = [load(row["reduced_domain"] or None), load(row["lower_bound"]), load(row["least"])]
    upper = [load(dem), load(row["non_associated"]), load(row["associated"]), over, f"{row['seconds']:.1f}"]
    of = LEAST_OF.get(row["least_of"], "–")
    return [row["name"].split("/")[-1], str(row["blocks"]), str(row["joints"]), *bounds, of, *upper]


def load(value: float | None) -> str:
    """Five digits, or a dash."""
    return "–" if value is None else f"{abs(value):.5g}"


def closed(row: Mapping[str, Any]) -> bool:
    """Whether lower bound and associated load leave one load."""
    return row["lower_bound"] is not None and row["lower_bound"] > (1.0 - ABOVE) * row["associated"]


def problems(row: Mapping[str, Any]) -> list[str]:
    """What contradicts a bound."""
    said, (low, high) = [], row["dem"]
    if low > row["associated"] * (1.0 + ABOVE):
        said.append("DEM is above the associated load")
    for name in ("lower_bound", "least"):
        if row[name] is not None and row["least_of"] != "local" and row[name] > high * (1.0 + SAME):
            said.append(f"DEM is below {name}")
    if row["lower_bound"] and row["least"] and row["lower_bound"] > row["least"] * (1.0 + SAME):
        said.append("the least load is below the lower bound")
    return said


def off_the_stress_block(points: int) -> list[str]:
    """How far the moments that a joint of points carries lie inside and outside the stress block, of its largest."""
    rule, shares = lobatto(points), np.linspace(0.005, 0.995, 199)
    exact = np.array([stress_block_load(1.0, 1.0, n, 1.0) * n for n in shares])
    found = np.array([toppling_load(Points(*rule, 1.0, compression=1.0), 1.0, 1.0, n) * n for n in shares])
    off = (found - exact) / 0.25
    return [str(points), f"{100.0 * max(-off.min(), 0.0):.1f} %", f"{100.0 * max(off.max(), 0.0):.1f} %"]
