"""Planar twins of whatever moves: a case of the plane, its blocks as prisms, and what both say of its references."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tomli

from dem_cli.app import api
from dem_cli.app.pipeline.monitor_names import monitor_names
from dem_cli.case.reader import LoadedCase
from dem_cli.case.schema import Case
from dem_cli.core.model.model import Model
from dem_cli.results.output.scalars import scalars
from studies.motion_in_space.book import solved
from studies.solution import from_file, from_tables
from studies.space.twins import twin

DROPPED = ("block", "structure", "load", "surface", "reference", "imperfection", "sweep", "alias")
ENDS = {"min": "max", "max": "min", "min_time": "max_time", "max_time": "min_time"}  # of what changes its sign


def pair(file: Path, *overrides: str) -> tuple[tuple[LoadedCase, Model], tuple[LoadedCase, Model]]:
    """A case file of the plane, and its twin in space."""
    loaded = from_file(file, *overrides)
    model = api.build_model(loaded)
    return (loaded, model), (twin_case(file, loaded.case, model, *overrides), twin(model))


def twin_case(file: Path, case: Case, model: Model, *overrides: str) -> LoadedCase:
    """The tables of a case of the plane in space: y becomes z, a turn from x to y one about −y.

    The blocks of the case only stand for those of the model, by name.
    """
    tables = tomli.loads(file.read_text(encoding="utf-8"))
    tables = {key: value for key, value in tables.items() if key not in DROPPED} | {"dimension": 3}
    for key in _TABLES:
        if key in tables:
            listed = tables[key] if isinstance(tables[key], list) else [tables[key]]
            tables[key] = [_TABLES[key](dict(table)) for table in listed]
    for table in tables.get("motion", []):
        table |= {"file": str((file.parent / table["file"]).resolve())} if "file" in table else {}
    lands = case.analysis.kind == "time-history"
    for name, joint in tables.get("joints", {}).items():
        if joint.get("profile") is None:
            ends = case.joints[name].contact_points(2, lands=lands) == 2
            joint["points"] = "vertices" if ends else "vertices+centre"
    for table, name in zip(tables.get("monitor", []), monitor_names(case.monitor), strict=True):
        table["name"] = name
    if "direction" in tables.get("analysis", {}):
        tables["analysis"]["direction"] = _vector(tables["analysis"]["direction"])
    _rename(tables, {name: model.block_ids[i] for name, i in model.numbers.items()})
    tables["block"] = [_stand_in(i, name, model) for i, name in enumerate(model.block_ids)]
    return from_tables(tables, *overrides)


def _rename(tables: dict[str, Any], names: dict[str, str]) -> None:
    """Blocks by the names of the model: aliases are those of structures, which the twin does not have."""
    for table in [*tables.get("monitor", []), *tables.get("initial", []), *tables.get("settlement", [])]:
        table |= {"block": names[table["block"]]} if "block" in table else {}
        for key in ("blocks", "between"):
            table |= {key: [names[name] for name in table[key]]} if key in table else {}


def of_plane(file: Path, *overrides: str) -> dict[str, Any]:
    """Numbers of the summary of a case of the plane, by their paths."""
    loaded = from_file(file, *overrides)
    return {
        path: value
        for path, value in scalars(solved(loaded, api.build_model(loaded)).summary).items()
        if path.startswith("peaks.")
    }


def compared(file: Path, *overrides: str) -> dict[str, Any]:
    """Both runs, and the quantities that the case has references for (of others: peaks and ends of its monitors)."""
    plane, space = pair(file, *overrides)
    flat, solid = solved(*plane), solved(*space)
    case = plane[0].case
    names = zip(monitor_names(case.monitor), case.monitor, strict=True)
    turning = {name for name, monitor in names if monitor.quantity == "rotation"}
    told = [scalars(one.summary) for one in (flat, solid)]
    rows = []
    asked = [(one.path, one.expected, one.allowance) for one in case.reference]
    if not asked:
        named = monitor_names(case.monitor)
        asked = [(f"peaks.{name}.{end}", None, None) for name in named for end in ("max", "min")]
    for path, expected, allowance in asked:
        found = _in_space(told[1], path, turning)
        rows.append({
            "quantity": path, "reference": expected, "allowed": allowance, "plane": told[0].get(path), "space": found,
        })  # fmt: skip
    return {
        "name": file.stem,
        "kind": case.analysis.kind,
        "quantities": rows,
        "plane": flat.books,
        "space": solid.books,
    }


def _in_space(known: dict[str, Any], path: str, turning: set[str]) -> Any:
    """A number of the summary in space as the plane has it: a turn about −y changes its sign, and its ends."""
    head, _, last = path.rpartition(".")
    if not any(f".{name}." in path for name in turning):
        return known.get(path)
    found = known.get(f"{head}.{ENDS.get(last, last)}")
    signed = last in ("min", "max", "peak", "value", "residual", "end")
    return -found if signed and isinstance(found, float) else found


def _vector(planar: list[float]) -> list[float]:
    return [planar[0], 0.0, planar[1]]


def _motion(table: dict[str, Any]) -> dict[str, Any]:
    return table | {"direction": _vector(table.get("direction", [1.0, 0.0]))}


def _initial(table: dict[str, Any]) -> dict[str, Any]:
    if "displacement" in table:
        table["displacement"] = _vector(table["displacement"])
    if "velocity" in table:
        x, y, turn = table["velocity"]
        table["velocity"] = [x, 0.0, y, 0.0, -turn, 0.0]
    return table


def _settlement(table: dict[str, Any]) -> dict[str, Any]:
    if "displacement" in table:
        table["displacement"] = _vector(table["displacement"])
    if "rotation_deg" in table:
        table["rotation_deg"] = [0.0, -table["rotation_deg"], 0.0]
    return table


def _monitor(table: dict[str, Any]) -> dict[str, Any]:
    if "point" in table:
        table["point"] = _vector(table["point"])
    if table.get("quantity") == "rotation":
        table["component"] = "y"
    elif table.get("component") == "y":
        table["component"] = "z"
    return table


_TABLES = {"motion": _motion, "initial": _initial, "settlement": _settlement, "monitor": _monitor}


def _stand_in(i: int, name: str, model: Model) -> dict[str, Any]:
    corners = [[2.0 * i + x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
    material = model.material_names[model.block_material[i]]
    return {"id": name, "vertices": corners, "fixed": bool(model.fixed[i]), "material": material}
