"""One case by `dem limit --lower --least`, and by DEM raised from gravity."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import LEAST, LOWER, limit_loads
from dem_cli.core.records.ports import Observer
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.places import ROOT

KEPT = (
    "associated", "associated_status", "non_associated", "non_associated_status", "least", "least_of", "least_proved",
    "least_changed", "least_residual", "least_forces_bounded", "least_nodes", "lower_bound", "reduced_domain",
)  # fmt: skip


def measure(file: Path) -> dict[str, Any]:
    """All loads of a case; seconds are of CPU."""
    found = api.load_case(file, ["analysis.follow=0.0", "output.frames=0"])
    case, model, law = found.case, api.build_model(found), law_of(solver_request(found.case))
    begun = time.process_time()
    loads = limit_loads(model, joint_properties(solver_request(case), model), law, bounds=bounds_of(case))
    seconds, said = time.process_time() - begun, loads.summary()
    summary = solve(case, model, Observer()).summary
    return {
        "command": command_of(file, case),
        "status": summary["status"],
        "name": f"{file.parent.name}/{file.stem}",
        "blocks": int((~model.fixed).sum()),
        "joints": len(loads.structure.joints.blocks),
        "seconds": round(seconds, 2),
        "dem": summary["failure_load_bracket"],
    } | {key: said.get(key) for key in KEPT}


def bounds_of(case: Any) -> tuple[str, ...]:
    """The least load is that of joints whose strength stays."""
    return (LOWER,) if falls(case) else (LOWER, LEAST)


def falls(case: Any) -> bool:
    """Whether some joint has less strength when it has failed."""
    names = ("cohesion", "tension")
    return any(
        getattr(joint, name, 0.0) > getattr(joint, f"{name}_residual", 0.0)
        for joint in case.joints.values()
        for name in names
    )


def command_of(file: Path, case: Any) -> str:
    """How it is repeated by hand."""
    return f"dem limit {file.relative_to(ROOT).as_posix()} " + " ".join(f"--{name}" for name in bounds_of(case))
