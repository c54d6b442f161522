"""Mortared wall pushed to and fro in its plane: the loop of its load, and where its energy went."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.template import minus, table

NAME = "mortar_wall_cycle"
ENERGIES = ("external", "friction", "elastic", "damping")


def measure() -> dict[str, Any]:
    """Loads [kN], displacements [mm] and energies [J] of all states."""
    loaded, seen = api.load_case(CASES / "verification" / f"{NAME}.toml"), RunKeeper()
    summary = solve(loaded.case, api.build_model(loaded), seen).summary
    last = seen.rows[-1].energy
    return {
        "command": f"dem run cases/verification/{NAME}.toml", "status": summary["status"],
        "closure": float(f"{summary['energy_closure']:.2g}"),
        "turns": [[1e3 * one["controlled"], round(one["load"], 3)] for one in summary["turning_points"]],
        "loops": [[round(one["energy"], 2), round(one["damping"], 4)] for one in summary["loops"]],
        "displacements": [float(f"{1e3 * row.live_displacement:.5g}") for row in seen.rows],
        "loads": [float(f"{row.load:.5g}") for row in seen.rows],
        "energy": {name: float(f"{getattr(last, name):.4g}") for name in ENERGIES},
    }  # fmt: skip


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What the page shows."""
    rows = [[minus(f"{u:g}"), minus(f"{load:.2f}")] for u, load in found["turns"]]
    loops = "; ".join(f"{energy:.1f} J, damping {100 * damping:.0f} %" for energy, damping in found["loops"])
    energy = {name: f"{value:.1f}" for name, value in found["energy"].items()}
    return {
        "turns": table(("pushed to [mm]", "load [kN]"), rows), "loops": loops,
        "closure": f"{abs(found['closure']):.0e}", "peak": f"{max(found['loads']):.1f}", **energy,
    }  # fmt: skip


def draw(found: dict[str, Any], path: Path) -> None:
    """Load over displacement."""
    with style.figure(path, figsize=(5.6, 3.6)) as figure:
        axis = figure.subplots()
        axis.plot(found["displacements"], found["loads"], color=style.STAGE_COLOURS["loading"])
        axis.set(xlabel="displacement of the push [mm]", ylabel="load [kN]")


PICTURES = {"cycles": draw}
