"""rocking.md and its pictures are made from rocking.json alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from oracle.housner import Block

from dem_cli.bench.machine import sentence
from dem_cli.bench.table import lines_of, percent
from rockingtable import ensembles, free, picture, pulses
from rockingtable.words import BOUNCE, BOUNDS, ENERGY, FREE, HEAD, MAP, PAIRS, SLIDES, STACKS

Row = Mapping[str, Any]
THIRD = 60  # pairs that are judged by themselves too


def write(folder: Path, table: Mapping[str, Any]) -> None:
    """Page and pictures into `folder`."""
    (folder / "rocking.md").write_text(render(table), encoding="utf-8")
    picture.free_rocking(folder / "rocking_free.png", table["free"])
    picture.overturning(folder / "rocking_pulses.png", table["bounds"])
    picture.ensembles(folder / "rocking_pairs.png", table["pairs"])


def render(table: Mapping[str, Any]) -> str:
    """The page of what is in rocking.json."""
    bounds = [row["error"] for row in table["bounds"]]
    found = [abs(error) for error in bounds if error is not None]
    lines = [HEAD, FREE, "", *_free(table["free"], table["free_soft"]), "", MAP, "", *_map(table["map"]), ""]
    said = BOUNDS.format(count=len(bounds), missed=len(bounds) - len(found), worst=percent(max(found)).lstrip("+"))
    lines += [said, "", *_bounds(table["bounds"]), "", PAIRS, "", *_pairs(table["pairs"]), ""]
    lines += [SLIDES, "", *_slides(table["slides"]), "", STACKS, "", *_stacks(table["stacks"]), ""]
    lines += [BOUNCE, "", *_bounces(table["bounces"]), "", ENERGY, "", *_energy(table["energy"]), ""]
    return "\n".join([*lines, f"Machine: {sentence(table['machine'])}."]) + "\n"


def _free(stiff: Sequence[Row], soft: Sequence[Row]) -> list[str]:
    keys = {"decay": "one peak over the one before", "wide": "the same, swings above 0.1 α", "peaks": "peaks",
            "times": "times of peaks", "impacts": "times of impacts"}  # fmt: skip
    head = ("kn h/W", "h/b", "swings", *keys.values())
    cells = [
        (stiffness, f"{row['aspect']:g}", str(row["swings"]), *(percent(row[key]) for key in keys))
        for stiffness, rows in (("1e6", stiff), ("1e5", soft))
        for row in rows
    ]
    return lines_of(head, cells)


def _map(rows: Sequence[Row]) -> list[str]:
    head = ("contact_fraction", *(f"h/b = {aspect:g}" for aspect in free.ASPECTS),
            *(f"h/b = {aspect:g}, kn h/W = 1e5" for aspect in free.ASPECTS))  # fmt: skip
    exact = [f"{Block(1.0, aspect).restitution:.4f}" for aspect in free.ASPECTS]
    cells = [[f"{row['fraction']:g}", *(f"{r:.4f}" for r in (*row["ratios"], *row["soft"]))] for row in rows]
    return lines_of(head, [*cells, ["Housner", *exact, *exact]])


def _bounds(rows: Sequence[Row]) -> list[str]:
    names = {True: "overturns above", False: "stands above"}
    cells = []
    for ratio in dict.fromkeys(row["ratio"] for row in rows):
        here = [row for row in rows if row["ratio"] == ratio]
        said = [f"{row['bound']:.4f} {names[row['overturns_above']]}: {_missed(row)}" for row in here]
        cells.append([f"{ratio:g}", f"{pulses.frequency(pulses.BLOCK, ratio):.3f} Hz", *said, *[""] * (3 - len(here))])
    return lines_of(("ω/p", "frequency", "first bound A/(g tan α)", "second", "third"), cells)


def _missed(row: Row) -> str:
    return "not found" if row["error"] is None else percent(row["error"])


def _pairs(rows: Sequence[Row]) -> list[str]:
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
    return lines_of(head, cells)


def _slides(rows: Sequence[Row]) -> list[str]:
    cells = [
        (row["name"], _mm(row["exact"]), f"{1e3 * row['path']:.1f} mm", _mm(row["slip"]),
         percent(row["slip"] / row["exact"] - 1.0), percent((row["slip"] - row["exact"]) / row["path"]))
        for row in rows
    ]  # fmt: skip
    return lines_of(("motion", "exact final slip", "way", "dem", "error", "error over the way"), cells)


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.3f} mm".replace("-", "−")


def _stacks(rows: Sequence[Row]) -> list[str]:
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
    return lines_of(("motion", "closes first", "after", "error of that time", "largest error of angles"), cells)


def _bounces(rows: Sequence[Row]) -> list[str]:
    cells = [
        (f"{row['ratio']:g}", f"{row['margin']:g}", *(percent(h) for h in row["heights"]), percent(row["time"]),
         percent(row["overlap"]))
        for row in rows
    ]  # fmt: skip
    head = ("contact_fraction", "margin", "first height", "second", "third", "time of the first", "largest overlap")
    return lines_of(head, cells)


def _energy(rows: Sequence[Row]) -> list[str]:
    cells = []
    for name in dict.fromkeys(row["damping"] for row in rows):
        here = [row for row in rows if row["damping"] == name]
        errors = [np.abs(row["closures"]) for row in here]
        means = [float(np.sqrt((e**2).mean())) for e in errors]
        order = np.log(means[0] / means[-1]) / np.log(here[0]["margin"] / here[-1]["margin"])
        cells.append([name, *(f"{m:.1e} ({e.max():.1e})" for m, e in zip(means, errors)), f"{order:.2f}"])
    margins = [f"margin {row['margin']:g}" for row in rows if row["damping"] == rows[0]["damping"]]
    return lines_of(("damping", *margins, "order"), cells)
