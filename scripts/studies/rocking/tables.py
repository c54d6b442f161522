"""Tables of rocking.md: errors of dem over exact motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from bench.table import percent
from oracle.housner import Block

from studies.rocking import defaults, ensembles, free_rocking, overturning
from studies.template import minus
from studies.template import table as markdown

Row = Mapping[str, Any]
THIRD = 60  # pairs that are judged by themselves too


def values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows of rocking.json."""
    errors = [row["error"] for row in table["bounds"]]
    found = [abs(error) for error in errors if error is not None]
    return {
        "free": _free(table["free"], table["free_soft"]), "map": _map(table["map"]),
        "count": len(errors), "missed": len(errors) - len(found), "worst": percent(max(found)).lstrip("+"),
        "bounds": _bounds(table["bounds"]), "pairs": _pairs(table["pairs"]), "slides": _slides(table["slides"]),
        "stacks": _stacks(table["stacks"]), "bounces": _bounces(table["bounces"]), "energy": _energy(table["energy"]),
        **_defaults(table["defaults"]),
    }  # fmt: skip


def _free(stiff: Sequence[Row], soft: Sequence[Row]) -> str:
    keys = {"decay": "one peak over the one before", "wide": "the same, swings above 0.1 α", "peaks": "peaks",
            "times": "times of peaks", "impacts": "times of impacts"}  # fmt: skip
    head = ("kn h/W", "h/b", "swings", *keys.values())
    cells = [
        (stiffness, f"{row['aspect']:g}", str(row["swings"]), *(percent(row[key]) for key in keys))
        for stiffness, rows in (("1e6", stiff), ("1e5", soft))
        for row in rows
    ]
    return markdown(head, cells)


def _map(rows: Sequence[Row]) -> str:
    head = ("contact_fraction", *(f"h/b = {aspect:g}" for aspect in free_rocking.ASPECTS),
            *(f"h/b = {aspect:g}, kn h/W = 1e5" for aspect in free_rocking.ASPECTS))  # fmt: skip
    exact = [f"{Block(1.0, aspect).restitution:.4f}" for aspect in free_rocking.ASPECTS]
    cells = [[f"{row['fraction']:g}", *(f"{r:.4f}" for r in (*row["ratios"], *row["soft"]))] for row in rows]
    return markdown(head, [*cells, ["Housner", *exact, *exact]])


def _bounds(rows: Sequence[Row]) -> str:
    names = {True: "overturns above", False: "stands above"}
    cells = []
    for ratio in dict.fromkeys(row["ratio"] for row in rows):
        here = [row for row in rows if row["ratio"] == ratio]
        said = [f"{row['bound']:.4f} {names[row['overturns_above']]}: {_missed(row)}" for row in here]
        cells.append(
            [f"{ratio:g}", f"{overturning.frequency(overturning.BLOCK, ratio):.3f} Hz", *said, *[""] * (3 - len(here))]
        )
    return markdown(("ω/p", "frequency", "first bound A/(g tan α)", "second", "third"), cells)


def _missed(row: Row) -> str:
    return "not found" if row["error"] is None else percent(row["error"])


def _pairs(rows: Sequence[Row]) -> str:
    head = ("against the oracle", "pairs", "overturned: oracle, other", "outcome changes: falls no more, falls now",
            "McNemar p", "KS distance, p", "median difference of peaks", "median size of it", "peaks higher",
            "signs p")  # fmt: skip
    cells = []
    for name, chosen, other in (
        (f"dem, first {THIRD} pairs", rows[:THIRD], "dem"), ("dem, all", rows, "dem"),
        (f"oracle, records × {ensembles.CHANGE:g}, first {THIRD}", rows[:THIRD], "changed"),
        (f"oracle, records × {ensembles.CHANGE:g}, all", rows, "changed"),
    ):  # fmt: skip
        said = ensembles.judged(chosen, other)
        distance, p = said["kolmogorov_smirnov"]
        cells.append((
            name, str(said["pairs"]), "{}, {}".format(*said["overturned"]), "{}, {}".format(*said["outcomes_changed"]),
            f"{said['mcnemar']:.2f}", f"{distance:.3f}, {p:.2f}", percent(said["median_difference"]),
            percent(said["median_size"]).lstrip("+"), "{} of {}".format(*said["higher"]), f"{said['signs']:.2f}",
        ))  # fmt: skip
    return markdown(head, cells)


