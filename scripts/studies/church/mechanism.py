"""One run of a case of the church as JSON: its load, who moves and how, outlines for the picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from studies.church.seven_bodies import BODIES, body_of
from studies.solution import bracket_of, from_tables, solve

SEATS = {
    "left beam on side wall": ("a-8", "roof-a"), "left beam on bracket": ("b-4", "roof-a"),
    "right beam on bracket": ("c-4", "roof-d"), "right beam on side wall": ("d-8", "roof-d"),
    "tie on left wall": ("b-9", "tie"), "tie on right wall": ("c-9", "tie"),
}  # fmt: skip
KEPT = ("command", "status", "bracket", "mode", "path", "associated", "moves", "steps", "seconds", "warnings")
DRAWN = 1.2  # m, by which the largest displacement is drawn


def solved(name: str, case: dict[str, Any], keep: tuple[str, ...] = KEPT) -> dict[str, Any]:
    """What is kept of the answer of a case; `name`: what it is called, or its file."""
    model, summary, seen = solve(from_tables({key: value for key, value in case.items() if key != "reference"}))
    limit = summary.get("limit_analysis") or {}
    answer = {
        "command": name,
        "status": summary["status"],
        "bracket": bracket_of(summary),
        "mode": summary["failure_mode"],
        "path": limit.get("non_associated"),
        "associated": limit.get("associated"),
        "moves": moves(model, seen.frames) if "moves" in keep and summary["status"] == "ok" else None,
        "curve": [[round(float(row.load), 6), round(float(row.monitors[0]), 7)]
                  for row in seen.rows if row.stage in ("gravity", "loading")],
        "steps": summary["steps"],
        "seconds": round(summary["solve_seconds"], 2),
        "warnings": summary["warnings"],
    }  # fmt: skip
    return {key: answer[key] for key in keep}


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
        "rest": [np.round(at_rest[a:b], 2).tolist() for a, b in cut],
        "moved": [np.round(moved[a:b], 2).tolist() for a, b in cut],
        "fixed": [bool(model.fixed[block]) for block in model.part_blocks],
        "wood": [model.block_ids[block].startswith(("roof", "tie")) for block in model.part_blocks],
    }
