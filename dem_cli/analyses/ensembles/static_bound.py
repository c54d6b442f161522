"""Bound of a parameter by limit analysis: values from which on the joints cannot balance the loads.

That is a bound, as friction is associated in it and no bond gives way, and a first guess for the runs that decide.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.analyses.ensembles.bisection import Scale
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.errors import CaseError, UsageError
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.limit.matrices import LimitStructure
    from dem_cli.core.model.model import Model


Variant = Callable[[float], tuple["Case", "Model"]]  # case and model at a value


class Bound(NamedTuple):
    """Bound between two values: equilibrium exists at `carried`, and is proved impossible at `impossible`."""

    carried: float
    impossible: float
    programs: int  # linear programs solved
    seconds: float

    def summary(self) -> dict[str, Any]:
        """Return the bound as the key `limit_analysis` of the summary."""
        return {
            "carried_at": self.carried,
            "impossible_at": self.impossible,
            "programs": self.programs,
            "seconds": self.seconds,
        }


def bound(variant: Variant, scale: Scale, resolution: float, settings: Settings = DEFAULT) -> Bound | str:
    """Bisect the bound between the ends of `scale`; returns a reason where there is none."""
    begun, programs = time.perf_counter(), 0

    def carries(value: float) -> bool | None:
        nonlocal programs
        programs += 1
        return stands(*variant(value), settings)

    try:
        low, high = scale.low, scale.high
        at_low, at_high = carries(low), carries(high)
        if None in (at_low, at_high):
            return "limit analysis did not converge"
        if at_low == at_high:
            what = "finds forces in equilibrium" if at_low else "proves equilibrium impossible"
            return f"limit analysis {what} at both {low:g} and {high:g}"
        while not scale.close(low, high, settings.safety.closer * resolution):
            middle = scale.middle(low, high)
            found = carries(middle)
            if found is None:
                return "limit analysis did not converge"
            low, high = (middle, high) if found == at_low else (low, middle)
    except (UsageError, CaseError) as error:
        return str(error)
    ends = (low, high) if at_low else (high, low)
    return Bound(*ends, programs, time.perf_counter() - begun)


def stands(case: Case, model: Model, settings: Settings = DEFAULT) -> bool | None:
    """Test by limit analysis whether the joints can carry the dead and constant loads of a case; None: not known.

    Raises UsageError where the strength of the law is not held by straight lines.
    """
    return _carries(case, model, None, None, settings)


def stands_where_it_rests(case: Case, sim: Simulation, touch: tuple[float, float], settings: Settings) -> bool | None:
    """Test by limit analysis whether the loads are carried in the displaced geometry.

    Blocks that have turned touch with corners: faces count up to the smallest gap with which forces are found. Raises
    UsageError as `stands`.
    """
    from dem_cli.core.limit.analysis import gaps_that_touch

    found: bool | None = None
    for near in gaps_that_touch(sim.model, touch):
        found = _carries(case, sim.model, sim, near, settings)
        if found:
            break
    return found


def _carries(case: Case, model: Model, moved: Simulation | None, near: float | None, settings: Settings) -> bool | None:
    """Test equilibrium by limit analysis in the initial geometry, or with the faces of a simulation within a gap."""
    from dem_cli.core.limit.analysis import start_structure
    from dem_cli.core.limit.associated import carried
    from dem_cli.core.limit.cone import envelope_of

    request = solver_request(case)
    properties, law = joint_properties(request, model, settings.stiffness.statics), law_of(request)
    structure = (
        start_structure(model, properties, law)
        if moved is None or near is None
        else start_structure(model._replace(links=moved.links), properties, law, moved.bodies, near)
    )
    if not structure.dead.any():
        return True  # nothing to carry
    strength = envelope_of(structure.joints, law, bonds=structure.bonds)
    return carried(_under_load(structure, case), strength, settings.limit.associated)[0]


def _under_load(structure: LimitStructure, case: Case) -> LimitStructure:
    """Return the structure with the constant load as dead load; a tilted table reduces the weight."""
    load = case.analysis.constant_load
    share = 1.0 / np.sqrt(1.0 + load**2) if case.analysis.pattern == "tilt" else 1.0
    dead = share * (structure.dead + load * structure.live)
    return structure._replace(dead=dead, live=dead)  # the live load only says how large loads are
