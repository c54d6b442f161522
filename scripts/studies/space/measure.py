"""Measurement of structures in space: the load of DEM beside that of limit analysis, and beside the plane structure."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.case.schema import Case
from dem_cli.core.engine.kinematics import why_moving
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.errors import CaseError, UsageError
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.solution import from_file, from_tables
from studies.space.by_hand import ByHand
from studies.space.twins import twin

LARGEST = 300  # blocks of a twin
STATIC = ("pushover", "gravity")


def by_hand(known: dict[str, ByHand]) -> list[dict[str, Any]]:
    """Structures whose load is known."""
    return [one(name, each.case) | {"load": each.load, "formula": each.formula} for name, each in known.items()]


def compared(cases: dict[str, dict]) -> list[dict[str, Any]]:
    """Structures whose load is known by several methods alone."""
    return [one(name, case) for name, case in cases.items()]


def one(name: str, tables: dict) -> dict[str, Any]:
    """DEM from gravity, zero-dilation path and associated load of one structure."""
    loaded = from_tables(tables)
    case, model = loaded.case, api.build_model(loaded)
    return {"name": name} | dem(case, model) | limits(case, model)


def dem(case: Case, model: Model) -> dict[str, Any]:
    """What DEM says; seconds are of CPU."""
    begun = time.process_time()
    found = solve(case, model, Observer()).summary
    seconds = time.process_time() - begun
    return {
        "blocks": int((~model.fixed).sum()),
        "points": found["contacts"],
        "status": found["status"],
        "bracket": found.get("failure_load_bracket"),
        "mode": found.get("failure_mode"),
        "range": found.get("load_range"),
        "steps": found["steps"],
        "seconds": round(seconds, 2),
    }


def limits(case: Case, model: Model) -> dict[str, Any]:
    """What limit analysis says."""
    try:
        said = limit_loads(model, joint_properties(solver_request(case), model), law_of(solver_request(case))).summary()
    except UsageError as error:
        return {"path": None, "path_status": str(error), "associated": None}
    path = said.get("non_associated")
    return {
        "path": path,
        "path_at_least": said.get("non_associated_at_least"),
        "path_status": said.get("non_associated_status"),
        "associated": said["associated"],
    }


def twins(files: list[Path]) -> list[dict[str, Any]]:
    """Plane cases beside their prisms in space: static ones, of joints that the geometry of the start describes."""
    rows = []
    for file in files:
        kind = from_file(file).case.analysis.kind
        if kind not in STATIC:
            continue
        loaded = from_file(file, "output.frames=0", *(["analysis.follow=0.0"] if kind == "pushover" else []))
        case, model = loaded.case.model_copy(update={"monitor": ()}), api.build_model(loaded)
        if not _has_a_twin(case, model):
            continue
        plane, space = dem(case, model), dem(case, twin(model))
        rows.append({"name": file.stem, "plane": plane, "space": space})
    return rows


def _has_a_twin(case: Case, model: Model) -> bool:
    """Whether joints are plane with points at their ends, and geometry that of the start."""
    if (~model.fixed).sum() > LARGEST or any(
        joint.contact_points(d) != 2 for joint in case.joints.values() for d in (2, 3)
    ):
        return False
    try:
        return why_moving(solver_request(case), model) is None
    except CaseError:
        return False
