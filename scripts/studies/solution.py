"""Solve a case for a study: from a file with overrides or from tables; nothing is written."""

from __future__ import annotations

import shlex
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w

from dem_cli.analyses import solve as solver
from dem_cli.app import api
from dem_cli.case.reader import LoadedCase
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.output.paraview.vertices import placed_vertices
from studies.observer import RunKeeper
from studies.places import ROOT


class Solution(NamedTuple):
    """A case that was solved."""

    model: Model
    summary: dict[str, Any]
    seen: RunKeeper


def solve(loaded: LoadedCase, settings: Settings = DEFAULT) -> Solution:
    """Solve a case that was read. Raises SolverError."""
    model, seen = api.build_model(loaded), RunKeeper()
    return Solution(model, solver.solve(loaded.case, model, seen, settings=settings).summary, seen)


def from_file(path: Path, *overrides: str) -> LoadedCase:
    """A case file with overrides, as for `--set`. Raises CaseError."""
    return api.load_case(path, list(overrides))


def from_tables(tables: dict[str, Any], *overrides: str) -> LoadedCase:
    """A case that is a table, read through a file as users have it. Raises CaseError."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_text(tomli_w.dumps(tables), encoding="utf-8")
        return from_file(path, *overrides)


def command_of(path: Path, overrides: Sequence[str]) -> str:
    """How a run is repeated by hand."""
    file = path.relative_to(ROOT).as_posix()
    return " ".join([f"dem run {file}", *(f"--set {shlex.quote(text)}" for text in overrides)])


def bracket_of(summary: dict[str, Any], places: int = 6) -> list[float | None] | None:
    """Highest equilibrium and lowest failure of a summary, rounded; None without any."""
    found = summary.get("failure_load_bracket")
    return found and [None if load is None else round(float(load), places) for load in found]


def corners_of(model: Model, frame: Frame, places: int = 6) -> list[list[list[float]]]:
    """Corners of all parts in a frame [m], [[[x, y], ...] of every part]."""
    corners = np.round(placed_vertices(model, frame.positions, frame.orientations), places)
    return [part.tolist() for part in np.split(corners, model.part_starts[1:-1])]
