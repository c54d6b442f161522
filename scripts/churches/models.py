"""The three models of Table A-4: loads, who turns and what slides."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from churches.cases import RESOLUTION, THESIS, TITLES, model
from churches.geometry import Slice
from churches.runs import solve
from churches.statics import BODIES, seven_bodies
from dem_cli.bench.table import lines_of, percent
from dem_cli.post import style

BOOK_SIDE = 5.76  # m, of the data book, where nothing is fitted to a load of the whole structure
FITTED = 52.0  # kg/m2 of aisle roof for which model A fails at the thesis's load
SETS = {
    "book": (f"side walls of {BOOK_SIDE:g} m as in the data book: nothing fitted", replace(Slice(), side=BOOK_SIDE)),
    "cases": ("side walls fitted to the virtual work of 5.5 %: the case files", Slice()),
    "roof": (f"aisle roofs of {FITTED:g} kg/m2 fitted to model A besides", replace(Slice(), aisle_roof=FITTED)),
}
NAMES = {"church_a": "A, as it is", "church_a_no_slip": "A, no slip", "church_b": "B, before 1954"}
PARTS = dict(zip(BODIES, ("left wall", "left beam", "left nave", "nave roof", "right nave", "right beam", "right wall"),
                 strict=True))  # fmt: skip

TEXT = """\
* **Fitted**: one length in the case files, the height of the side walls, to the virtual work of seven bodies in A4.
  Predicted: all loads of the DE model, in particular B, for which nothing of A4 was used. Errors are over the middle
  of the thesis's bracket.
* **A, as it is**: {a} of the thesis. The nave walls turn about the second element of their columns, as there, and
  beams slide. Which end of a beam slides is decided by little: with roofs of {roof:g} kg/m2 the left wall goes along
  and the right beam slides on the side wall; in the thesis the left beam slides over the side wall and the right one
  leaves its bracket. Lighter aisle roofs bring the load of the thesis and let the left wall stand (last panel), but
  then B is too low.
* **No slip**: seven bodies, one degree of freedom, as in the thesis. Virtual work on the same hinges, `statics`, has
  no line of dem in it. dem is {over} above it, the thesis's DE model 2.7 % above its own: beams of {beam:g} m do not
  turn about points. With friction of 10 the forces in a beam's end are not unique, and the load depends a little on
  the way there: the static path ends {path} above dem.
* **B**: the buttress holds the left beam, and the left nave wall stands below it, as the thesis says. Here the tie
  beam then slides on the left wall, and the right beam, clamped in its pocket, lifts off the side wall; in the
  thesis the right side wall takes part. {b} of the load.
"""


def measure() -> dict[str, Any]:
    """Every model with every set."""
    found: dict[str, Any] = {}
    for key, (_, bay) in SETS.items():
        runs = {}
        for name in NAMES:
            command = f"dem run cases/validation/{name}.toml" if key == "cases" else f"{name}, set '{key}'"
            more = {"resolution": RESOLUTION[name]} if key == "cases" else {"resolution": 0.01, "max_steps": 12_000_000}
            runs[name] = solve(command, model(name, bay, **more))
        found[key] = {"statics": seven_bodies(bay), "runs": runs}
    return found


def page(found: dict[str, Any]) -> list[str]:
    """This part of church.md."""
    own = found["cases"]["runs"]
    text = TEXT.format(
        a=error(own, "church_a"), b=error(own, "church_b"), roof=Slice().roof, beam=Slice().beam,
        over=percent(own["church_a_no_slip"]["bracket"][0] / found["cases"]["statics"] - 1.0).lstrip("+"),
        path=percent(own["church_a_no_slip"]["path"] / own["church_a_no_slip"]["bracket"][0] - 1.0).lstrip("+"),
    )  # fmt: skip
    lines = ["## Models A and B, Table A-4", ""]
    for key, (what, _) in SETS.items():
        lines += [f"**{what[0].upper()}{what[1:]}**", "", *loads(found[key]), ""]
    return [*lines, text, "Turns and slips between the last equilibrium and proven failure, turns over the largest,",
            "slips of the second body to the right over the largest displacement:", "", *motions(found), "",
            "```", *(f"{one['command']}  # {one['seconds']:.1f} s" for one in own.values()), "```", "",
            "![Mechanisms](church_mechanisms.png)", ""]  # fmt: skip


def error(runs: dict[str, Any], name: str) -> str:
    """Of the middle of our bracket over that of the thesis."""
    return percent(sum(runs[name]["bracket"]) / sum(THESIS[name]) - 1.0)


def loads(part: dict[str, Any]) -> list[str]:
    """A table of one set."""
    rows = []
    for name, label in NAMES.items():
        one, (first, last) = part["runs"][name], THESIS[name]
        statics = f"{part['statics']:.4f}" if name == "church_a_no_slip" else "–"
        path = "–" if one["path"] is None else f"{one['path']:.4f}"
        low, high = one["bracket"]
        rows.append((label, f"{first:g} to {last:g}", f"{low:.4f} to {high:.4f}", error(part["runs"], name), path,
                     f"{one['associated']:.4f}", statics))  # fmt: skip
    return lines_of(("model", "thesis", "dem", "error", "path, no dilation", "associated", "statics"), rows)


def motions(found: dict[str, Any]) -> list[str]:
    """Who turns, what slides."""
    rows = []
    for key in SETS:
        for name, label in NAMES.items():
            moves = found[key]["runs"][name]["moves"]
            if moves is None:  # not decided
                continue
            slips = [f"{where} {value:+.2f}".replace("-", "−") for where, value in moves["slips"].items()
                     if abs(value) > 0.03]  # fmt: skip
            turns = [f"{moves['turns'].get(body, 0.0):.2f}".replace("-", "−") for body in BODIES]
            rows.append((f"{label}; {key}", *turns, "; ".join(slips) or "none"))
    return lines_of(("model, set", *PARTS.values(), "slips"), rows)


def draw(found: dict[str, Any], path: Path) -> None:
    """The mechanism of each model, and of A with light aisle roofs."""
    panels = [("cases", name) for name in NAMES] + [("roof", "church_a")]
    with style.figure(path, figsize=(11.0, 8.4)) as figure:
        axes = figure.subplots(2, 2).ravel()
        for axis, (key, name) in zip(axes, panels, strict=True):
            one = found[key]["runs"][name]
            shape = one["moves"]["outlines"]
            for rest, moved, fixed, wood in zip(*(shape[k] for k in ("rest", "moved", "fixed", "wood")), strict=True):
                colour = style.GROUND if fixed else "#c9a36a" if wood else style.STONE
                axis.fill(*zip(*moved, strict=True), facecolor=colour, edgecolor=style.STONE_EDGE, lw=0.6)
                axis.fill(*zip(*rest, strict=True), facecolor="none", edgecolor="#b9b9c2", lw=0.5, ls=(0, (3, 2)))
            more = "" if key == "cases" else f", aisle roofs of {FITTED:g} kg/m²"
            first, last = THESIS[name]
            loads = f"λ = {one['bracket'][0]:.4f}, thesis {first:g} to {last:g}"
            axis.set_title(f"{TITLES[name]}{more}\n{loads}", fontsize=9)
            axis.set(aspect="equal", xlim=(-3.0, 20.0), ylim=(-0.6, 16.2))
            axis.axis("off")


PICTURES = {"mechanisms": draw}
