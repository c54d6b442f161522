"""Contact points of joints whose stiffness is given: failure loads with few and with many, and a block that rocks."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from bench.table import percent

import dem_cli
from dem_cli.app import api
from dem_cli.core.model.scales import stiffness_scale
from studies.deformable.walls import AT, curve
from studies.places import ROOT
from studies.solution import bracket_of, command_of, from_file, solve
from studies.template import bracket, table

LARGE = ROOT / "cases" / "verification" / "wall_3.toml"
ROCKS = ROOT / "cases" / "verification" / "rocking_free.toml"
PANEL = ROOT / "cases" / "verification" / "space" / "panel.toml"
COUNTS, RATIOS = (2, 5), (1e5, 1e6)
LAYOUTS, SOFT = ("vertices", "vertices+centre", 3, 5), (1e8, 1e9)  # in space: points, and kn [Pa/m]


def measure() -> dict[str, Any]:
    """Wall SW100, the wall of 231 blocks, a stack in space, and a block that rocks."""
    scale = stiffness_scale(api.build_model(from_file(LARGE)))
    return {
        "sw100": [curve(f"joints.dry.points={n}") | {"points": n} for n in (*COUNTS, 9)],
        "wall": [_wall(ratio, n, scale) for ratio in RATIOS for n in COUNTS],
        "stack": [_stack(kn, points) for kn in SOFT for points in LAYOUTS],
        "rocking": [_rocking(n) for n in COUNTS],
    }


def _stack(kn: float, points: int | str) -> dict[str, Any]:
    of_stack = ("courses=4", "blocks_per_course=1", "bond='stack'")
    sets = [*(f"structure.0.{text}" for text in of_stack), "analysis.kinematics='large'", "analysis.follow=0"]
    return _solved(PANEL, [*sets, f"joints.dry.kn={kn:g}", f"joints.dry.points={points!r}"]) | {
        "kn": kn, "points": points,
    }  # fmt: skip


def _solved(file: Path, sets: list[str]) -> dict[str, Any]:
    """Failure load and CPU time, of the run alone."""
    begun = time.process_time()
    summary = solve(from_file(file, *sets)).summary
    seconds = time.process_time() - begun
    return {
        "command": command_of(file, sets), "status": summary["status"], "bracket": bracket_of(summary),
        "closure": float(f"{summary['energy_closure']:.1g}"), "seconds": round(seconds, 1),
    }  # fmt: skip


def _wall(ratio: float, points: int, scale: float) -> dict[str, Any]:
    sets = [f"joints.dry.kn={ratio * scale:.6g}", f"joints.dry.points={points}", "analysis.follow=0"]
    return _solved(LARGE, sets) | {"ratio": ratio, "points": points}


def _rocking(points: int) -> dict[str, Any]:
    sets = [f"joints.dry.points={points}"]
    case = from_file(ROCKS, *sets).case
    exact = next(one.value for one in case.reference if one.quantity.endswith("rotation.min"))
    with dem_cli.run(ROCKS, set={"joints.dry.points": points}) as result:
        summary = result.summary  # with the peaks of monitors
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
        "stack": table(
            ("kn [Pa/m]", "points", "failure load", "CPU s"),
            [
                (f"{one['kn']:.0e}", f"`{one['points']}`", bracket(one["bracket"]), f"{one['seconds']:g}")
                for one in found["stack"]
            ],
        ),
        "rocking": table(("points", "first rebound [rad]", "against Housner's block"), rocks),
    }


PICTURES: dict[str, Any] = {}
