"""Cost of sweeps: runs per second over the number of processes, and what a run of a sweep costs beside its solution."""

from __future__ import annotations

import json
import os
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

from bench.cases import KNOWN_STRUCTURES, KnownStructure
from bench.processes import dem_process
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import lines_of, percent, seconds

PICTURES: dict[str, Any] = {}
WORKERS = "processes"
MANY_RUNS, FEW_RUNS = 1000, 20
FRICTIONS = 'sweep."joints.dry.friction" = {{ from = 0.5, to = 0.7, count = {count} }}\n'


class SweepTiming(NamedTuple):
    """What a sweep took [s], all its processes together for `cpu`, and what its runs found."""

    wall: float
    cpu: float
    solving: float  # in the solver, as the runs say
    worst: float  # largest relative error of a failure load


def measure(options: BenchOptions) -> GroupResult:
    """`dem sweep` of COL14 over its friction, which does not change its failure load, from shell to shell."""
    found = GroupResult()
    known, count = KNOWN_STRUCTURES["COL14"], FEW_RUNS if options.quick else MANY_RUNS
    cores = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        text = Path(__file__).with_name(f"{known.file}.toml").read_text(encoding="utf-8")
        for number in (count, 2):
            (place / f"{number}.toml").write_text(FRICTIONS.format(count=number) + text, encoding="utf-8")
        sweep(place, 2, 1, known)  # kernels compiled
        for jobs in sorted({1, 2, 4, 8, 16, cores}):
            if jobs > cores:
                break
            done = [sweep(place, count, jobs, known) for _ in range(options.rounds(2))]
            best = min(done, key=lambda one: one.wall)
            numbers: dict[str, Any] = {"runs": count, "cpu": best.cpu, "solving": best.solving, "error": best.worst}
            found.records.append(record(known.name, WORKERS, jobs, [one.wall for one in done], **numbers))
    if cores == 1:
        found.notes.append("one core: only one process")
    return found


def sweep(place: Path, count: int, jobs: int, known: KnownStructure) -> SweepTiming:
    """One sweep, in a folder of its own."""
    output = place / f"out-{time.monotonic_ns()}"
    words = ["sweep", str(place / f"{count}.toml"), "-o", str(output), "-j", str(jobs), "-q", "--json"]
    cost = dem_process(words)
    summaries = [json.loads(path.read_text(encoding="utf-8")) for path in output.glob("runs/*/summary.json")]
    errors = [known.error(summary["failure_load"]) for summary in summaries]
    worst = max(abs(error) for error in errors if error is not None)
    return SweepTiming(cost.wall, cost.cpu, sum(summary["solve_seconds"] for summary in summaries), worst)


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("processes", "runs", "wall clock", "runs per second", "CPU per run", "of it in the solver", "largest error")
    rows = []
    for r in records:
        n = r.found["runs"]
        share = f"{1000 * r.found['solving'] / n:.1f} ms"
        spent = f"{1000 * r.found['cpu'] / n:.1f} ms"
        rows.append((str(r.value), f"{n:,}", seconds(r.best), f"{n / r.best:.1f}", spent, share,
                     percent(r.found["error"])))  # fmt: skip
    text = (
        f"`dem sweep` of {records[0].case} over values of its friction, from shell to shell: start of the processes,"
        " validation of all cases, a folder per run, tables. CPU of all processes together; the solver as runs"
        " measure it, in wall clock."
    )
    return [text, "", *lines_of(head, rows)]
