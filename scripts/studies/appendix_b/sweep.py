"""The sweep of Appendix B: carried out by `dem sweep`, its rows and pictures, and single runs of it again."""

from __future__ import annotations

import csv
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np

from dem_cli.app import api
from dem_cli.app.sweep.plan import SweepRun, plan_of
from dem_cli.case.overrides import override_of
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.reader import Results, read
from studies.places import CASES, ROOT
from studies.polygons import rectangle
from studies.solution import Solution, bracket_of, corners_of, solve

CASE = CASES / "validation" / "appendix_b.toml"
RESULTS = ROOT / "results" / "appendix_b"  # a second call goes on there

DRAWN = ("test 1", "test 4", "test 5", "test 8", "test 10", "test 11", "square B", "square C")
PLACES = 3  # digits kept of what is drawn
TOP = (0.4, 0.595)  # corner of the wall that the load pushes away from it [m]
RIGID = {"joints.dry.kn": "auto", "joints.mortar.kn": "auto", "analysis.kinematics": "auto"}


def swept() -> list[dict[str, Any]]:
    """One row per run, in the order of the case."""
    command = [sys.executable, "-m", "dem_cli", "sweep", str(CASE), "-o", str(RESULTS)]
    subprocess.run([*command, "--keep", "all", "--jobs", "1", "--quiet"], check=False, cwd=ROOT)
    return [row_of(row, read(RESULTS / "runs" / row["run"])) for row in rows_of_sweep()]


def rows_of_sweep() -> list[dict[str, str]]:
    """The lines of sweep.csv."""
    with (RESULTS / "sweep.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def row_of(row: dict[str, str], results: Results) -> dict[str, Any]:
    """What the page needs of a run."""
    low, high = (number(row[f"failure_load_bracket.{end}"]) for end in (0, 1))
    command = f"dem sweep cases/validation/appendix_b.toml: {row['name']}"
    followed = row["limit_analysis.non_associated_status"] == "ok"
    return {
        "command": command, "name": row["name"], "bricks": row["bricks"], "condition": row["condition"],
        "kg": int(row["kg"]), "friction": float(row["joints.dry.friction"]), "kn": kn_of(row["name"]),
        "status": row["status"], "bracket": [low, high], "mode": row["failure_mode"],
        "path": number(row["limit_analysis.non_associated"]) if followed else None,
        "associated": number(row["limit_analysis.associated"]),
        "moving": int(float(row["mechanism.moving_blocks.count"] or 0)), "blocks": int(row["blocks"]) - 1,
        "steps": int(row["steps"]), "onset": number(row["onset_of_displacements"]), "top_mm": top_of(results),
    }  # fmt: skip


def number(text: str) -> float | None:
    return round(float(text), 6) if text else None


def top_of(results: Results) -> float:
    """How far the top of the wall has moved along the load, at the highest load that it held [mm]."""
    model = results.model
    held = [frame for frame in results.frames if frame.stage == "loading"][-1]
    bricks = np.array([name == "peperino" for name in model.material_names])[model.block_material[model.vertex_blocks]]
    away = np.abs(rest_vertices(model) - TOP).sum(axis=1)
    corner = int(np.where(bricks, away, np.inf).argmin())
    return round(1e3 * float(placed_vertices(model, held.positions, held.orientations)[corner, 0] - TOP[0]), 3)


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


@cache
def planned() -> dict[str, SweepRun]:
    """The runs of the sweep by name."""
    case = api.load_case(CASE).case
    return {str(run.values["name"]): run for run in plan_of(case.sweep, case.seed).runs}


def kn_of(name: str) -> float:
    """Normal stiffness of the joints of a run of the sweep [Pa/m]."""
    return float(api.load_case(CASE, planned()[name].overrides).case.joints["dry"].kn)


def again(name: str, changes: dict[str, Any]) -> Solution:
    """One run of the sweep with further changes, keys as in [sweep]; without the collapse."""
    wanted = {"analysis.follow": 0.0, "analysis.limit": False, "output.frames": 0} | changes
    return solve(api.load_case(CASE, [*planned()[name].overrides, *(override_of(*one) for one in wanted.items())]))


def changed(name: str, changes: dict[str, Any]) -> dict[str, Any]:
    """The same: bracket, limit loads, how the top moved on the way."""
    solution = again(name, changes)
    summary = solution.summary
    limit = summary.get("limit_analysis") or {}
    return {
        "command": f"{name}: {', '.join(changes) or 'as swept'}", "status": summary["status"],
        "bracket": bracket_of(summary), "path": limit.get("non_associated"), "associated": limit.get("associated"),
        "mode": summary["failure_mode"], "onset": summary["onset_of_displacements"],
        "held": [[round(row.load, 5), round(1e3 * row.monitors[0], 3)]
                 for row in solution.seen.rows if row.stage == "loading"],
        "steps": summary["steps"], "seconds": round(summary["solve_seconds"], 2),
    }  # fmt: skip


def top_block(left: float, right: float, top: float, name: str) -> dict[str, Any]:
    """A load on the wall, of 0.08 m depth."""
    return {"id": name, "material": "load", "thickness": 0.08,
            "vertices": rectangle(left, 0.595, right, top)}  # fmt: skip
