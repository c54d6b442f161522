"""Cost of the associated load in space: from the model of a structure to the load, joints of the start included."""

from __future__ import annotations

from typing import Any

from dem_cli.bench.cases import KnownStructure
from dem_cli.bench.timing import TimedTask

STATICS = "statics"  # kind of load: what a balance of forces inside the cones allows


def associated_job(known: KnownStructure) -> TimedTask:
    """The load by exact cones, its error against the one that is known, and the size of the problem."""
    from dem_cli.engine.properties import joint_properties, law_of
    from dem_cli.limit.analysis import limit_loads

    case, model = known.build()

    def run() -> dict[str, Any]:
        found = limit_loads(model, joint_properties(case, model), law_of(case), associated_only=True)
        load = found.associated.multiplier
        error = None if load is None or known.load is None else load / (known.upper or known.load) - 1.0
        said: dict[str, Any] = {"load": load, "error": error, "kind": STATICS, "points": len(found.associated.normal)}
        return said | ({} if load is not None else {"status": found.associated.status})

    return TimedTask(run)
