"""One run of a case as a section keeps it: the command and the answer as JSON; histories and shapes as arrays."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.analyses.solve import solve as solve_model
from dem_cli.app import api
from dem_cli.core.records.frames import Frame
from dem_cli.errors import SolverError
from dem_cli.results.output.paraview import vertices
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.solution import command_of, from_file
from studies.storage import rounded

DRAWN = 4  # digits of places that are drawn [m]
KEPT = ("status", "collapsed", "collapse_time", "collapse_block", "collapse", "repeats", "failure_load_bracket",
        "failure_mode", "mechanism", "energy_shares")  # fmt: skip


class ShakenCase(NamedTuple):
    """What a run left."""

    answer: dict[str, Any]  # as JSON
    summary: dict[str, Any]
    times: np.ndarray  # [s], (n,)
    values: np.ndarray  # of the monitors, (n, n_monitors)
    frames: list[dict[str, Any]]  # time [s], stage, blocks: corners of each


def run(case: str, *overrides: str) -> ShakenCase:
    """A run of `cases/validation/CASE.toml`. answer: command, status, seconds of CPU, and what there is of KEPT;
    a run that fails has its message as status.
    """
    file, seen, begun = CASES / "validation" / f"{case}.toml", RunKeeper(), time.process_time()
    loaded = from_file(file, *overrides)
    model = api.build_model(loaded)
    try:
        summary = solve_model(loaded.case, model, seen).summary
    except SolverError as error:
        summary = {"status": str(error)}
    answer = {
        "command": command_of(file, overrides),
        **{key: rounded(summary[key]) for key in KEPT if key in summary},
        "closure": summary.get("energy_closure"),
        "seconds": round(time.process_time() - begun, 2),
    }
    frames = [
        {"time": rounded(frame.time), "stage": frame.stage, "blocks": blocks_of(model, frame)} for frame in seen.frames
    ]
    return ShakenCase(answer, summary, seen.times, seen.values, frames)


def blocks_of(model: Any, frame: Frame) -> list[list[list[float]]]:
    """Corners of each block as they are drawn [m]."""
    corners = vertices.placed_vertices(model, frame.positions, frame.orientations)
    owner = model.vertex_blocks
    return [rounded(corners[owner == k], DRAWN) for k in range(model.n_blocks)]


def extremes(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and sizes of the largest |value| between two changes of sign."""
    ends = np.flatnonzero(values[:-1] * values[1:] < 0.0) + 1
    at = [int(first + np.abs(values[first:last]).argmax()) for first, last in zip(ends[:-1], ends[1:])]
    return times[at], np.abs(values[at])


def draw_blocks(axis: Any, blocks: Sequence[Any], title: str, edge: str = style.STONE_EDGE) -> None:
    """Blocks of the arch by their corners, all at the same scale."""
    for corners in blocks:
        axis.fill(*np.array(corners).T, facecolor=style.STONE, edgecolor=edge, lw=0.7)
    axis.set(xlim=(-0.62, 0.62), ylim=(-0.06, 0.66), aspect="equal")
    axis.set_title(title, fontsize=9, fontweight="normal")
    axis.axis("off")
