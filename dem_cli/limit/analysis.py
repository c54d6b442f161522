"""Limit analysis of a model: from its geometry at the start to failure loads."""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from dem_cli.contact.assemble import JointProperties
from dem_cli.contact.start import bodies_at_rest, joints_of_start
from dem_cli.laws.law import Law
from dem_cli.limit.associated import OK, LimitLoad, limit_load
from dem_cli.limit.cone import friction_of
from dem_cli.limit.matrices import Structure, structure_of
from dem_cli.model.model import Model
from dem_cli.model.scales import smallest_edge


class LimitLoads(NamedTuple):
    """Failure loads of one structure by limit analysis."""

    structure: Structure
    friction: np.ndarray  # coefficient of every point [-], (n_points,)
    associated: LimitLoad
    seconds: float  # wall time of all of it, with detection and matrices

    def summary(self) -> dict[str, Any]:
        """What summary.json says under `limit_analysis`."""
        found, ok = self.associated, self.associated.status == OK
        return {
            "associated": found.multiplier if ok else None,
            "associated_bounds": [found.lower, found.upper] if ok else None,
            "associated_status": found.status,
            "residual": found.residual,
            "gap": found.gap,
            "iterations": found.iterations,
            "seconds": self.seconds,
        }


def limit_loads(model: Model, properties: JointProperties, law: Law, heads_frictionless: bool = False) -> LimitLoads:
    """Limit analysis of the faces that touch at the start; the multiplier is that of model.live_loads.

    heads_frictionless: no friction in joints steeper than 45° to the horizontal (thesis Table 5-3).
    Raises UsageError without live loads, or where the law has no cone |T| ≤ μ N.
    """
    begun = time.perf_counter()
    structure = start_structure(model, properties)
    friction = friction_of(structure.joints, law, heads_frictionless)
    associated = limit_load(structure, friction)
    return LimitLoads(structure, friction, associated, time.perf_counter() - begun)


def start_structure(model: Model, properties: JointProperties) -> Structure:
    """The structure with the joints of its first place."""
    joints, _ = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model))
    return structure_of(model, joints)
