"""The stone house of paper 001, section 4: what it carries, how it vibrates, what the table does to it, its cost."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.case.overrides import Override, override_of
from studies.observer import RunKeeper
from studies.places import CASES
from studies.solution import bracket_of
from studies.storage import rounded
from studies.template import bracket, table

PUSHED, SHAKEN, MODES = (CASES / "validation" / f"lemos_stone_house{name}.toml" for name in ("", "_shaken", "_modes"))
STEP = 6e-6  # of the paper [s]
FRONT, LEFT, RIGHT = (f"structure.0.walls.{k}" for k in range(3))
VARIANTS: dict[str, dict[str, Any]] = {
    "as the case": {},
    "friction 30°, as predicted before the test": {"joints.mortar.friction_angle_deg": 30.0},
    "return walls 2.5 m long": {
        f"{LEFT}.axis": [[0.25, 0.25], [0.25, 2.5]],
        f"{RIGHT}.axis": [[4.25, 0.25], [4.25, 2.5]],
    },
    "façade 5.0 m long": {
        f"{FRONT}.axis": [[0.25, 0.25], [4.75, 0.25]],
        f"{FRONT}.openings.0.x": 2.0,
        f"{RIGHT}.axis": [[4.75, 0.25], [4.75, 3.0]],
    },
}
ONE = {"motion.1.scale": 1e-9, "motion.2.scale": 1e-9}  # next to nothing


def measure() -> dict[str, Any]:
    """Pushed in several variants, its frequencies, shaken in three directions and across the façade alone."""
    return {
        "pushed": [pushed(name, changes) for name, changes in VARIANTS.items()],
        "modes": frequencies(),
        "shaken": [shaken("three components", {}), shaken("across the façade alone", ONE)],
    }


def pushed(name: str, changes: Mapping[str, Any]) -> dict[str, Any]:
    """One pushover."""
    summary, _, seconds = solved(PUSHED, [override_of(*one) for one in changes.items()])
    return {
        "command": "dem run cases/validation/lemos_stone_house.toml", "name": name, "status": summary["status"],
        "bracket": bracket_of(summary), "mode": summary["failure_mode"], "blocks": summary["blocks"],
        "seconds": seconds,
    }  # fmt: skip


def frequencies() -> dict[str, Any]:
    """The lowest ones [Hz]."""
    summary, _, seconds = solved(MODES, [])
    return {"command": "dem run cases/validation/lemos_stone_house_modes.toml", "status": summary["status"],
            "frequencies": [round(value, 3) for value in summary["frequencies"]], "seconds": seconds}  # fmt: skip


def shaken(name: str, changes: Mapping[str, Any]) -> dict[str, Any]:
    """One history."""
    summary, seen, seconds = solved(SHAKEN, [override_of(*one) for one in changes.items()])
    ridge = seen.values[:, 0]
    return {
        "command": "dem run cases/validation/lemos_stone_house_shaken.toml", "name": name, "status": summary["status"],
        "ending": summary["ending"], "collapse_time": summary.get("collapse_time"),
        "peak": rounded(ridge[abs(ridge).argmax()], 4), "end": rounded(ridge[-1], 4),
        "time_step": summary["time_step"], "steps": summary["steps"], "closure": summary["energy_closure"],
        "seconds": seconds,
    }  # fmt: skip


def solved(file: Path, changes: list[Override]) -> tuple[dict[str, Any], RunKeeper, float]:
    """Summary of a case with changes, what was seen of it, and its seconds of CPU."""
    begun = time.process_time()
    loaded, seen = api.load_case(file, changes), RunKeeper()
    model = api.build_model(loaded)
    summary = solve(loaded.case, model, seen).summary | {"blocks": int((~model.fixed).sum())}
    return summary, seen, round(time.process_time() - begun, 1)


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """What the page shows of the house."""
    house = found["house"]
    rows = [(one["name"], str(one["blocks"]), bracket(one["bracket"], ".3f"), one["mode"], f"{one['seconds']:.0f}")
            for one in house["pushed"]]  # fmt: skip
    shaken = [cells(one) for one in house["shaken"]]
    first = house["modes"]["frequencies"][0]
    step = house["shaken"][0]["time_step"]
    return {
        "pushed": table(("house", "stones", "failure load [g]", "mode", "CPU [s]"), rows),
        "frequencies": ", ".join(f"{value:.1f}" for value in house["modes"]["frequencies"]),
        "first": first, "softer": (10.0 / first) ** 2,
        "shaken": table(("table", "ends", "largest displacement of the ridge [mm]", "in the end [mm]", "time step [s]",
                         "steps", "CPU [s]", "energy closes to"), shaken),
        "times": step / STEP, "long": house["shaken"][0]["seconds"] * step / STEP / 60.0,
        "seconds": house["shaken"][0]["seconds"],
    }  # fmt: skip


def cells(one: Mapping[str, Any]) -> tuple[str, ...]:
    """One history."""
    ends = one["ending"] if one["collapse_time"] is None else f"{one['ending']} at {one['collapse_time']:.1f} s"
    moved = [f"{1e3 * abs(one[key]):.0f}" for key in ("peak", "end")]
    return (one["name"], ends, *moved, f"{one['time_step']:.2e}", f"{one['steps']:,}", f"{one['seconds']:.0f}",
            f"{abs(one['closure']):.1e}")  # fmt: skip
