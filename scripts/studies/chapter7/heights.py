"""Columns of 1 to 33 blocks: what is lost with the number of joints, and how many can stand (thesis 7.4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bench.table import percent
from oracle import rolling_polygons as statics
from reference import results

from dem_cli.results.post import style
from studies.chapter7.load_path import middle, run, without_curve
from studies.template import commands, minus, table

BASE, HEIGHT, TALL, ANGLE = 0.04, 0.0175, 0.35, 0.00625
COLUMNS = {  # by their name in the data book: blocks, height of a block [m]
    **{f"T74_{name}": (n, HEIGHT) for name, n in (("A1", 1), ("B1", 5), ("C1", 10), ("D1", 20))},
    **{f"T75_{name}": (n, TALL / n) for name, n in (("A2", 1), ("B2", 5), ("C2", 10), ("D2", 20))},
}
LENGTHS, APERTURE = (0.016, 0.008, 0.016), 1e-4  # calibrated
HALVES, SHALLOW = (0.5 * BASE, 0.5 * BASE), 0.25 * BASE * ANGLE  # two sides with the same angle
TWO_SIDES = f"joints.rough.profile={{ sides = 2, aperture = {SHALLOW:g} }}"
SHARES = (0.2, 0.1, 0.05, 0.02)  # of the middle side, on the way to two sides
LEANING = (30, 31)  # blocks of columns drawn as they lean
STRAIGHT = (24, 30)  # blocks of straight columns on two sides
TINY = 2e-4  # load under which they close
CALIBRATED = 33  # blocks of a straight column on the calibrated joint
HALF_STEP = 0.001  # of the thesis
FALLS = "does not stand under its dead loads"


class ColumnRow(NamedTuple):
    """A column of Table 7-4 or 7-5; what is lost is a share of b/H."""

    blocks: int
    plane: float  # b/H
    thesis: float
    formula: float  # eq. 7-24
    statics: float
    ours: float
    two_statics: float
    two_sides: float | None  # dem


def measure() -> dict[str, Any]:
    """Tables 7-4 and 7-5, the way to two sides, and the limit of height."""
    return {
        "runs": {name: _run(*column) for name, column in COLUMNS.items()},
        "two_sides": {name: _run(*column, TWO_SIDES) for name, column in COLUMNS.items() if name != "T74_A1"},
        "shares": {f"{share:g}": _run(10, HEIGHT, *_narrower(share)) for share in SHARES},
        "leaning": {str(n): without_curve(run(f"validation/leaning_column_{n}")) for n in LEANING},
        "straight": {str(n): _run(n, HEIGHT, TWO_SIDES, f"analysis.max_load={TINY:g}") for n in STRAIGHT},
        "calibrated": without_curve(run(
            "validation/column_14_profile", f"structure.0.courses={CALIBRATED}",
            "analysis.step=0.001", "analysis.resolution=0.01",
        )),
    }  # fmt: skip


def _run(blocks: int, height: float, *more: str) -> dict[str, Any]:
    plane = BASE / (blocks * height)
    friction = ("joints.rough.friction=5.0",) if plane > 0.6 else ()  # else it slides
    return without_curve(run(
        "validation/column_14_profile", f"structure.0.courses={blocks}", f"structure.0.block=[{BASE:g}, {height:g}]",
        *friction, *more, f"analysis.step={0.01 * plane:.3g}", "analysis.resolution=0.001",
    ))  # fmt: skip


def _narrower(share: float) -> tuple[str, str]:
    """A middle side of this share, with the angle of the calibrated joint."""
    profile, side = "joints.rough.profile", 0.5 * (1.0 - share) * BASE
    return f"{profile}.central={share:g}", f"{profile}.aperture={side * ANGLE:g}"


def load_of(blocks: int, height: float, lengths: Sequence[float] = LENGTHS, aperture: float = APERTURE) -> float:
    """Failure load by statics of rolling."""
    return statics.raised(statics.column(blocks, height, lengths, aperture))[-1].ends


def rows_of(found: dict[str, Any]) -> list[ColumnRow]:
    """Rows of both tables."""
    thesis, rows = results("thesis_columns_table_7_4_7_5"), []
    for name, (blocks, height) in COLUMNS.items():
        plane = BASE / (blocks * height)
        loads = (
            load_of(blocks, height), middle(found["runs"][name]), load_of(blocks, height, HALVES, SHALLOW),
            middle(found["two_sides"][name]) if name in found["two_sides"] else None,
        )  # fmt: skip
        lost = (None if load is None else 1.0 - load / plane for load in loads)
        rows.append(ColumnRow(blocks, plane, thesis[name]["value"], statics.closed(blocks, height, BASE, ANGLE), *lost))
    return rows


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What heights.md.j2 shows."""
    rows = rows_of(found)
    tall = [row for row in rows if row.plane < 1.0]  # the others lose so little that the load says nothing
    plane, formula = rows[2].plane, rows[2].formula
    shares = []
    for text_of_share, one in found["shares"].items():
        side = 0.5 * (1.0 - float(text_of_share)) * BASE
        load = load_of(10, HEIGHT, (side, float(text_of_share) * BASE, side), side * ANGLE)
        cells = (1 - middle(one) / plane, 1 - load / plane, formula)
        shares.append((text_of_share, *(f"{cell:.4f}" for cell in cells)))
    return {
        "table_7_4": _table(rows[:4]), "table_7_5": _table(rows[4:]),
        "brackets": "; ".join(_bracket(row) for row in rows[4:]), "step": 100 * 2 * HALF_STEP / rows[4].plane,
        "two": 100 * max(_off(row.two_sides, row.formula) for row in tall if row.two_sides is not None),
        "second": 100 * max(_off(row.two_statics, row.formula) for row in rows),
        "three": 100 * max(_off(row.ours, row.formula) for row in rows),
        "shares": table(("middle side over base", "dem ζ", "statics ζ", "eq. 7-24"), shares),
        **_heights(found), "commands": commands(*all_runs(found)),
    }  # fmt: skip


