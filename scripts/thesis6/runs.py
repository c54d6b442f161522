"""One run of a case as a section keeps it: the command and the answer as JSON; histories and shapes as arrays."""

from __future__ import annotations

import math
import shlex
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli import api
from dem_cli.analyses import solve as solver
from dem_cli.errors import SolverError
from dem_cli.output import vertices
from dem_cli.output.record import Frame, Observer, Samples

ROOT = Path(__file__).resolve().parents[2]
PLACES = 6  # digits kept
KEPT = ("status", "collapsed", "collapse_time", "collapse_block", "collapse", "repeats", "failure_load_bracket",
        "failure_mode", "mechanism", "energy_shares")  # fmt: skip


class Seen(Observer):
    """Keeps samples and frames."""

    def __init__(self) -> None:
        self.samples_seen: list[Samples] = []
        self.frames: list[Frame] = []

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def samples(self, samples: Samples) -> None:
        self.samples_seen.append(samples)

    def row(self, *_: Any) -> None: ...
    def progress(self, *_: Any) -> None: ...
    def runs(self, *_: Any) -> None: ...


class Run(NamedTuple):
    """What a run left."""

    answer: dict[str, Any]  # as JSON
    summary: dict[str, Any]
    times: np.ndarray  # [s], (n,)
    values: np.ndarray  # of the monitors, (n, n_monitors)
    frames: list[dict[str, Any]]  # time [s], stage, blocks: corners of each


def run(case: str, *overrides: str) -> Run:
    """A run of `cases/validation/CASE.toml`. answer: command, status, seconds of CPU, and what there is of KEPT;
    a run that fails has its message as status.
    """
    seen, begun = Seen(), time.process_time()
    loaded = api.load_case(ROOT / "cases" / "validation" / f"{case}.toml", overrides)
    model = api.build_model(loaded)
    try:
        summary = solver.solve(loaded.case, model, seen).summary
    except SolverError as error:
        summary = {"status": str(error)}
    words = [f"dem run cases/validation/{case}.toml", *(f"--set {shlex.quote(text)}" for text in overrides)]
    answer = {
        "command": " ".join(words),
        **{key: rounded(summary[key]) for key in KEPT if key in summary},
        "closure": summary.get("energy_closure"),
        "seconds": round(time.process_time() - begun, 2),
    }
    times = np.concatenate([s.times for s in seen.samples_seen] or [np.zeros(0)])
    values = np.concatenate([s.monitors for s in seen.samples_seen] or [np.zeros((0, 0))])
    frames = [
        {"time": rounded(frame.time), "stage": frame.stage, "blocks": _blocks(model, frame)} for frame in seen.frames
    ]
    return Run(answer, summary, times, values, frames)


def _blocks(model: Any, frame: Frame) -> list[list[list[float]]]:
    corners = vertices.placed_vertices(model, frame.positions, frame.orientations)
    owner = vertices.vertex_blocks(model)
    return [rounded(corners[owner == k]) for k in range(model.n_blocks)]


def rounded(value: Any) -> Any:
    """The same as plain JSON with PLACES digits."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return rounded(value.tolist())
    if isinstance(value, (list, tuple)):
        return [rounded(item) for item in value]
    if isinstance(value, (float, np.floating)):
        return round(float(value), PLACES) if math.isfinite(value) else None
    return value.item() if isinstance(value, np.generic) else value


def extremes(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and sizes of the largest |value| between two changes of sign."""
    ends = np.flatnonzero(values[:-1] * values[1:] < 0.0) + 1
    at = [int(first + np.abs(values[first:last]).argmax()) for first, last in zip(ends[:-1], ends[1:])]
    return times[at], np.abs(values[at])


def commands(*runs: dict[str, Any], more: int = 0) -> list[str]:
    """How runs are repeated, as part of the page; more: how many others are like them."""
    lines = [f"{one['command']}  # {one['seconds']:.1f} s" for one in runs]
    return ["```", *lines, *([f"# and so on: {more} more"] if more else []), "```", ""]