def _defaults(rows: Sequence[Row]) -> dict[str, Any]:
    """Table of drawn cases; the worst errors among them, and the block that is none of them."""
    drawn = [row for row in rows if row["kind"] in defaults.KINDS]
    names = {name: f"ε = {name}" for name in defaults.TURNS} | {"before": "kn h/W = 1e5", "default": "default"}
    head = ("", "h/b", "height", "beam", "moved by", "swings", "largest peak", "changes by", *names.values(),
            "steps: kn h/W = 1e5, default", "moves on softer joints")  # fmt: skip
    cells = [
        (row["kind"], f"{row['aspect']:.1f}", f"{row['height']:.2f} m", f"{row['beam']:.2f}" if row["beam"] else "–",
         _drive(row), str(row["swings"]), f"{row['peak']:.3f} α", percent(row["change"]).lstrip("+"),
         *(percent(row["errors"][name]) for name in names), f"{row['steps']['before']:,}, {row['steps']['default']:,}",
         "–" if row["tilt"] else percent(row["moved"]).lstrip("+"))
        for row in drawn
    ]  # fmt: skip
    errors = [percent(max(abs(row["errors"][name]) for row in drawn)).lstrip("+") for name in names]
    worst = (*[""] * 7, "**worst**", *errors, "", "")
    slender = next(row for row in rows if row["kind"] == "slender")
    return {
        "defaults": markdown(head, [*cells, worst]),
        "slender": {"peak": slender["peak"], "change": percent(slender["change"]).lstrip("+")}
        | {name: percent(found) for name, found in slender["errors"].items()}
        | {"moved": percent(slender["moved"]).lstrip("+")},
        "more": f"{sum(r['steps']['default'] for r in drawn) / sum(r['steps']['before'] for r in drawn):.0f}",
    }


def _drive(row: Row) -> str:
    if row["tilt"]:
        return f"tilt of {row['tilt']:.2f} α"
    return f"{row['shape']}, {row['strength']:.2f} g tan α, ω/p = {row['speed']:.1f}"


def _slides(rows: Sequence[Row]) -> str:
    cells = [
        (row["name"], _mm(row["exact"]), f"{1e3 * row['path']:.1f} mm", _mm(row["slip"]),
         percent(row["slip"] / row["exact"] - 1.0), percent((row["slip"] - row["exact"]) / row["path"]))
        for row in rows
    ]  # fmt: skip
    return markdown(("motion", "exact final slip", "way", "dem", "error", "error over the way"), cells)


def _mm(metres: float) -> str:
    return minus(f"{1e3 * metres:.3f} mm")


def _stacks(rows: Sequence[Row]) -> str:
    cells = [
        (
            row["name"],
            row["closes"],
            f"{row['time']:.4f} s",
            percent(row["closure"]),
            percent(row["angles"]).lstrip("+"),
        )
        for row in rows
    ]
    return markdown(("motion", "closes first", "after", "error of that time", "largest error of angles"), cells)


def _bounces(rows: Sequence[Row]) -> str:
    cells = [
        (f"{row['ratio']:g}", f"{row['margin']:g}", *(percent(h) for h in row["heights"]), percent(row["time"]),
         percent(row["overlap"]))
        for row in rows
    ]  # fmt: skip
    head = ("contact_fraction", "margin", "first height", "second", "third", "time of the first", "largest overlap")
    return markdown(head, cells)


def _energy(rows: Sequence[Row]) -> str:
    cells = []
    for name in dict.fromkeys(row["damping"] for row in rows):
        here = [row for row in rows if row["damping"] == name]
        errors = [np.abs(row["closures"]) for row in here]
        means = [float(np.sqrt((e**2).mean())) for e in errors]
        order = np.log(means[0] / means[-1]) / np.log(here[0]["margin"] / here[-1]["margin"])
        cells.append([name, *(f"{m:.1e} ({e.max():.1e})" for m, e in zip(means, errors)), f"{order:.2f}"])
    margins = [f"margin {row['margin']:g}" for row in rows if row["damping"] == rows[0]["damping"]]
    return markdown(("damping", *margins, "order"), cells)
