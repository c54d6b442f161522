"""One run of a case of chapter 7 as it is kept: command, answer, equilibria on the way."""

from __future__ import annotations

import math
from typing import Any

from studies.bisection import PLACES
from studies.places import CASES
from studies.solution import bracket_of, command_of, from_file, solve


def run(case: str, *overrides: str) -> dict[str, Any]:
    """A run of `cases/CASE.toml`, as JSON.

    command, status, bracket: [highest equilibrium, lowest failure]; curve: [[load, displacement, rotation, ...]] of all
    equilibria, with the monitors of the case; steps, seconds of solving, warnings.
    """
    file = CASES / f"{case}.toml"
    loaded = from_file(file, *overrides, "output.frames=0")
    _, summary, seen = solve(loaded)
    followed = loaded.case.analysis.kind == "pushover" and loaded.case.analysis.follow > 0.0
    stages = ("gravity", "loading", "collapse") if followed else ("gravity", "loading")
    return {
        "command": command_of(file, overrides),
        "status": summary["status"],
        "bracket": bracket_of(summary, PLACES),
        "curve": [
            [round(float(value), PLACES) for value in (row.load, *row.monitors)]
            for row in seen.rows
            if row.stage in stages
        ],
        "steps": summary["steps"],
        "seconds": round(summary["solve_seconds"], 2),
        "warnings": summary["warnings"],
    }


def without_curve(found: dict[str, Any], last: int = 0) -> dict[str, Any]:
    """A run of which no curve is drawn: only so many of the last equilibria are kept."""
    return found | {"curve": found["curve"][-last:] if last else []}


def middle(found: dict[str, Any]) -> float:
    """Middle of the bracket of the failure load: what the thesis prints of its own."""
    low, high = found["bracket"]
    return 0.5 * (low + high)


def top(row: list[float], height: float) -> float:
    """How far the middle of the upper edge moved [m]; row: load, displacement of the centroid, rotation."""
    return row[1] - 0.5 * height * math.sin(row[2])
