"""Failure load of a case by every method: limit analysis, static path, DEM; each with its CPU seconds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.case.schema import Case
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.laws.envelope import frictional
from dem_cli.core.limit import path as paths
from dem_cli.core.limit.analysis import start_structure
from dem_cli.core.limit.associated import OK, associated_limit
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import DEFAULT_LIMIT, LimitSettings
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.masonry.assembly.solver_request import solver_request

# The fine path. Where joints slide in another order, another load is reached: increments must be small enough for it to
# settle, and end only where the load grows next to nothing.
FINE_GROWTH = 1.1
FINE = replace(DEFAULT_LIMIT, path=replace(DEFAULT_LIMIT.path, growth=FINE_GROWTH, plateau=2e-4, most=10_000))


@dataclass
class MethodLoad:
    """What one way to the failure load says."""

    status: str  # "ok", or why there is no load
    load: float | None  # multiplier; of DEM the highest proven equilibrium
    high: float | None = None  # lowest proven failure (DEM), upper bound (associated), highest load on the way (path)
    start: str = ""  # of DEM: gravity, path or limit
    seconds: float = 0.0  # CPU


@dataclass
class CaseLoads:
    """A case and its failure loads. Ways that were left out are None."""

    name: str  # folder and stem of the case file
    blocks: int  # free ones
    associated: MethodLoad
    path: MethodLoad | None = None  # joints that do not dilate, as `dem limit` has it
    fine: MethodLoad | None = None  # the same in small increments: its highest load
    gravity: MethodLoad | None = None  # DEM, load raised from gravity
    default: MethodLoad | None = None  # DEM as `dem run` goes about it
    warnings: list[str] = field(default_factory=list)  # of the DEM runs

    @classmethod
    def read(cls, cells: Mapping[str, Any]) -> CaseLoads:
        """From JSON."""
        ways = {f.name for f in fields(cls)} - {"name", "blocks", "warnings"}
        return cls(**{k: MethodLoad(**v) if k in ways and v is not None else v for k, v in cells.items()})


def measure(file: Path, overrides: Sequence[str] = (), default: bool = True) -> CaseLoads:
    """All ways for one pushover case; the collapse after failure is left out.

    default  also DEM with the start that the program chooses itself
    """
    case, model = loaded(file, overrides)
    properties, law = joint_properties(solver_request(case), model), law_of(solver_request(case))
    structure = start_structure(model, properties)
    friction = friction_of(structure.joints, law)
    bound, seconds = timed(lambda: associated_limit(structure, frictional(friction)))
    associated = MethodLoad(bound.status, bound.multiplier, bound.upper, seconds=seconds)
    row = CaseLoads(f"{file.parent.name}/{file.stem}", int((~model.fixed).sum()), associated)
    if bound.status == OK:
        row.path = by_path(structure, friction)
        row.fine = by_path(structure, friction, FINE)
    row.gravity = explicit(row, *loaded(file, [*overrides, "analysis.start=gravity"]))
    if default:
        row.default = explicit(row, case, model)
    return row


def by_path(structure: LimitStructure, friction: np.ndarray, settings: LimitSettings = DEFAULT_LIMIT) -> MethodLoad:
    """The load of joints that do not dilate: where it grows no more, and the highest on the way there."""
    path, seconds = timed(lambda: paths.trace(structure, friction, settings=settings))
    ok = path.status == paths.OK
    return MethodLoad(path.status, path.load if ok else None, max(path.loads, default=None), seconds=seconds)


def loaded(file: Path, overrides: Sequence[str]) -> tuple[Case, Model]:
    """A case and its model, without what comes after failure."""
    found = api.load_case(file, [*overrides, "analysis.follow=0.0", "output.frames=0"])
    return found.case, api.build_model(found)


def explicit(row: CaseLoads, case: Case, model: Model) -> MethodLoad:
    """DEM; what it warns of goes to the row."""
    summary, seconds = timed(lambda: solve(case, model, Observer()).summary)
    row.warnings += [text for text in summary["warnings"] if text not in row.warnings]
    start = summary.get("start", {}).get("kind", "")
    low, high = summary.get("failure_load_bracket") or (None, None)
    return MethodLoad(summary["status"], low, high, start, seconds)


def timed(do: Callable[[], Any]) -> tuple[Any, float]:
    """What `do` returns, and its CPU seconds."""
    begun = time.process_time()
    return do(), time.process_time() - begun
