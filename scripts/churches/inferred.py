"""How far the loads depend on what had to be inferred or guessed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from churches.cases import slices
from churches.geometry import Slice, tables
from churches.models import NAMES
from churches.runs import solve
from churches.statics import seven_bodies
from dem_cli.bench.table import lines_of, percent

CHANGES: dict[str, dict[str, Any]] = {
    "side walls 6.5 m high": {"side": 6.5},
    "side walls 8 m high": {"side": 8.0},
    "aisles 3 m": {"aisle": 3.0},
    "aisles 5 m": {"aisle": 5.0},
    "nave 9 m": {"nave": 9.0},
    "roofs that rise by 0.1": {"pitch": 0.1},
    "aisle roofs 60 kg/m2": {"aisle_roof": 60.0},
    "aisle roofs 180 kg/m2": {"aisle_roof": 180.0},
    "all roofs 80 kg/m2": {"roof": 80.0},
    "bay of 4 m": {"bay": 4.0},
    "nave walls 0.6 m": {"thick": 0.6},
    "nave walls from 4.5 m on": {"column": 4.5},
    "nave walls 15 m high": {"top": 15.0},
    "brackets 0.15 m": {"bracket": 0.15},
    "beams 0.3 m deep at the wall": {"end": 0.3},
    "wood on masonry 0.35": {"wood_masonry": 0.35},
    "wood on masonry 0.45": {"wood_masonry": 0.45},
    "pocket 0.2 m": {"pocket": 0.2},
    "buttress and wall as one, 16.5 %": {"buttress": 0.165},
}
ONE = "buttress and wall as one, 16.5 %"


def bays(label: str) -> dict[str, Slice]:
    """The three models with a change."""
    change = CHANGES[label]
    found = {}
    for name, bay in slices().items():
        if label == ONE and name == "church_b":
            high = bay.side + bay.beam
            found[name] = replace(bay, buttress=0.165 - bay.left_wall / high)
        elif name == "church_a_no_slip":
            found[name] = replace(bay, **{key: value for key, value in change.items() if key != "wood_masonry"})
        elif name == "church_b" and "side" in change:
            found[name] = slices(replace(Slice(), **change))[name]
        else:
            found[name] = replace(bay, **change)
    return found


def measure() -> dict[str, Any]:
    """All changes, one at a time; models that a change leaves alone are not run again."""
    found: dict[str, Any] = {}
    for label in CHANGES:
        found[label] = {}
        for name, bay in bays(label).items():
            if bay == slices()[name]:
                continue
            if name != "church_b" and set(CHANGES[label]) <= {"pocket", "buttress"}:
                continue
            if name == "church_b" and set(CHANGES[label]) <= {"bracket", "end"}:
                continue
            one = solve(f"{name}, {label}", tables(bay, label, resolution=0.01))
            found[label][name] = {key: one[key] for key in ("status", "bracket", "path", "seconds")}
            found[label][name]["statics"] = seven_bodies(bay) if name == "church_a_no_slip" else None
    return found


def page(found: dict[str, Any]) -> list[str]:
    """This part of church.md."""
    plain = {name: solve_plain(found, name) for name in NAMES}
    rows = []
    for label, models in found.items():
        cells = []
        for name in NAMES:
            one = models.get(name)
            cells += ["–", "–"] if one is None else [shown(one), percent(middle(one) / plain[name] - 1.0)]
        rows.append((label, *cells))
    spans = {name: [middle(models[name]) / plain[name] - 1.0 for models in found.values() if name in models]
             for name in NAMES}  # fmt: skip
    told = "; ".join(f"{NAMES[name]}: {percent(min(span))} to {percent(max(span))}" for name, span in spans.items())
    head = ("changed", *(cell for label in NAMES.values() for cell in (label, "change")))
    return [
        "## How far what is inferred matters", "",
        "One change at a time against the case files; loads are middles of brackets of 1 %. A run in which the load",
        "could not be decided so closely has its bracket.", "",
        *lines_of(head, rows), "",
        f"{told}.", "The order of the three models stays in all of them.", "",
    ]  # fmt: skip


def solve_plain(found: dict[str, Any], name: str) -> float:
    """Load of the case file."""
    from sectioned import DOCS

    from churches.page import PAGE

    low, high = PAGE.read(DOCS)["models"]["cases"]["runs"][name]["bracket"]
    return 0.5 * (low + high)


def middle(one: dict[str, Any]) -> float:
    low, high = one["bracket"]
    return 0.5 * (low + high) if high is not None else low


def shown(one: dict[str, Any]) -> str:
    low, high = one["bracket"]
    if high is None:
        return f"above {low:.4f}"
    return f"{middle(one):.4f}" if one["status"] == "ok" else f"{low:.4f} to {high:.4f}"


PICTURES: dict[str, Any] = {}
