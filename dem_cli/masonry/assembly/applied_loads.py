"""Convert the tables [[load]], [[pressure]] and [[fill]] of a case to forces at points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.errors import CaseError, CaseProblem, KeyPath
from dem_cli.masonry.assembly.exposure import Surfaces
from dem_cli.masonry.assembly.falling_loads import falling_load
from dem_cli.masonry.assembly.point_forces import AppliedLoad
from dem_cli.masonry.assembly.surface_loads import fill, pressure

if TYPE_CHECKING:
    from dem_cli.case.load_tables import Load
    from dem_cli.case.schema import Case


def applied_loads(case: Case, model: Model) -> list[AppliedLoad]:
    """Compute all applied loads of a case, table by table. Raises CaseError where one acts on nothing."""
    surfaces = Surfaces(model) if _need_surfaces(case) else None
    found, problems = list[AppliedLoad](), list[CaseProblem]()
    for key, resolve in (("load", _load), ("pressure", pressure), ("fill", fill)):
        for i, table in enumerate(getattr(case, key)):
            try:
                found.append(resolve(case, model, surfaces, (key, i), table))
            except CaseError as error:
                problems += error.problems
    if problems:
        raise CaseError(problems)
    return found


def _need_surfaces(case: Case) -> bool:
    return bool(case.pressure or case.fill) or any(load.falls or load.at is not None for load in case.load)


def _load(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Load) -> AppliedLoad:
    """Compute the forces of one [[load]] on given blocks or those under it; with `inertia` as weights of masses too."""
    found = _forces(model, surfaces, path, table)
    return found._replace(weights=-found.forces[:, -1]) if table.inertia else found


def _forces(model: Model, surfaces: Surfaces | None, path: KeyPath, table: Load) -> AppliedLoad:
    chosen = model.chosen(table.selected, False)
    if table.falls or (table.at is not None and len(chosen) > 1):
        return falling_load(model, surfaces, path, table)._replace(follows=table.follows)
    points = model.centroids[chosen] if table.at is None else np.array([table.at])
    if table.each or len(chosen) == 1:
        shares = np.ones(len(chosen))
    else:
        masses = model.masses[chosen]
        shares = masses / (masses.sum() or 1.0)  # blocks of no size are refused afterwards
    forces = shares[:, np.newaxis] * np.array(table.force)
    dead = table.kind == "dead"
    return AppliedLoad(path, dead, chosen, points, forces, np.zeros(len(chosen)), follows=table.follows)