def _off(lost: float, expected: float) -> float:
    """Relative difference of two loads, from what is lost."""
    return abs((1.0 - lost) / (1.0 - expected) - 1.0)


def _table(rows: list[ColumnRow]) -> str:
    lost_by = ("thesis ζ", "eq. 7-24", "statics", "dem")
    head = ("blocks", *lost_by, "thesis λ", "dem λ", "error", "two sides: statics", "dem")
    cells = []
    for row in rows:
        load, theirs = (1.0 - row.ours) * row.plane, (1.0 - row.thesis) * row.plane
        lost = [f"{value:.4f}" for value in (row.thesis, row.formula, row.statics, row.ours)]
        two = "–" if row.two_sides is None else f"{row.two_sides:.4f}"
        loads = (f"{theirs:.4f}", f"{load:.4f}", percent(load / theirs - 1.0))
        cells.append((str(row.blocks), *lost, *loads, f"{row.two_statics:.4f}", two))
    return table(head, cells)


def _bracket(row: ColumnRow) -> str:
    """How far dem's load is from the thesis's bracket."""
    theirs, ours = (1.0 - row.thesis) * row.plane, (1.0 - row.ours) * row.plane
    low, high = round(theirs - HALF_STEP, 3), round(theirs + HALF_STEP, 3)
    away = max(low - ours, ours - high, 0.0)
    blocks = f"{row.blocks} block{'s' if row.blocks > 1 else ''}: {low:g} to {high:g}, dem {ours:.4f}"
    return blocks + (f", {100 * away / ours:.1f} % outside" if away > 0.0 else "")


def _heights(found: dict[str, Any]) -> dict[str, Any]:
    """How many blocks can stand."""
    cells = []
    for n in (20, 24, 28, *LEANING, 32, 33):
        load, upper = statics.weakest(n, HEIGHT, BASE, ANGLE)
        whole = BASE / (n * HEIGHT) * (1.0 - statics.closed(n, HEIGHT, BASE, ANGLE))
        one = found["leaning"].get(str(n))
        ours = "–" if one is None else "falls" if one["status"] == FALLS else f"{middle(one):.5f}"
        cells.append((str(n), minus(f"{whole:.5f}"), minus(f"{load:.5f}"), str(upper), ours))
    head = ("blocks", "whole column, eq. 7-24", "least of all upper parts", "blocks of that part", "dem")
    straight = (f"{n} blocks {'fall' if one['status'] == FALLS else 'stand'}" for n, one in found["straight"].items())
    low, high = found["calibrated"]["bracket"]
    first = statics.raised(statics.column(CALIBRATED, HEIGHT, LENGTHS, APERTURE))[0].ends
    return {
        "heights": table(head, cells), "straight": ", ".join(straight), "blocks": CALIBRATED, "first": first,
        "low": low, "high": high,
    }  # fmt: skip


def all_runs(found: dict[str, Any]) -> list[dict[str, Any]]:
    """Every run of this section."""
    groups = ("runs", "two_sides", "shares", "leaning", "straight")
    return [one for group in groups for one in found[group].values()] + [found["calibrated"]]


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figures 7-41 and 7-43."""
    rows, counts = rows_of(found), [1.0 + 0.1 * i for i in range(191)]
    parts = (
        ("h = 17.5 mm", rows[:4], [HEIGHT] * len(counts), "o", style.THRUST),
        ("H = 350 mm", rows[4:], [TALL / n for n in counts], "s", style.STATE_COLOURS["sliding"]),
    )
    with style.figure(path, figsize=(6.8, 4.2)) as figure:
        axis = figure.subplots()
        for text, part, heights, mark, colour in parts:
            formula = [100 * statics.closed(n, h, BASE, ANGLE) for n, h in zip(counts, heights)]
            blocks = [row.blocks for row in part]
            axis.plot(counts, formula, color=colour, lw=1.2, label=f"{text}: eq. 7-24")
            axis.plot(blocks, [100 * row.ours for row in part], mark, ms=5, color=colour, label=f"{text}: dem")
            theirs = [100 * row.thesis for row in part]
            axis.plot(blocks, theirs, mark, ms=10, mfc="none", color=colour, label=f"{text}: thesis")
        axis.set(xlabel="blocks", ylabel="load lost [% of b/H]", xticks=(1, 5, 10, 15, 20))
        axis.legend(loc="upper left")


PICTURES = {"heights": draw}
