"""Contact points of joints whose stiffness is given: failure loads with two and with five, and a block that rocks."""

from __future__ import annotations

import time
from typing import Any

from dem_cli import api
from dem_cli.bench.table import percent
from dem_cli.model.scales import stiffness_scale
from studies.deformable.walls import AT, curve
from studies.places import ROOT
from studies.solution import bracket_of, command_of, from_file, solve
from studies.template import bracket, table

LARGE = ROOT / "cases" / "verification" / "wall_3.toml"
ROCKS = ROOT / "cases" / "verification" / "rocking_free.toml"
COUNTS, RATIOS = (2, 5), (1e5, 1e6)


def measure() -> dict[str, Any]:
    """Wall SW100, the wall of 231 blocks, and a block that rocks."""
    scale = stiffness_scale(api.build_model(from_file(LARGE)))
    return {
        "sw100": [curve(f"joints.dry.points={n}") | {"points": n} for n in (*COUNTS, 9)],
        "wall": [_wall(ratio, n, scale) for ratio in RATIOS for n in COUNTS],
        "rocking": [_rocking(n) for n in COUNTS],
    }


def _wall(ratio: float, points: int, scale: float) -> dict[str, Any]:
    sets = [f"joints.dry.kn={ratio * scale:.6g}", f"joints.dry.points={points}", "analysis.follow=0"]
    begun = time.process_time()
    summary = solve(from_file(LARGE, *sets)).summary
    return {
        "command": command_of(LARGE, sets), "status": summary["status"], "ratio": ratio, "points": points,
        "bracket": bracket_of(summary), "seconds": round(time.process_time() - begun, 1),
    }  # fmt: skip


def _rocking(points: int) -> dict[str, Any]:
    sets = [f"joints.dry.points={points}"]
    loaded = from_file(ROCKS, *sets)
    summary = solve(loaded).summary
    exact = next(one.value for one in loaded.case.reference if one.quantity.endswith("rotation.min"))
    found = summary["peaks"]["block rotation"]["min"]
    return {
        "command": command_of(ROCKS, sets), "status": summary["status"], "points": points,
        "rebound": round(found, 5), "exact": exact,
    }  # fmt: skip


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    sw = [(str(one["points"]), f"{one['peak']:.2f}", *(f"{x:.2f}" for x in one["loads"])) for one in found["sw100"]]
    walls = [
        (f"{one['ratio']:.0e}", str(one["points"]), bracket(one["bracket"]), f"{one['seconds']:g}")
        for one in found["wall"]
    ]
    rocks = [
        (str(one["points"]), f"{one['rebound']:.4f}", percent(one["rebound"] / one["exact"] - 1.0))
        for one in found["rocking"]
    ]
    return {
        "sw100": table(("points", "peak", *(f"at {x} mm" for x in AT)), sw),
        "wall": table(("kn·h/W", "points", "failure load", "CPU s"), walls),
        "rocking": table(("points", "first rebound [rad]", "against Housner's block"), rocks),
    }


PICTURES: dict[str, Any] = {}
