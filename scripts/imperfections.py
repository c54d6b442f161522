"""Which blocks of the 21-block wall are (a) and (b) of thesis 5.4? Every block tried, 1 mm and 0.5 mm too low.

Each wall is loaded twice: with the geometry of the start until blocks begin to move, and as `dem run` goes about it,
until nothing stops them any more: a joint that is open by 1 mm closes on the way, and the wall stands again.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

CASE = ROOT / "cases" / "verification" / "wall_21.toml"
DOCS = ROOT / "docs"
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


def main(words: Sequence[str] | None = None) -> int:
    """0 where every run ended, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="scripts/imperfections", description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write docs/imperfections.json, .md and .png")
    options = parser.parse_args(words)

    from imperfectiontable import page

    from dem_cli.bench.machine import describe, one_thread

    one_thread()
    machine, rows = describe(), []
    for row in runs():
        rows.append(row)
        print(page.line(row), flush=True)
    if options.write:
        table = {"machine": machine, "rows": rows}
        (DOCS / "imperfections.json").write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
        page.write(DOCS, table)
    return int(any(page.gave_up(row) for row in rows))


def runs() -> Iterator[dict[str, Any]]:
    """One row per wall, with both ways to load it; the first wall has no errors."""
    from dem_cli.bench.cases import compiled

    compiled()
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


def build(table: dict[str, Any], *overrides: str):
    """Case and model of the wall with one imperfection, or none."""
    from dem_cli import api
    from dem_cli.case.imperfection import Imperfection

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
    from dem_cli.bench.cases import solve

    case, model = build(table, *overrides)
    begun = time.process_time()
    summary = solve(case, model)
    found = {"status": summary["status"], "load": summary["failure_load"], "mode": summary.get("failure_mode")}
    moving = summary.get("mechanism", {}).get("moving_blocks", {}).get("count")
    return found | {"moving": moving, "seconds": round(time.process_time() - begun, 3)}


if __name__ == "__main__":
    sys.exit(main())
