"""Cases in 3D as tables, validated; peperino and one dry joint by default."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

from dem_cli.api import make_case_model
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
    """The tables of a static case in 2D as one in 3D: x stays, y becomes z, blocks are prisms about y = 0."""
    found = copy.deepcopy(tables) | {"dimension": 3}
    for key, name in VECTORS:
        one = found.get(key, [])
        for table in one if isinstance(one, list) else [one]:
            if name in table:
                table[name] = [table[name][0], 0.0, table[name][1]]
    for block in found.get("block", []):
        half = block.pop("thickness", 1.0) / 2.0
        if "vertices" in block:
            block |= {"polygon": block.pop("vertices"), "y": [-half, half]}
        else:
            sides = [[[[x, y, z] for x, z in part] for y in (-half, half)] for part in block["parts"]]
            block["parts"] = [near + far for near, far in sides]
    for monitor in found.get("monitor", []):
        if monitor.get("component") == "y":
            monitor["component"] = "z"
    found.get("analysis", {}).pop("follow", None)
    return found


VECTORS = (
    ("structure", "origin"), ("load", "force"), ("load", "at"), ("monitor", "point"), ("analysis", "direction"),
)  # fmt: skip
