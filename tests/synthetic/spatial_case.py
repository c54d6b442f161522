"""Cases in 3D as tables, validated; peperino and one dry joint by default."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.case.schema import Case


def spatial_case(**tables: Any) -> Case:
    """A case with dimension = 3."""
    given = {
        "dimension": 3,
        "materials": {"peperino": {"density": 2143.0}},
        "joints": {"dry": {"friction": 0.6}},
    }
    return validate(given | tables, make_case_model(), CaseSource(Path("case.toml"), ""))


def extruded_tables(tables: dict[str, Any]) -> dict[str, Any]:
    """The tables of a case in 2D as one in 3D: x stays, y becomes z, blocks are prisms about y = 0.

    An angle of the plane, from x to its y, is one about −y: a monitor of a rotation has the other sign.
    """
    found = copy.deepcopy(tables) | {"dimension": 3}
    for key, name in VECTORS:
        for table in _each(found, key):
            if name in table:
                table[name] = [table[name][0], 0.0, table[name][1]]
    for joint in found.get("joints", {}).values():  # two points at its ends: four at its corners
        if joint.get("law") not in ("elastic", "mohr-coulomb", "fracture") and "profile" not in joint:
            joint.setdefault("points", "vertices")
    for key, turned in TURNED.items():
        for table in _each(found, key):
            turned(table)
    return found


def _each(tables: dict[str, Any], key: str) -> list[dict[str, Any]]:
    """The tables of a name, one or several."""
    one = tables.get(key, [])
    return one if isinstance(one, list) else [one]


def _block(table: dict[str, Any]) -> None:
    half = table.pop("thickness", 1.0) / 2.0
    if "vertices" in table:
        table |= {"polygon": table.pop("vertices"), "y": [-half, half]}
    else:
        sides = [[[[x, y, z] for x, z in part] for y in (-half, half)] for part in table["parts"]]
        table["parts"] = [near + far for near, far in sides]


def _bar(table: dict[str, Any]) -> None:
    table["path"] = [[x, 0.0, z] for x, z in table["path"]]


def _monitor(table: dict[str, Any]) -> None:
    if table.get("component") == "y":
        table["component"] = "z"
    if table.get("quantity") == "rotation":
        table["component"] = "y"


def _settlement(table: dict[str, Any]) -> None:
    if "rotation_deg" in table:
        table["rotation_deg"] = [0.0, -table["rotation_deg"], 0.0]


def _initial(table: dict[str, Any]) -> None:
    if "velocity" in table:
        x, y, turn = table["velocity"]
        table["velocity"] = [x, 0.0, y, 0.0, -turn, 0.0]


VECTORS = (
    ("structure", "origin"), ("load", "force"), ("load", "at"), ("monitor", "point"), ("analysis", "direction"),
    ("settlement", "displacement"), ("motion", "direction"), ("initial", "displacement"),
)  # fmt: skip
TURNED = {
    "block": _block, "reinforcement": _bar, "monitor": _monitor, "settlement": _settlement, "initial": _initial,
}  # fmt: skip
