"""Walls of 20 × 10 × 0.8 m out of their plane (Lemos 2019, 3.2 and 3.3): six patterns, and what is printed of them."""

from __future__ import annotations

from typing import Any

from dem_cli.app import api
from dem_cli.case.overrides import Override, override_of
from studies.places import CASES
from studies.space.measure import dem, limits

FILE = CASES / "validation" / "lemos_wall.toml"
PATTERNS = {  # length of blocks and offset [m]: what a prototype of this solver found
    (1.0, 0.0): 0.0802,
    (1.0, 0.1): 0.2156,
    (1.0, 0.5): 0.1973,
    (2.0, 0.0): 0.0800,
    (2.0, 0.1): 0.2840,
    (2.0, 0.5): 0.2855,
}


START = {"analysis.kinematics": "fixed", "analysis.follow": 0.0, "analysis.resolution": 0.002}  # geometry of the start
STEPS_THAT_GROW = Override("analysis.step", ("analysis", "step"), None)
RIGID = {"joints.dry.kn": "auto", "joints.dry.ks": "auto"}


def measure() -> list[dict[str, Any]]:
    """All patterns, on joints as stiff as the source's and on stiff ones."""
    rows = []
    for (length, offset), prototype in PATTERNS.items():
        keys = {"block": [length, 1.0], "blocks_per_course": round(20.0 / length), "offset": offset}
        pattern = {f"structure.0.{key}": value for key, value in keys.items()}
        for joints, changes in (("given", {}), ("stiff", RIGID)):
            wanted = (override_of(*one) for one in (pattern | START | changes).items())
            loaded = api.load_case(FILE, [*wanted, STEPS_THAT_GROW])
            case, model = loaded.case, api.build_model(loaded)
            name = f"{length:g} × 1 m, offset {offset:g} m, {joints} joints"
            rows.append({"name": name, "prototype": prototype} | dem(case, model) | limits(case, model))
    return rows
