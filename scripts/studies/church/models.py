"""The three models of Table A-4: loads, who turns and what slides."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from bench.table import percent

from dem_cli.results.post import style
from studies.church.cases import RESOLUTION, THESIS, TITLES, model
from studies.church.geometry import FITTED_SIDE, Slice
from studies.church.mechanism import solved
from studies.church.seven_bodies import BODIES, seven_bodies
from studies.template import bracket, commands, minus, table

LIGHT = 52.0  # kg/m2 of aisle roof for which model A, with side walls fitted, fails at the thesis's load
FITTED = replace(Slice(), side=FITTED_SIDE)
SETS = {
    "cases": (f"side walls of {Slice().side:g} m as in the data book, nothing fitted: the case files", Slice()),
    "fitted": (f"side walls of {FITTED_SIDE:g} m, fitted to the virtual work of 5.5 %", FITTED),
    "roof": (f"aisle roofs of {LIGHT:g} kg/m2 fitted to model A besides", replace(FITTED, aisle_roof=LIGHT)),
}
NAMES = {"church_a": "A, as it is", "church_a_no_slip": "A, no slip", "church_b": "B, before 1954"}
PARTS = dict(zip(BODIES, ("left wall", "left beam", "left nave", "nave roof", "right nave", "right beam", "right wall"),
                 strict=True))  # fmt: skip


def measure() -> dict[str, Any]:
    """Every model with every set."""
    found: dict[str, Any] = {}
    for key, (_, bay) in SETS.items():
        runs = {}
        for name in NAMES:
            command = f"dem run cases/validation/{name}.toml" if key == "cases" else f"{name}, set '{key}'"
            more = {"resolution": RESOLUTION[name]} if key == "cases" else {"resolution": 0.01, "max_steps": 12_000_000}
            runs[name] = solved(command, model(name, bay, **more))
        found[key] = {"statics": seven_bodies(bay), "runs": runs}
    return found


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What models.md.j2 shows."""
    own, fitted = found["cases"]["runs"], found["fitted"]["runs"]
    no_slip = own["church_a_no_slip"]
    return {
        "sets": [(f"{what[0].upper()}{what[1:]}", loads(found[key])) for key, (what, _) in SETS.items()],
        "a": error(own, "church_a"), "b": error(own, "church_b"), "roof": Slice().roof, "beam": Slice().beam,
        "no_slip": error(own, "church_a_no_slip"), "statics": found["cases"]["statics"], "side": Slice().side,
        "a_fitted": error(fitted, "church_a"), "no_slip_fitted": error(fitted, "church_a_no_slip"), "high": FITTED_SIDE,
        "b_fitted": error(fitted, "church_b"),
        "over": percent(no_slip["bracket"][0] / found["cases"]["statics"] - 1.0).lstrip("+"),
        "path": percent(no_slip["path"] / no_slip["bracket"][0] - 1.0).lstrip("+"),
        "motions": motions(found), "commands": commands(*own.values()),
    }  # fmt: skip


def error(runs: dict[str, Any], name: str) -> str:
    """Of the middle of our bracket over that of the thesis."""
    return percent(sum(runs[name]["bracket"]) / sum(THESIS[name]) - 1.0)


def loads(part: dict[str, Any]) -> str:
    """A table of one set."""
    rows = []
    for name, label in NAMES.items():
        one, (first, last) = part["runs"][name], THESIS[name]
        statics = f"{part['statics']:.4f}" if name == "church_a_no_slip" else "–"
        path = "–" if one["path"] is None else f"{one['path']:.4f}"
        rows.append((label, f"{first:g} to {last:g}", bracket(one["bracket"]), error(part["runs"], name), path,
                     f"{one['associated']:.4f}", statics))  # fmt: skip
    return table(("model", "thesis", "dem", "error", "path, no dilation", "associated", "statics"), rows)


def motions(found: dict[str, Any]) -> str:
    """Who turns, what slides."""
    rows = []
    for key in SETS:
        for name, label in NAMES.items():
            moves = found[key]["runs"][name]["moves"]
            if moves is None:  # not decided
                continue
            slips = [minus(f"{where} {value:+.2f}") for where, value in moves["slips"].items()
                     if abs(value) > 0.03]  # fmt: skip
            turns = [minus(f"{moves['turns'].get(body, 0.0):.2f}") for body in BODIES]
            rows.append((f"{label}; {key}", *turns, "; ".join(slips) or "none"))
    return table(("model, set", *PARTS.values(), "slips"), rows)


def draw(found: dict[str, Any], path: Path) -> None:
    """The mechanism of each model, and of A with light aisle roofs on side walls that are fitted."""
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
            more = "" if key == "cases" else f", fitted, aisle roofs of {LIGHT:g} kg/m²"
            first, last = THESIS[name]
            loads = f"λ = {one['bracket'][0]:.4f}, thesis {first:g} to {last:g}"
            axis.set_title(f"{TITLES[name]}{more}\n{loads}", fontsize=9)
            axis.set(aspect="equal", xlim=(-3.0, 20.0), ylim=(-0.6, 16.2))
            axis.axis("off")


PICTURES = {"mechanisms": draw}
