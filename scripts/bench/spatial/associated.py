"""Cost of the associated load in space: from the model of a structure to the load, joints of the start included."""

from __future__ import annotations

import math
from typing import Any

from bench.cases import KnownStructure
from bench.timing import TimedTask


def associated_job(known: KnownStructure) -> TimedTask:
    """The load by exact cones, its error against what is known of it, and how many contact points there are."""
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.limit.analysis import limit_loads
    from dem_cli.masonry.assembly.solver_request import solver_request

    case, model = known.build()

    def run() -> dict[str, Any]:
        found = limit_loads(
            model, joint_properties(solver_request(case), model), law_of(solver_request(case)), associated_only=True
        )
        load = found.associated.multiplier
        said = {"load": load, "error": statics_error(known, load), "points": len(found.associated.normal)}
        return said if load is not None else said | {"status": found.associated.status}

    return TimedTask(run)


def statics_error(known: KnownStructure, load: float | None) -> float | None:
    """Relative error of an associated load; None: none was found, or none is known."""
    reference = known.load if known.upper is None else known.upper
    return None if load is None or math.isnan(reference) else load / reference - 1.0
