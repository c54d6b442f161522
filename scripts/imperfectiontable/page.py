"""imperfections.md and imperfections.png are made from imperfections.json alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.bench.machine import sentence
from dem_cli.bench.table import lines_of, percent
from imperfectiontable.picture import draw, walls

Row = Mapping[str, Any]
FRICTION, HALF_BLOCK = 0.6, 20.0  # [-], [mm]
THESIS = {1.0: ("(a)", 0.51), 0.5: ("(b)", 0.54)}
NEAR = 0.05  # differences from the thesis that are listed
NAMES = {"whole top": "whole top lower", "right end": "right end lower", "left end": "left end lower"}
WAYS = {"first": "first motion", "last": "collapse"}
FALLS = "does not stand under its dead loads"
ANSWERS = {"first": ("ok", FALLS), "last": ("ok",)}

HEAD = """\
# Imperfections of blocks: the 21-block wall of thesis 5.4

Written by `scripts/imperfections --write` from `docs/imperfections.json`; do not edit. What `[[imperfection]]` can
say is in `dem schema` and, with examples, in [case_imperfections.md](case_imperfections.md).

The thesis made one block of the 21-block wall (friction 0.6) lower than the others: block (a) by 1 mm, which brought
the failure load from 0.6 down to 0.51, or block (b) by 0.5 mm, to 0.54; both failed in a "mixed mode". Which blocks
these are was said in Figure 5-25 alone, which is lost. Here every block was tried: its whole top lower, or its right
or left end only (a wedge; the load goes to the right). Blocks are `course-number`, from the lower left. Two loads:

* **first motion**: with the geometry of the start (`kinematics = "fixed"`) the wall has an equilibrium up to this load
  and none above it; the joint above the low block stays open. For whole tops limit analysis without dilation
  (`dem limit`) says the same within 1 %, but for 3-2, where it does not end. It does not depend on how far the joint
  is open.
* **collapse**: what `dem run` finds. Geometry moves (`kinematics = "auto"` is `"large"` in a case with imperfections),
  and motion that only closes gaps of the start is no failure, up to 20 times the widest gap or half a block. Blocks
  then rest on slanting joints and slide sooner: an error e over a half block of b = 20 mm leaves
  tan(arctan 0.6 − e / b) of the friction, {one:.4f} for 1 mm and {half:.4f} for 0.5 mm.

The resolution is 0.5 %. Without errors: first motion {plain:.4f}, collapse {plain_last:.4f}. Modes of collapse
are those of the whole motion until no gap can stop it any more: what turns first may slide off in the end.

![failure load by block that is low; framed: within 3 % of the thesis](imperfections.png)

## What the thesis may have meant

As loads of **first motion** both are found: block (a) is 4-2 ({a:.3f}; ten blocks turn) or 5-3 ({a_too:.3f}; two
blocks slide), block (b) is 5-2 ({b:.3f}; two courses slide and turn); no other whole top comes within 3 %. The cases
`wall_21_imperfect_a.toml` and `wall_21_imperfect_b.toml` are 4-2 and 5-2, with `kinematics = "fixed"`. But the gaps
close, and the walls stand again up to {a_last:.3f} and {b_last:.3f}. As **collapse**, block (a) may be the toe block
1-4 ({toe:.3f}), but that load scatters with the way of loading from {least:.3f} to {most:.3f} (below), and no block
that is 0.5 mm low brings collapse down to 0.54: the lowest load is {lowest:.3f}. The thesis loaded the wall
dynamically, so that closing joints gave it jolts as well: its loads need not be either of these.

## Blocks on one corner

