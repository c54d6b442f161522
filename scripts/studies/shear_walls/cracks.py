"""Walls of stones that can crack at mid length, by the strength of the stones, beside whole stones and the tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dem_cli.results.post import style
from studies.shear_walls.walls import FORCES, KN, MM, draw_curve, draw_tests, legend_below, load_at, peak, wall
from studies.template import minus, table

STRENGTHS = (0.5, 1.0, 2.0)  # tension of the stones [MPa]
COHESION = 1.5  # over tension
STIFFNESS = 6e10  # of the bond, kn and ks [Pa/m]: some eight times that of the joints
ENERGY = 100.0  # of opening [J/m2]; of sliding ten times that
PLACES = (0.005, 0.009, 0.015, 0.019)  # [m]


def measure() -> list[dict[str, Any]]:
    """Every wall, whole and at every strength."""
    return [{"whole": wall(force), "cracking": [cracking(force, ft) for ft in STRENGTHS]} for force in FORCES]


def cracking(force: int, strength: float) -> dict[str, Any]:
    """One wall of stones of a tensile strength [MPa]."""
    tension = 1e6 * strength
    joint = (
        f'{{law="fracture", friction=0.62, tension={tension:g}, cohesion={COHESION * tension:g}, kn={STIFFNESS:g}, '
        f"ks={STIFFNESS:g}, points=5, fracture_energy_tension={ENERGY:g}, fracture_energy_shear={10.0 * ENERGY:g}}}"
    )
    keys = (f"joints.stone={joint}", "structure.0.crack=stone", "analysis.follow=0.02", "analysis.limit=false")
    return {"strength": strength, **wall(force, *keys)}


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What the page shows."""
    rows, runs = [], [run for one in found for run in one["cracking"]]
    for one in found:
        highest = max(max(test["loads"]) for test in one["whole"]["tests"])
        for run in (*one["cracking"], one["whole"]):
            load, at = peak(run)
            there = (load_at(run, place) for place in PLACES)
            rows.append((f"SW{run['force']}", f"{run['strength']:g}" if "strength" in run else "whole",
                         f"{KN * load:.1f}", f"{MM * at:.1f}", minus(f"{100.0 * (load / highest - 1.0):+.0f} %"),
                         *("–" if value is None else f"{KN * value:.1f}" for value in there),
                         f"{abs(run['closure']):.0e}", f"{run['seconds']:.0f}"))  # fmt: skip
    return {
        "rows": table(("wall", "tension [MPa]", "peak [kN]", "at [mm]", "over the higher test",
                       *(f"at {MM * place:g} mm" for place in PLACES), "energy closes to", "CPU [s]"), rows),
        "closure": max(abs(run["closure"]) for run in runs),
        "cohesion": COHESION, "stiffness": STIFFNESS, "energy": ENERGY,
    }  # fmt: skip


def draw_cracks(found: list[dict[str, Any]], path: Path) -> None:
    """Each wall at every strength, over its tests."""
    colours = (style.COLLAPSE, style.SYSTEM, style.LIMIT)
    with style.figure(path, figsize=(10.0, 7.0)) as figure:
        for axis, one in zip(figure.subplots(2, 2).ravel(), found, strict=True):
            draw_tests(axis, one["whole"])
            for colour, run in zip(colours, one["cracking"], strict=True):
                draw_curve(axis, run, f"stones of {run['strength']:g} MPa", color=colour, lw=1.3)
            draw_curve(axis, one["whole"], "whole stones", color=style.STAGE_COLOURS["loading"])
        legend_below(figure)


PICTURES = {"cracks": draw_cracks}
