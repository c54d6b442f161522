"""Blocks that deform in their joints or by modes of their own: the elastic wall beside finite elements, wall SW100."""

from __future__ import annotations

import time
from typing import Any

from bench.table import percent

from dem_cli.app import api
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels.records import HOLD_LOAD
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.deformable.elastic_wall import displacement, finite_elements, stones
from studies.deformable.walls import AT, WALL, curve
from studies.solution import from_file
from studies.template import table

WAYS = {
    "none": "rigid",
    "joints": "lumped",
    "uniform-strain": "uniform strain",
    "quadratic": "quadratic",
}  # deformation, and what it is called
RATIOS = (0.05, 0.1, 0.44, 1.0, 3.0)  # kn h/E


def measure() -> dict[str, Any]:
    """Displacements of the beam [m/N], and curves."""
    elastic = [
        {"ratio": ratio, "elements": _rounded(finite_elements(ratio))}
        | {way: _rounded(displacement(ratio, way)) for way in WAYS}
        for ratio in RATIOS
    ]
    curves = [curve(*stones(way)) | {"blocks": name, **_costs(way)} for way, name in WAYS.items()]
    return {"elastic": elastic, "curves": curves}


def _costs(way: str) -> dict[str, float]:
    """CPU time of a contact point in a step [ns], geometry of the start and geometry that moves."""
    loaded = from_file(WALL, *stones(way))
    model, found = api.build_model(loaded), {}
    for kinematics in ("fixed", "large"):
        sim = Simulation(
            model, law_of(solver_request(loaded.case)), joint_properties(solver_request(loaded.case), model), kinematics
        )
        sim.set_load(0.0)
        sim.use_combined_damping()
        sim.advance(500, HOLD_LOAD)
        seconds = []
        for _ in range(5):
            begun = time.process_time()
            sim.advance(1000, HOLD_LOAD)
            seconds.append(time.process_time() - begun)
        found[kinematics] = round(1e6 * min(seconds) / len(sim.joints.kn), 1)
    return found


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    rows = [
        (f"{one['ratio']:g}", *(percent(one[way] / one["elements"] - 1.0) for way in WAYS)) for one in found["elastic"]
    ]
    rigid = found["curves"][0]
    curves = [
        (
            one["blocks"], f"{one['peak']:.2f}", *(f"{x:.2f}" for x in one["loads"]),
            *(f"{one[which]:.0f} ns, {one[which] / rigid[which]:.1f} ×" for which in ("fixed", "large")),
        ) for one in found["curves"]
    ]  # fmt: skip
    return {
        "elastic": table(("kn h/E", *WAYS.values()), rows),
        "curves": table(("blocks", "peak", *(f"at {x} mm" for x in AT), "of the start", "moving"), curves),
    }


PICTURES: dict[str, Any] = {}