A wedge touches what lies on it at one end. Geometry of the start never closes the other end, so that what needs it has
no first motion under load: blocks begin to move under their dead loads ("falls"), as half blocks do that rest on a
wedge alone. Block 6-3 has its centre above the edge of 5-3: it stands on that edge where 5-4, or 4-3 below it, is low,
and turns at a load of 0. Where a corner of the wedge meets a corner (left ends of 1-4, 3-4 and 5-4) the joint carries
nothing, as if the whole top were low. Geometry that moves closes all these joints under the dead loads: `dem run` as it
is finds loads of collapse for every wall.
"""


def write(folder: Path, table: Mapping[str, Any]) -> None:
    """Page and picture into `folder`."""
    (folder / "imperfections.md").write_text(render(table), encoding="utf-8")
    draw(folder / "imperfections.png", table["rows"])
    walls(folder / "case_imperfections.png")


def render(table: Mapping[str, Any]) -> str:
    """The page of what is in imperfections.json."""
    rows = table["rows"]
    plain = next(row for row in rows if not row["block"])
    slanting = [math.tan(math.atan(FRICTION) - e / HALF_BLOCK) for e in (1.0, 0.5)]
    plain_loads = {"plain": plain["first"]["load"], "plain_last": plain["last"]["load"]}
    head = HEAD.format(one=slanting[0], half=slanting[1], **plain_loads, **_reading(rows))
    lines = [head, "## Blocks that come near the loads of the thesis", ""]
    for size, (name, load) in THESIS.items():
        lines += [f"Block {name}, {size:g} mm lower, {load:g} in the thesis:", "", *_candidates(rows, size, load), ""]
    for size in THESIS:
        lines += [f"## {size:g} mm", "", *_table(rows, size), ""]
    lines += ["## Left in place", "", LEFT, "", *_left(rows), ""]
    lines += ["## Steps of the load", "", STEPS, "", *_steps(rows), ""]
    notes = [f"* {line(row)}" for row in rows if gave_up(row)] or ["None."]
    lines += ["## Runs that did not end", "", *notes, "", f"Machine: {sentence(table['machine'])}."]
    return "\n".join(lines) + "\n"


LEFT = """\
Where a half block rests on the low block alone it is set down with it; with `restack = false` it hovers, and falls onto
the low block as soon as the run begins. Whole top lower:"""
STEPS = """\
Where a joint closes at a load well below collapse, the jolt of it depends on how far the load had been raised at once:
the collapse load of a toe block that is 1 mm low, 1-4, scatters, the others do not. Whole top lower, steps at most as
long as (`analysis.step`; –: as `dem run` chooses them):"""


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


def _candidates(rows: Sequence[Row], size: float, load: float) -> list[str]:
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
    return lines_of(("block", "error", "load at", "load", "from the thesis", "mode", "blocks that move"), cells)


def _table(rows: Sequence[Row], size: float) -> list[str]:
    usual = _usual(rows, size)
    blocks = list(dict.fromkeys(row["block"] for row in usual))
    by_place = {(row["block"], row["shape"]): row for row in usual}
    head = ["block", *(f"{NAMES[shape]}: {WAYS[way]}" for shape in NAMES for way in WAYS)]
    cells = [
        [block.removeprefix("wall-"), *(load_of(by_place[block, shape][way]) for shape in NAMES for way in WAYS)]
        for block in blocks
    ]
    return lines_of(head, cells)


def _left(rows: Sequence[Row]) -> list[str]:
    kept = [row for row in rows if not row["step"] and row["shape"] == "whole top"]
    pairs = [(laid, left) for laid in kept if laid["laid"] for left in kept
             if not left["laid"] and (left["block"], left["size"]) == (laid["block"], laid["size"])]  # fmt: skip
    cells = [
        (short(laid), f"{laid['size']:g} mm", *(load_of(row[way]) for way in WAYS for row in (laid, left)))
        for laid, left in pairs
    ]
    head = ("block", "lower by", *(f"{WAYS[way]}, {how}" for way in WAYS for how in ("set down", "left")))
    return lines_of(head, cells)


def _steps(rows: Sequence[Row]) -> list[str]:
    stepped = [row for row in rows if row["step"]]
    steps = ["", *dict.fromkeys(row["step"] for row in stepped)]
    blocks = dict.fromkeys((row["block"], row["size"]) for row in stepped)
    kept = [row for row in rows if row["shape"] == "whole top" and row["laid"]]
    by_step = {(row["block"], row["size"], row["step"]): row for row in kept}
    cells = [
        [block.removeprefix("wall-"), f"{size:g} mm", *(load_of(by_step[block, size, step]["last"]) for step in steps)]
        for block, size in blocks
    ]
    return lines_of(["block", "lower by", *(step or "–" for step in steps)], cells)
