"""Tables of imperfections.md: failure loads of the 21-block wall by block that is low."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from bench.table import percent

from studies.template import table as markdown

Row = Mapping[str, Any]
FRICTION, HALF_BLOCK = 0.6, 20.0  # [-], [mm]
THESIS = {1.0: ("(a)", 0.51), 0.5: ("(b)", 0.54)}
NEAR = 0.05  # differences from the thesis that are listed
NAMES = {"whole top": "whole top lower", "right end": "right end lower", "left end": "left end lower"}
WAYS = {"first": "first motion", "last": "collapse"}
FALLS = "does not stand under its dead loads"
ANSWERS = {"first": ("ok", FALLS), "last": ("ok",)}


def values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows of imperfections.json."""
    rows = table["rows"]
    plain = next(row for row in rows if not row["block"])
    one, half = (math.tan(math.atan(FRICTION) - e / HALF_BLOCK) for e in (1.0, 0.5))
    return {
        "one": one, "half": half, "plain": plain["first"]["load"], "plain_last": plain["last"]["load"],
        **_reading(rows),
        "candidates": [(size, name, load, _candidates(rows, size, load)) for size, (name, load) in THESIS.items()],
        "walls": [(size, _table(rows, size)) for size in THESIS],
        "left": _left(rows), "steps": _steps(rows),
        "notes": "\n".join([f"* {line(row)}" for row in rows if gave_up(row)] or ["None."]),
    }  # fmt: skip


def line(row: Row) -> str:
    """One wall on one line."""
    what = f"{row['size']:g} mm {row['shape']} {short(row)}" if row["block"] else "without errors"
    notes = ("" if row["laid"] else " left in place") + (f" step {row['step']}" if row["step"] else "")
    loads = [f"{WAYS[way]} {load_of(row[way])}" for way in WAYS if row[way]]
    return f"{what}{notes}: {', '.join(loads)}"


def short(row: Row) -> str:
    """wall-4-2 -> 4-2"""
    return row["block"].removeprefix("wall-")


def load_of(found: Mapping[str, Any] | None) -> str:
    """Load and mode, or why there is none."""
    if found is None:
        return "–"
    if found["status"] == FALLS:
        return "falls"
    return found["status"] if found["load"] is None else f"{found['load']:.3f} {found['mode']}"


def gave_up(row: Row) -> bool:
    """Whether a run of this wall has no answer; that it falls is one where gaps stay open."""
    return any(row[way] and row[way]["status"] not in answers for way, answers in ANSWERS.items())


def _reading(rows: Sequence[Row]) -> dict[str, float]:
    """The numbers of what the thesis may have meant."""
    whole = [row for row in rows if row["shape"] == "whole top" and row["laid"]]
    loads = {(short(row), row["size"], way): row[way]["load"] for row in whole for way in WAYS if not row["step"]}
    toe = [row["last"]["load"] for row in whole if short(row) == "1-4" and row["size"] == 1.0]
    half = [row["last"]["load"] for row in _usual(rows, 0.5) if row["last"]["load"] is not None]
    return {
        "a": loads["4-2", 1.0, "first"], "a_too": loads["5-3", 1.0, "first"], "b": loads["5-2", 0.5, "first"],
        "a_last": loads["4-2", 1.0, "last"], "b_last": loads["5-2", 0.5, "last"],
        "toe": loads["1-4", 1.0, "last"], "least": min(toe), "most": max(toe), "lowest": min(half),
    }  # fmt: skip


def _usual(rows: Sequence[Row], size: float) -> list[Row]:
    return [row for row in rows if row["size"] == size and row["laid"] and not row["step"]]


def _candidates(rows: Sequence[Row], size: float, load: float) -> str:
    found = [
        (abs(row[way]["load"] / load - 1.0), row, way)
        for row in _usual(rows, size)
        for way in WAYS
        if row[way]["load"] is not None
    ]
    near = sorted((item for item in found if item[0] < NEAR), key=lambda item: item[0])
    cells = [
        (short(row), NAMES[row["shape"]], WAYS[way], f"{row[way]['load']:.3f}", percent(row[way]["load"] / load - 1.0),
         row[way]["mode"], str(row[way]["moving"]))
        for _, row, way in near
    ]  # fmt: skip
    return markdown(("block", "error", "load at", "load", "from the thesis", "mode", "blocks that move"), cells)


def _table(rows: Sequence[Row], size: float) -> str:
    usual = _usual(rows, size)
    blocks = list(dict.fromkeys(row["block"] for row in usual))
    by_place = {(row["block"], row["shape"]): row for row in usual}
    head = ["block", *(f"{NAMES[shape]}: {WAYS[way]}" for shape in NAMES for way in WAYS)]
    cells = [
        [block.removeprefix("wall-"), *(load_of(by_place[block, shape][way]) for shape in NAMES for way in WAYS)]
        for block in blocks
    ]
    return markdown(head, cells)


def _left(rows: Sequence[Row]) -> str:
    kept = [row for row in rows if not row["step"] and row["shape"] == "whole top"]
    pairs = [(laid, left) for laid in kept if laid["laid"] for left in kept
             if not left["laid"] and (left["block"], left["size"]) == (laid["block"], laid["size"])]  # fmt: skip
    cells = [
        (short(laid), f"{laid['size']:g} mm", *(load_of(row[way]) for way in WAYS for row in (laid, left)))
        for laid, left in pairs
    ]
    head = ("block", "lower by", *(f"{WAYS[way]}, {how}" for way in WAYS for how in ("set down", "left")))
    return markdown(head, cells)


def _steps(rows: Sequence[Row]) -> str:
    stepped = [row for row in rows if row["step"]]
    steps = ["", *dict.fromkeys(row["step"] for row in stepped)]
    blocks = dict.fromkeys((row["block"], row["size"]) for row in stepped)
    kept = [row for row in rows if row["shape"] == "whole top" and row["laid"]]
    by_step = {(row["block"], row["size"], row["step"]): row for row in kept}
    cells = [
        [block.removeprefix("wall-"), f"{size:g} mm", *(load_of(by_step[block, size, step]["last"]) for step in steps)]
        for block, size in blocks
    ]
    return markdown(["block", "lower by", *(step or "–" for step in steps)], cells)
