"""The sweep of Appendix B: carried out by `dem sweep`, and its rows with what is drawn of them."""

from __future__ import annotations

import csv
import subprocess
import sys
import tomllib
from typing import Any

from dem_cli.output.reader import read
from dem_cli.output.vertices import rest_vertices
from studies.places import CASES, ROOT
from studies.polygons import rectangle
from studies.solution import bracket_of, corners_of, from_tables, solve

CASE = CASES / "validation" / "appendix_b.toml"
RESULTS = ROOT / "results" / "appendix_b"  # a second call goes on there

DRAWN = ("test 1", "test 4", "test 5", "test 8", "test 10", "test 11", "square B", "square C")
PLACES = 3  # digits kept of what is drawn


def swept() -> list[dict[str, Any]]:
    """One row per run, in the order of the case."""
    command = [sys.executable, "-m", "dem_cli", "sweep", str(CASE), "-o", str(RESULTS)]
    subprocess.run([*command, "--keep", "all", "--jobs", "1", "--quiet"], check=False, cwd=ROOT)
    return [row_of(row) for row in rows_of_sweep()]


def rows_of_sweep() -> list[dict[str, str]]:
    """The lines of sweep.csv."""
    with (RESULTS / "sweep.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def row_of(row: dict[str, str]) -> dict[str, Any]:
    """What the page needs of a run."""
    low, high = (number(row[f"failure_load_bracket.{end}"]) for end in (0, 1))
    command = f"dem sweep cases/validation/appendix_b.toml: {row['name']}"
    return {
        "command": command, "name": row["name"], "bricks": row["bricks"], "condition": row["condition"],
        "kg": int(row["kg"]), "friction": float(row["joints.dry.friction"]), "status": row["status"],
        "bracket": [low, high], "mode": row["failure_mode"],
        "path": number(row["limit_analysis.non_associated"]) if row["start.status"] == "ok" else None,
        "associated": number(row["limit_analysis.associated"]),
        "moving": int(float(row["mechanism.moving_blocks.count"] or 0)), "blocks": int(row["blocks"]) - 1,
        "steps": int(row["steps"]), "start": row["start.kind"],
        "top_mm": round(1e3 * float(row["monitors.(0.4, 0.595) displacement.value"]), 3),
    }  # fmt: skip


def number(text: str) -> float | None:
    return round(float(text), 6) if text else None


def outlines() -> dict[str, Any]:
    """Corners of all parts in the last frame of the runs that are drawn [m]."""
    folders = {row["name"]: RESULTS / "runs" / row["run"] for row in rows_of_sweep()}
    found = {}
    for name in DRAWN:
        results = read(folders[name])
        model = results.model
        free = ~model.fixed[model.part_blocks]
        corners = corners_of(model, results.frames[-1], PLACES)
        found[name] = {
            "moved": [part for part, kept in zip(corners, free, strict=True) if kept],
            "brick": [model.material_names[model.block_material[block]] == "peperino"
                      for block, kept in zip(model.part_blocks, free, strict=True) if kept],
            "height": round(float(rest_vertices(model)[:, 1].max()), PLACES),
        }  # fmt: skip
    return found


def changed(bricks: str, condition: str, changes: dict[str, Any]) -> dict[str, Any]:
    """One run of the sweep with further changes, keys as in [sweep]: bracket, limit loads, steps."""
    case = tomllib.loads(CASE.read_text(encoding="utf-8"))
    bundles = case.pop("sweep")["bundle"]
    case["analysis"] |= {"follow": 0.0}
    case["output"] = {"frames": 0}
    for key, value in (bundles["bricks"][bricks] | bundles["condition"][condition] | changes).items():
        *way, last = key.split(".")
        node: Any = case
        for name in way:
            node = node[int(name) if isinstance(node, list) else name]
        node[last] = value
    summary = solve(from_tables(case)).summary
    limit = summary.get("limit_analysis") or {}
    return {
        "command": f"{bricks}, {condition}: {', '.join(changes)}", "status": summary["status"],
        "bracket": bracket_of(summary),
        "path": limit.get("non_associated"), "associated": limit.get("associated"), "mode": summary["failure_mode"],
        "onset": summary["onset_of_displacements"], "seconds": round(summary["solve_seconds"], 2),
    }  # fmt: skip


def top_block(left: float, right: float, top: float, name: str) -> dict[str, Any]:
    """A load on the wall, of 0.08 m depth."""
    return {"id": name, "material": "load", "thickness": 0.08,
            "vertices": rectangle(left, 0.595, right, top)}  # fmt: skip
