"""Wall SW100 of Lourenço's dry walls under displacement control, and its loads at given displacements."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from studies.places import ROOT
from studies.solution import command_of, from_file, solve

WALL = ROOT / "cases" / "validation" / "shear_wall_sw100.toml"
CURVE = ("analysis.control='displacement'", "analysis.follow=0.03", "analysis.increments=100", "analysis.limit=false")
AT = (1, 2, 4, 7, 10, 20)  # displacements of the beam [mm]


def curve(*overrides: str) -> dict[str, Any]:
    """Peak and loads [kN] of a run."""
    sets, begun = [*CURVE, *overrides], time.process_time()
    summary = solve(from_file(WALL, *sets)).summary
    found = summary["capacity_curve"]
    loads = np.interp(1e-3 * np.array(AT), found["displacements"], found["loads"])
    return {
        "command": command_of(WALL, sets), "status": summary["status"],
        "peak": round(1e-3 * summary["failure_load"], 3),
        "loads": (1e-3 * loads).round(3).tolist(), "seconds": round(time.process_time() - begun, 2),
    }  # fmt: skip
