"""CPU time and steps of a failure load against the number of blocks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dem_cli.bench import diagrams
from dem_cli.bench.cases import SIZES, KnownStructure, answer, solve
from dem_cli.bench.kernels import blocks_of
from dem_cli.bench.record import BenchOptions, GroupResult, Measurement, record
from dem_cli.bench.table import count, lines_of, percent, seconds
from dem_cli.bench.timing import TimedTask, in_turn

LARGE, LARGEST = 1000, 10_000  # blocks
QUICK_SIZES = 2  # sizes
STEP_LIMIT = "analysis.max_steps=1000000"  # ends the largest walls after minutes, not hours


def resolution(blocks: int) -> float:
    """Wider for walls that take long."""
    return 0.002 if blocks < LARGE else 0.01 if blocks < LARGEST else 0.05


def measure(options: BenchOptions) -> GroupResult:
    """One record per size."""
    found = GroupResult()
    sizes = [k for k in SIZES if options.long or blocks_of(k) < LARGEST]
    if not options.long:
        found.notes.append(f"walls of more than {LARGEST:,} blocks were left out (`--long` measures them)")
    rows = [(known, _job(known)) for known in (sizes[:QUICK_SIZES] if options.quick else sizes)]
    in_turn([job for _, job in rows], options.rounds(3))
    for known, job in rows:
        blocks = blocks_of(known)
        extra: dict[str, Any] = {"blocks": blocks, "resolution": resolution(blocks), "upper": known.upper}
        found.records.append(record(known.name, "size", blocks, job.seconds, **job.result, **extra))
    return found


def _job(known: KnownStructure) -> TimedTask:
    case, model = known.build(f"analysis.resolution={resolution(blocks_of(known))}", STEP_LIMIT)

    def run() -> dict[str, Any]:
        summary = solve(case, model)
        bracket, joints = summary.get("failure_load_bracket"), summary.get("joints")
        return answer(known, summary) | {"bracket": bracket, "joints": joints}

    return TimedTask(run)


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("blocks", "joints", "resolution", "load", "bracket", "error", "steps", "CPU", "CPU per block")
    rows = [
        (
            count(r.value), count(r.found["joints"]), f"{r.found['resolution']:g}", _load(r.found["load"]),
            " – ".join(_load(load) for load in r.found["bracket"] or ()), percent(r.found["error"]),
            count(r.found["steps"]), seconds(r.best), f"{1000 * r.best / r.value:.2g} ms",
        )
        for r in records
    ]  # fmt: skip
    text = "Walls of the same blocks, friction 0.6, loaded by a share of their weight until failure; solve time."
    return [text, "", *lines_of(head, rows)]


def _load(load: float | None) -> str:
    return "?" if load is None else f"{load:.4f}"


def picture(records: list[Measurement], path: Path) -> None:
    """CPU seconds and steps against blocks."""
    panels = {
        "CPU seconds": {"walls": [(r.value, r.best) for r in records]},
        "steps": {"walls": [(r.value, r.found["steps"]) for r in records if r.found["steps"]]},
        "|error|": {
            "walls": [(r.value, max(abs(r.found["error"]), diagrams.FLOOR)) for r in records if r.found["error"]]
        },
    }
    diagrams.growth(path, panels, "blocks")


PICTURES = {"growth": picture}
