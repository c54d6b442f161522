"""How far the loads depend on what had to be inferred or guessed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from bench.table import percent

from studies import storage
from studies.church.cases import slices
from studies.church.geometry import Slice, tables
from studies.church.mechanism import solved
from studies.church.models import NAMES
from studies.church.seven_bodies import seven_bodies
from studies.template import bracket, table

LOAD_KEPT = ("status", "bracket", "path", "seconds")

CHANGES: dict[str, dict[str, Any]] = {
    "side walls 5 m high": {"side": 5.0},
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
            statics = seven_bodies(bay) if name == "church_a_no_slip" else None
            one = solved(f"{name}, {label}", tables(bay, label, resolution=0.01), LOAD_KEPT)
            found[label][name] = one | {"statics": statics}
    return found


def values(found: dict[str, Any]) -> dict[str, str]:
    """What sensitivity.md.j2 shows."""
    cases = storage.read("church")["models"]["cases"]["runs"]
    plain = {name: middle(cases[name]) for name in NAMES}
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
    return {"changes": table(head, rows), "told": told}


def middle(one: dict[str, Any]) -> float:
    low, high = one["bracket"]
    return 0.5 * (low + high) if high is not None else low


def shown(one: dict[str, Any]) -> str:
    return f"{middle(one):.4f}" if one["status"] == "ok" and one["bracket"][1] is not None else bracket(one["bracket"])


PICTURES: dict[str, Any] = {}
