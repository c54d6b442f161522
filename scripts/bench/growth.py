"""Growth with size: CPU, steps and memory of runs that reach a failure load from gravity, and of associated loads."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

from bench import diagrams
from bench.cases import FOLDER, SIZES, KnownStructure, answer
from bench.kernels import blocks_of
from bench.processes import ProcessCost, dem_process
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.spatial.associated import associated_job
from bench.table import count, lines_of, percent, seconds
from bench.timing import LONG, in_turn

RUN, ASSOCIATED = "dem run", "associated load"
LARGE, LARGEST = 1000, 10_000  # blocks
QUICK_SIZES = 2  # sizes


def resolution(blocks: int) -> float:
    """Wider for walls that take long."""
    return 0.002 if blocks < LARGE else 0.01 if blocks < LARGEST else 0.05


def measure(options: BenchOptions) -> GroupResult:
    """Two records per size: of a whole process of `dem run`, and of the associated load by itself."""
    found = GroupResult()
    sizes = SIZES[:QUICK_SIZES] if options.quick else SIZES
    solved = [associated_job(known) for known in sizes]
    in_turn(solved, options.rounds(3))
    with tempfile.TemporaryDirectory() as folder:
        for known, statics in zip(sizes, solved, strict=True):
            blocks = blocks_of(known)
            runs = [_run(known, Path(folder))]
            while len(runs) < options.rounds(2) and runs[0].cpu < LONG:
                runs.append(_run(known, Path(folder)))
            found.records += [
                record(known.name, RUN, blocks, [run.cpu for run in runs], **_said(known, runs[-1])),
                record(known.name, ASSOCIATED, blocks, statics.seconds, **statics.result),
            ]
    return found


def _run(known: KnownStructure, folder: Path) -> ProcessCost:
    values = (*known.overrides, f"analysis.resolution={resolution(blocks_of(known))}", "analysis.follow=0.0")
    overrides = [word for value in values for word in ("--set", value)]
    words = ["run", str(FOLDER / f"{known.file}.toml"), *overrides, "--json", "-q", "-o", str(folder / known.name)]
    return dem_process(words)


def _said(known: KnownStructure, run: ProcessCost) -> dict[str, Any]:
    """What a record keeps of a run: its load and what it is called, wall clock and memory."""
    summary = json.loads(run.printed)
    kept = {key: summary.get(key) for key in ("joints", "failure_load_bracket", "solve_seconds")}
    start = (summary.get("start") or {}).get("kind")
    cost = {"wall": round(run.wall, 3), "memory": run.memory, "resolution": resolution(blocks_of(known))}
    return answer(known, summary) | kept | cost | {"start": start, "load_label": summary["status"]}


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("blocks", "joints", "resolution", "at least", "not above", "reached from", "error", "steps", "CPU",
            "wall clock", "memory", "associated load", "CPU")  # fmt: skip
    solved = {r.value: r for r in records if r.axis == ASSOCIATED}
    rows = [
        (
            count(r.value), count(r.found["joints"]), f"{r.found['resolution']:g}", *_bracket(r), _reached(r),
            percent(r.found["error"]), count(r.found["steps"]), seconds(r.best), seconds(r.found["wall"]),
            "" if r.found["memory"] is None else f"{r.found['memory'] / 1e6:,.0f} MB",
            _load(solved[r.value].found["load"]), seconds(solved[r.value].best),
        )
        for r in records if r.axis == RUN
    ]  # fmt: skip
    text = (
        "Walls of the same blocks, friction 0.6, loaded by a share of their weight until failure: a new process of"
        " `dem run` for each, from shell to shell, with all that it writes; its peak memory; and the associated load,"
        " from the model to the load, by itself. *At least* was held, and *not above* failed, or is the associated load"
        " where nothing failed."
    )
    return [text, "", *lines_of(head, rows)]


def _bracket(r: Measurement) -> tuple[str, str]:
    low, high = r.found["failure_load_bracket"] or (None, None)
    return _load(low), _load(high)


def _reached(r: Measurement) -> str:
    """Where the load was reached from; how the run ended, where it did not prove a failure."""
    start = str(r.found["start"] or "?")
    return start if r.found["load_label"] == "ok" else f"{start} ({r.found['load_label']})"


def _load(load: float | None) -> str:
    return "?" if load is None else f"{load:.4f}"


def picture(records: list[Measurement], path: Path) -> None:
    """CPU seconds, memory and error against blocks."""
    runs, solved = ([r for r in records if r.axis == axis] for axis in (RUN, ASSOCIATED))
    panels = {
        "CPU seconds": {RUN: [(r.value, r.best) for r in runs], ASSOCIATED: [(r.value, r.best) for r in solved]},
        "peak memory [MB]": {RUN: [(r.value, r.found["memory"] / 1e6) for r in runs if r.found["memory"]]},
        "|error|": {RUN: [(r.value, max(abs(r.found["error"]), diagrams.FLOOR)) for r in runs if r.found["error"]]},
    }
    diagrams.growth(path, panels, "blocks")


PICTURES = {"growth": picture}
