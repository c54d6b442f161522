"""Cases of vaults for the study, and what is read from their runs."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord
from studies.solution import Solution, from_tables, solve

DENSITY, GRAVITY = 2000.0, 9.81
STIFF = {"kn": 1e9, "ks": 4e8}
BONDED = {"law": "mohr-coulomb", "cohesion": 1e9, "tension": 1e9, "points": 3}


def solved(structure: dict[str, Any], joint: dict[str, Any], analysis: dict[str, Any], **tables: Any) -> Solution:
    """A structure of one material and one joint in 3D, or as `tables` say."""
    given = {"dimension": 3, "materials": {"stone": {"density": DENSITY}}, "joints": {"joint": joint}}
    return solve(from_tables(given | {"structure": [structure], "analysis": analysis} | tables))


def dome(courses: int, per_course: int, **keys: Any) -> dict[str, Any]:
    """A hemisphere of mean radius 1 m that one stone closes."""
    shape = {"kind": "vault", "shape": "dome", "radius": 1.0, "courses": courses, "per_course": per_course}
    return shape | {"thickness": 0.05} | keys


def thinnest(structure: dict[str, Any], friction: float, between: tuple[float, float], resolution: float) -> dict:
    """Least thickness of a dome by `dem`: it stands, it falls."""
    analysis = {"kind": "safety", "vary": "structure.0.thickness", "between": list(between), "resolution": resolution}
    summary = solved(structure, {"friction": friction}, analysis).summary
    found = summary.get("critical_value_bracket") or [None, None]
    return {"friction": friction, "status": summary["status"], "between": [x and round(float(x), 6) for x in found]}


def smoothest(structure: dict[str, Any]) -> dict[str, Any]:
    """Least friction by `dem` with which a structure stands: it stands, it falls."""
    analysis = {"kind": "safety", "vary": "joints.joint.friction", "between": [0.05, 0.8], "resolution": 0.05}
    summary = solved(structure, {"friction": 0.7}, analysis).summary
    found = summary.get("critical_value_bracket") or [None, None]
    return {"status": summary["status"], "between": [x and round(float(x), 4) for x in found]}


def last_contacts(solution: Solution) -> ContactRecord:
    """Contact points at the end of a run."""
    return solution.seen.frames[-1].contacts


def courses_of(model: Model) -> np.ndarray:
    """Course of each block by its name, `<id>-<course>-<number>`; 0: in none."""
    return np.array([int(n[1]) if len(n := name.split("-")) == 3 and n[1].isdigit() else 0 for name in model.block_ids])


def on_supports(model: Model, contacts: ContactRecord) -> dict[str, list[float]]:
    """Force on each fixed block over the weight of all others, by name."""
    weight = float(model.masses[~model.fixed].sum()) * GRAVITY
    forces = contacts.forces()
    found = {}
    for i in np.flatnonzero(model.fixed).tolist():
        own = [forces[contacts.blocks[:, side] == i].sum(axis=0) for side in (0, 1)]
        found[model.block_ids[i]] = np.round((own[1] - own[0]) / weight, 5).tolist()
    return found
