"""Every method of the program on one structure: the default run, each start of a pushover, limit analysis."""

from __future__ import annotations

import time
from typing import Any

from dem_cli.app import api
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.errors import DemError
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.solution import from_tables, solve

Tables = dict[str, Any]
Answer = dict[str, Any]
DEFAULT = "default"
STARTS = ("gravity", "path", "limit")  # analysis.start
KEPT = (
    "status", "failure_load", "failure_load_bracket", "equilibrium_load", "load_range", "unique", "kinematics", "start",
    "steps", "warnings",
)  # fmt: skip


def answers(tables: Tables, max_steps: int | None = None) -> dict[str, Answer]:
    """What the default run says, and what each start says that it is told; max_steps: of the latter."""
    found = {DEFAULT: answer(tables)}
    limit = [] if max_steps is None else [f"analysis.max_steps={max_steps}"]
    for start in STARTS:
        same = found[DEFAULT].get("start", {})
        if start == same.get("kind") and not same.get("note"):  # the same run, to the last bit
            found[start] = {**found[DEFAULT], "seconds": 0.0}
        else:
            found[start] = answer(tables, f"analysis.start={start}", *limit)
    return found


def answer(tables: Tables, *overrides: str) -> Answer:
    """The summary of a run, less what nobody compares; an error as its status."""
    begun = time.process_time()
    try:
        summary = solve(from_tables(tables, *overrides)).summary
        kept = {key: summary[key] for key in KEPT if key in summary}
        kept["bound"] = (summary.get("limit_analysis") or {}).get("associated")
    except DemError as error:
        kept = {"status": f"refused: {error}"}
    except Exception as error:  # whatever it is, it is a bug that the table must show
        kept = {"status": f"crashed: {type(error).__name__}: {error}"}
    return kept | {"seconds": round(time.process_time() - begun, 2)}


def limit_answer(tables: Tables) -> Answer:
    """Limit analysis by the program: associated load and its status, load of joints that do not dilate."""
    begun = time.process_time()
    try:
        loaded = from_tables(tables)
        model = api.build_model(loaded)
        found = limit_loads(
            model, joint_properties(solver_request(loaded.case), model), law_of(solver_request(loaded.case))
        ).summary()
        keys = ("associated", "associated_status", "non_associated", "non_associated_status")
        kept = {key: found[key] for key in keys if key in found}
    except DemError as error:
        kept = {"associated": None, "associated_status": f"refused: {error}"}
    except Exception as error:
        kept = {"associated": None, "associated_status": f"crashed: {type(error).__name__}: {error}"}
    return kept | {"seconds": round(time.process_time() - begun, 2)}
