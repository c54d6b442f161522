"""One run of a case of the church as JSON: its load, who moves and how, outlines for the picture."""

from __future__ import annotations

import shlex
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from churches.statics import BODIES, body_of
from dem_cli import api
from dem_cli.analyses import solve as solver
from dem_cli.model.model import Model
from dem_cli.output.record import Frame
from dem_cli.output.vertices import placed_vertices, rest_vertices

SEATS = {
    "left beam on side wall": ("a-8", "roof-a"), "left beam on bracket": ("b-4", "roof-a"),
    "right beam on bracket": ("c-4", "roof-d"), "right beam on side wall": ("d-8", "roof-d"),
    "tie on left wall": ("b-9", "tie"), "tie on right wall": ("c-9", "tie"),
}  # fmt: skip
DRAWN = 1.2  # m, by which the largest displacement is drawn


class Seen:
    """An observer that keeps frames and rows."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self.rows: list[Any] = []

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def row(self, row: Any) -> None:
        self.rows.append(row)

    def progress(self, *where: Any) -> None: ...


def solve(name: str, case: dict[str, Any], *overrides: str) -> dict[str, Any]:
    """The answer of a case; `name`: what it is called, or its file."""
    seen = Seen()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "case.toml"
        file.write_text(tomli_w.dumps({key: value for key, value in case.items() if key != "reference"}))
        loaded = api.load_case(file, list(overrides))
    model = api.build_model(loaded)
    summary = solver.solve(loaded.case, model, seen).summary
    limit = summary.get("limit_analysis") or {}
    bracket = summary["failure_load_bracket"]
    return {
        "command": " ".join([name, *(f"--set {shlex.quote(text)}" for text in overrides)]),
        "status": summary["status"],
        "bracket": [None if load is None else round(float(load), 6) for load in bracket],
        "mode": summary["failure_mode"],
        "path": limit.get("non_associated"),
        "associated": limit.get("associated"),
        "moves": moves(model, seen.frames) if summary["status"] == "ok" else None,
        "curve": [[round(float(row.load), 6), round(float(row.monitors[0]), 7)]
                  for row in seen.rows if row.stage in ("gravity", "loading")],
        "steps": summary["steps"],
        "seconds": round(summary["solve_seconds"], 2),
        "warnings": summary["warnings"],
    }  # fmt: skip


def moves(model: Model, frames: list[Frame]) -> dict[str, Any]:
    """Turns of the seven bodies between the last equilibrium and proven failure, over the largest; slips; outlines."""
    held = [frame for frame in frames if frame.stage == "loading"][-1]
    failing = next(frame for frame in frames if frame.stage == "collapse")
    turn = (failing.orientations - held.orientations)[:, 0]
    largest = np.abs(failing.positions - held.positions).max()
    bodies: dict[str, list[float]] = {name: [] for name in BODIES}
    for block, value in zip(model.block_ids, turn, strict=True):
        name = body_of(block) if block != "buttress" else None
        if name in bodies:
            bodies[name].append(float(value))
    most = max((abs(value) for values in bodies.values() for value in values), default=1.0)
    return {
        "turns": {name: round(float(np.mean(values)) / most, 3) for name, values in bodies.items() if values},
        "slips": {name: round(slip(model, held, failing, *pair) / largest, 3) for name, pair in SEATS.items()
                  if all(block in model.block_ids for block in pair)},
        "outlines": outlines(model, held, failing),
    }  # fmt: skip


def slip(model: Model, held: Frame, failing: Frame, first: str, second: str) -> float:
    """How far the second block slid along the joint of both, to the right [m]."""
    a, b = model.block_ids.index(first), model.block_ids.index(second)
    contacts = failing.contacts
    here = np.flatnonzero((np.sort(contacts.blocks, axis=1) == sorted((a, b))).all(axis=1))
    if not len(here):
        return 0.0
    place = contacts.points[here].mean(axis=0)

    def moved(block: int) -> float:
        shift = failing.positions[block] - held.positions[block]
        turn = failing.orientations[block, 0] - held.orientations[block, 0]
        return float(shift[0] - turn * (place[1] - held.positions[block, 1]))

    return moved(b) - moved(a)


def outlines(model: Model, held: Frame, failing: Frame) -> dict[str, Any]:
    """Corners of all parts at rest and in the mechanism, which is drawn large."""
    shift, turn = failing.positions - held.positions, failing.orientations - held.orientations
    scale = DRAWN / max(float(np.abs(shift).max()), 1e-12)
    starts = model.part_starts
    at_rest, moved = rest_vertices(model), placed_vertices(model, model.centroids + scale * shift, scale * turn)
    cut = list(zip(starts, starts[1:], strict=False))
    return {
        "rest": [np.round(at_rest[a:b], 3).tolist() for a, b in cut],
        "moved": [np.round(moved[a:b], 3).tolist() for a, b in cut],
        "fixed": [bool(model.fixed[block]) for block in model.part_blocks],
        "wood": [model.block_ids[block].startswith(("roof", "tie")) for block in model.part_blocks],
    }
