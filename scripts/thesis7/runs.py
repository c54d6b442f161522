"""One run of a case as a section keeps it: the command, the answer, the equilibria on the way; and the data book."""

from __future__ import annotations

import math
import shlex
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from dem_cli import api
from dem_cli.analyses import solve as solver
from dem_cli.output.record import HistoryRow

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "tests" / "reference"
PLACES = 9  # digits kept of loads and displacements


class Rows:
    """An observer that keeps the rows."""

    def __init__(self) -> None:
        self.rows: list[HistoryRow] = []

    def frame(self, frame: Any) -> None: ...
    def progress(self, *where: Any) -> None: ...
    def row(self, row: HistoryRow) -> None:
        self.rows.append(row)


def run(case: str, *overrides: str) -> dict[str, Any]:
    """A run of `cases/CASE.toml`, as JSON.

    command, status, bracket: [highest equilibrium, lowest failure]; curve: [[load, displacement, rotation, ...]] of all
    equilibria, with the monitors of the case; steps, seconds of solving, warnings.
    """
    observer = Rows()
    loaded = api.load_case(ROOT / "cases" / f"{case}.toml", [*overrides, "output.frames=0"])
    summary = solver.solve(loaded.case, api.build_model(loaded), observer).summary
    followed = loaded.case.analysis.kind == "pushover" and loaded.case.analysis.follow > 0.0
    stages = ("gravity", "loading", "collapse") if followed else ("gravity", "loading")
    bracket = summary.get("failure_load_bracket")
    return {
        "command": " ".join([f"dem run cases/{case}.toml", *(f"--set {shlex.quote(text)}" for text in overrides)]),
        "status": summary["status"],
        "bracket": bracket and [None if load is None else round(float(load), PLACES) for load in bracket],
        "curve": [
            [round(float(value), PLACES) for value in (row.load, *row.monitors)]
            for row in observer.rows if row.stage in stages
        ],
        "steps": summary["steps"],
        "seconds": round(summary["solve_seconds"], 2),
        "warnings": summary["warnings"],
    }  # fmt: skip


def middle(found: dict[str, Any]) -> float:
    """Middle of the bracket of the failure load: what the thesis prints of its own."""
    low, high = found["bracket"]
    return 0.5 * (low + high)


def top(row: list[float], height: float) -> float:
    """How far the middle of the upper edge moved [m]; row: load, displacement of the centroid, rotation."""
    return row[1] - 0.5 * height * math.sin(row[2])


def bisect(low: float, high: float, width: float, beyond: Callable[[float], bool]) -> list[float]:
    """[low, high] round the load where `beyond` begins, no wider than `width` of it."""
    while high - low > width * high:
        load = 0.5 * (low + high)
        low, high = (low, load) if beyond(load) else (load, high)
    return [round(low, PLACES), round(high, PLACES)]


def commands(*runs: dict[str, Any]) -> list[str]:
    """How runs are repeated, as part of the page."""
    return ["```", *(f"{one['command']}  # {one['seconds']:.1f} s" for one in runs), "```", ""]


@cache
def book(name: str) -> dict[str, dict[str, Any]]:
    """Results of a file of the data book by their id."""
    tables = tomllib.loads((BOOK / f"{name}.toml").read_text(encoding="utf-8"))
    return {row["id"]: row for row in tables["result"]}
