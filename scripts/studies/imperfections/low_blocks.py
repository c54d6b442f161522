"""Runs of the 21-block wall with one block too low: every block, 1 mm and 0.5 mm.

Each wall is loaded twice: with the geometry of the start until blocks begin to move, and as `dem run` goes about it,
until nothing stops them any more: a joint that is open by 1 mm closes on the way, and the wall stands again.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import product
from typing import Any

from bench.cases import solve

from dem_cli.app import api
from dem_cli.case.imperfection import Imperfection
from dem_cli.case.schema import Case
from dem_cli.core.model.model import Model
from studies.places import CASES

CASE = CASES / "verification" / "wall_21.toml"
SETTINGS = ("analysis.resolution=0.005", "analysis.follow=0.0", "output.frames=0")
SIZES = (1.0, 0.5)  # [mm]
SHAPES = {  # errors per metre that the block is too low
    "whole top": {"height": -1.0},
    "right end": {"wedge": -1.0},
    "left end": {"height": -1.0, "wedge": 1.0},
}
STEPS = ("", "0.005", "0.01", "0.02", "0.05")  # of the load, at most; "": as dem chooses them
STEPPED = ("wall-1-4", "wall-3-4", "wall-5-4")  # whose joints close on the way to the lowest loads
FIRST, LAST = "analysis.kinematics=fixed", "analysis.kinematics=auto"  # gaps stay open; they may close


def runs() -> Iterator[dict[str, Any]]:
    """One row per wall, with both ways to load it; the first wall has no errors."""
    yield {"size": 0.0, "shape": "", "block": "", "laid": True, "step": ""} | both({})
    blocks = [block for block in build({})[1].block_ids if block != "wall-base"]
    for size, shape, block in product(SIZES, SHAPES, blocks):
        table = {"block": block} | {key: 1e-3 * size * error for key, error in SHAPES[shape].items()}
        row = {"size": size, "shape": shape, "block": block, "laid": True, "step": ""}
        yield row | both(table)
        left = table | {"restack": False}
        if not same(table, left):
            yield row | {"laid": False} | both(left)
        for step in STEPS[1:] if block in STEPPED and shape == "whole top" else ():
            yield row | {"step": step, "first": None, "last": solved(table, LAST, f"analysis.step={step}")}


def both(table: dict[str, Any]) -> dict[str, Any]:
    """The wall with one imperfection, with joints that stay open and with joints that may close."""
    return {"first": solved(table, FIRST), "last": solved(table, LAST)}


def build(table: dict[str, Any], *overrides: str) -> tuple[Case, Model]:
    """Case and model of the wall with one imperfection, or none."""
    loaded = api.load_case(CASE, [*SETTINGS, *overrides])
    tables = (Imperfection(**table),) if table else ()
    loaded.case = loaded.case.model_copy(update={"imperfection": tables})
    return loaded.case, api.build_model(loaded)


def same(first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Whether two imperfections make the same wall: nothing rests on the changed block alone."""
    one, other = build(first)[1], build(second)[1]
    return bool((one.centroids == other.centroids).all() and (one.vertices == other.vertices).all())


def solved(table: dict[str, Any], *overrides: str) -> dict[str, Any]:
    """Failure load, mode and number of moving blocks, and CPU seconds."""
    case, model = build(table, *overrides)
    begun = time.process_time()
    summary = solve(case, model)
    found = {"status": summary["status"], "load": summary["failure_load"], "mode": summary.get("failure_mode")}
    moving = summary.get("mechanism", {}).get("moving_blocks", {}).get("count")
    return found | {"moving": moving, "seconds": round(time.process_time() - begun, 3)}
