"""The beam on top of the walls: free to turn, and held so that it cannot, beside the tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dem_cli.results.post import style
from studies.shear_walls.walls import (
    FORCES,
    KN,
    MM,
    draw_curve,
    draw_tests,
    legend_below,
    load_at,
    peak,
    wall,
)
from studies.template import table

HELD = 'restraint=[{block="beam", fixed=["rotation"]}]'
DESIGN = (18.9, 60.7, 120.0, 149.0)  # peaks of the implicit path of the design, beam that cannot turn [kN]
PLACES = (0.002, 0.005, 0.010, 0.020)  # [m]


def measure() -> list[dict[str, Any]]:
    """Every wall, with both."""
    return [{"free": wall(force), "held": wall(force, HELD)} for force in FORCES]


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What the page shows."""
    peaks, loads = [], []
    for one, design in zip(found, DESIGN, strict=True):
        free, held = peak(one["free"])[0], peak(one["held"])
        name, tests = f"SW{one['held']['force']}", [max(test["loads"]) for test in one["held"]["tests"]]
        moment = abs(one["held"]["moments"]["beam"]["rotation"])
        peaks.append((name, " / ".join(f"{KN * load:.1f}" for load in tests), f"{KN * free:.2f}",
                      f"{KN * held[0]:.2f}", f"{MM * held[1]:.1f}", f"{design:g}", f"{KN * moment:.2f}"))  # fmt: skip
        at = (load_at(one["held"], place) for place in PLACES)
        loads.append((name, *("–" if load is None else f"{KN * load:.1f}" for load in at)))
    return {
        "peaks": table(("wall", "tests, peaks [kN]", "free beam, peak [kN]", "held beam, peak [kN]", "at [mm]",
                        "prototype, held [kN]", "moment that holds it [kN m]"), peaks),
        "loads": table(("held beam, load at [kN]", *(f"{MM * place:g} mm" for place in PLACES)), loads),
        "closure": max(abs(run["closure"]) for one in found for run in one.values()),
        "seconds": max(one["held"]["seconds"] for one in found),
    }  # fmt: skip


def draw_beam(found: list[dict[str, Any]], path: Path) -> None:
    """Each wall with both beams, over its tests."""
    with style.figure(path, figsize=(10.0, 6.4)) as figure:
        for axis, one in zip(figure.subplots(2, 2).ravel(), found, strict=True):
            draw_tests(axis, one["free"])
            draw_curve(axis, one["free"], "beam that may turn", color=style.STAGE_COLOURS["loading"])
            draw_curve(axis, one["held"], "beam that cannot turn", color=style.COLLAPSE)
        legend_below(figure)


PICTURES = {"beam": draw_beam}
