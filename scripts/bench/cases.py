"""Benchmark structures, each with the best-known load and where it comes from.

Errors are relative to that load. Where head joints carry friction the load is not unique: loading from gravity ends
near `load`, without friction in the head joints, and `path`, with friction that does not dilate (`dem limit`); an
answer between the two has no error. `upper` is the associated bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dem_cli.app import api
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.records.ports import Observer

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.model.model import Model

FOLDER = Path(__file__).resolve().parent
HEADS = "limit analysis, no friction in head joints"
COURSES_KEY = "structure.0.courses={}"
BLOCKS_KEY = "structure.0.blocks_per_course={}"


@dataclass(frozen=True)
class KnownStructure:
    """A structure and its failure load."""

    name: str
    file: str  # wall | column | arch
    overrides: tuple[str, ...]
    load: float
    source: str
    upper: float | None = None  # associated limit load where it differs
    path: float | None = None  # zero-dilation load with friction in the head joints, where it differs

    def build(self, *overrides: str) -> tuple[Case, Model]:
        """Case and model, with more values changed."""
        loaded = api.load_case(FOLDER / f"{self.file}.toml", [*self.overrides, *overrides])
        return loaded.case, api.build_model(loaded)

    def error(self, load: float | None) -> float | None:
        """Relative error of a failure load; None stays None."""
        if load is None:
            return None
        low, high = sorted((self.load, self.path or self.load))
        nearest = min(max(load, low), high)
        return load / nearest - 1.0


def _t21(
    friction: float, load: float, source: str, upper: float | None = None, path: float | None = None
) -> KnownStructure:
    name = f"T21 μ {friction:g}"
    return KnownStructure(name, "wall", (f"joints.dry.friction={friction}",), load, source, upper, path)


def _wall(
    courses: int, blocks: int, count: int, load: float, upper: float | None, path: float | None = None, name: str = ""
) -> KnownStructure:
    sizes = (COURSES_KEY.format(courses), BLOCKS_KEY.format(blocks))
    return KnownStructure(name or f"wall {count:,}", "wall", sizes, load, HEADS, upper, path)


SLIDES = "closed form: the top course slides at μ"
KNOWN_STRUCTURES = {
    known.name: known
    for known in (
        _t21(0.5, 0.5, SLIDES),
        _t21(0.6, 0.6, SLIDES),
        _t21(0.65, 0.639969, HEADS, 0.642859, 0.641412),
        _t21(0.7, 0.643226, HEADS, 0.661654, 0.645963),
        _t21(0.75, 0.645963, HEADS, 0.681151),
        _t21(1.0, 0.645963, HEADS, 1.0),
        _wall(22, 10, 231, 0.466478, 0.476977, 0.466078, "T231"),
        KnownStructure("COL14", "column", (), 0.04 / 0.245, "closed form: turns over at width / height"),
        KnownStructure("ARCH μ 0.6", "arch", (), 0.148315, "limit analysis, four hinges"),
        KnownStructure("ARCH μ 0.4", "arch", ("joints.dry.friction=0.4",), 0.052164, "limit analysis, associated"),
    )
}
SIZES = (  # walls of the same blocks and friction 0.6, by size
    _wall(6, 3, 21, 0.6, None),
    _wall(6, 10, 63, 0.6, None),
    _wall(10, 10, 105, 0.556373, 0.563585, 0.556664),
    _wall(22, 10, 231, 0.466478, 0.476977, 0.466078),
    _wall(35, 16, 578, 0.436644, 0.441457, 0.437242),
    _wall(70, 32, 2275, 0.412874, 0.414026),
    _wall(200, 100, 20100, 0.399383, 0.399490),
)


def prisms(known: KnownStructure) -> KnownStructure:
    """The same blocks in space, as deep as the structure is thick; loads are those of the plane."""
    return replace(known, name=f"{known.name}, prisms", overrides=(*known.overrides, "dimension=3"))


def wall_of(courses: int, blocks: int, count: int) -> KnownStructure:
    """A wall of the same blocks and friction 0.6 as SIZES, of which no failure load is known."""
    return _wall(courses, blocks, count, math.nan, None)


def solve(case: Case, model: Model, observer: Observer | None = None, settings: Settings = DEFAULT) -> dict[str, Any]:
    """The summary of a run; of a run that gave up, its status and message."""
    from dem_cli.analyses.solve import solve
    from dem_cli.errors import SolverError

    try:
        return solve(case, model, observer or Observer(), settings=settings).summary
    except SolverError as error:
        return {"status": str(error), "failure_load": None, "steps": None}


@cache
def compiled() -> None:
    """Have all kernels of a run compiled or loaded, so that nobody's time holds that."""
    case, model = KNOWN_STRUCTURES["T21 μ 0.6"].build("analysis.follow=0.001", "analysis.resolution=0.1")
    solve(case, model)


def answer(known: KnownStructure, summary: dict[str, Any]) -> dict[str, Any]:
    """What a record keeps of a run."""
    load = summary["failure_load"]
    found = {"load": load, "error": known.error(load), "steps": summary["steps"]}
    if summary["status"] != "ok":
        found["status"] = summary["status"]
    if summary.get("warnings"):
        found["warning"] = summary["warnings"][-1]
    if "kinematics" in summary:
        found["kinematics"] = summary["kinematics"]
    return found
