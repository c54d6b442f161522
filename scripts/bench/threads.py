"""Gain of more cores: threads of the explicit loop, threads of the libraries inside one run, and runs side by side."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from bench.cases import KNOWN_STRUCTURES, SIZES, KnownStructure
from bench.kernels import FIXED, blocks_of, simulation, stepping
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import count, lines_of, seconds
from dem_cli.core.engine.threads.crew import crew_of

PICTURES: dict[str, Any] = {}
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS")
LOOP, INSIDE, BESIDE = "--threads", "threads in one run", "runs side by side"
LOOP_SIZES, QUICK_SIZE = (231, 2275, 20100), (231,)  # blocks
LIMIT_OPTION = ["--set", "analysis.limit=true"]  # Clarabel, which can use threads, in the run as well


def measure(options: BenchOptions) -> GroupResult:
    """Wall-clock time of steps and of runs of T231 with 1 and 2 threads, and of 1 and 2 runs at once."""
    found = GroupResult()
    known = KNOWN_STRUCTURES["T21 μ 0.6" if options.quick else "T231"]
    counts = (1, 2) if (os.cpu_count() or 1) > 1 else (1,)
    if len(counts) == 1:
        found.notes.append("one core: only one thread and one run at a time")
    sizes = QUICK_SIZE if options.quick else LOOP_SIZES
    for structure in SIZES:
        if blocks_of(structure) in sizes:
            found.records += steps_of(structure, counts, options.rounds(15))
    with tempfile.TemporaryDirectory() as folder:
        runs(known, Path(folder), 1, 1)  # kernels compiled
        for axis in (INSIDE, BESIDE):
            for n in counts:
                threads, at_once = (n, 1) if axis == INSIDE else (1, n)
                walls, loads = [], set()
                for _ in range(options.rounds(3)):
                    wall, answers = runs(known, Path(folder), threads, at_once)
                    walls.append(wall)
                    loads |= set(answers)
                found.records.append(record(known.name, axis, n, walls, loads=sorted(loads)))
    return found


def steps_of(known: KnownStructure, counts: tuple[int, ...], rounds: int) -> list[Measurement]:
    """Wall-clock ns per contact point and step of one wall by number of threads, in turn; and a digest of its state."""
    jobs, digests = [], []
    times: list[list[float]] = [[] for _ in counts]
    for threads in counts:
        with crew_of(threads):
            sim = simulation(known, FIXED)
        step, work = stepping(sim)
        jobs.append((sim, step, work))
    for _ in range(rounds):
        for found, (_, step, work) in zip(times, jobs, strict=True):
            if step.prepare is not None:
                step.prepare()
            begun = time.perf_counter()
            step.run()
            found.append(1e9 * (time.perf_counter() - begun) / work)
    for sim, _, _ in jobs:
        digests.append(
            hashlib.sha256(sim.bodies.velocities.tobytes() + sim.bodies.positions.tobytes()).hexdigest()[:16]
        )
    return [
        record(known.name, LOOP, threads, found, "ns", blocks=blocks_of(known), digest=digest)
        for threads, found, digest in zip(counts, times, digests, strict=True)
    ]


def runs(known: KnownStructure, folder: Path, threads: int, at_once: int) -> tuple[float, list[float]]:
    """Wall-clock seconds until `at_once` equal runs ended, and their failure loads."""
    environment = os.environ | dict.fromkeys(THREAD_VARIABLES, str(threads))
    overrides = [word for value in ("analysis.follow=0.0", *known.overrides) for word in ("--set", value)]
    case = str(Path(__file__).with_name(f"{known.file}.toml"))
    words = [sys.executable, "-m", "dem_cli", "run", case, *overrides, *LIMIT_OPTION, "--json", "-q", "-o"]
    begun = time.perf_counter()
    started = [
        subprocess.Popen([*words, str(folder / f"run{i}")], env=environment, stdout=subprocess.PIPE)
        for i in range(at_once)
    ]
    answers = [json.loads(process.communicate()[0])["failure_load"] for process in started]
    return time.perf_counter() - begun, answers


def page(records: list[Measurement]) -> list[str]:
    """The tables."""
    loop, others = [r for r in records if r.axis == LOOP], [r for r in records if r.axis != LOOP]
    return [*_page_of_loop(loop), "", *_page_of_runs(others)] if loop else _page_of_runs(others)


def _page_of_loop(records: list[Measurement]) -> list[str]:
    head = ("blocks", "threads", "best", "median", "× one thread", "state after the steps")
    rows = []
    for r in records:
        alone = next(other for other in records if other.case == r.case and other.value == 1)
        same = "the same bits" if r.found["digest"] == alone.found["digest"] else "DIFFERENT"
        rows.append(
            (
                count(r.found["blocks"]),
                str(r.value),
                f"{r.best:.2f}",
                f"{r.median:.2f}",
                f"{alone.best / r.best:.2f}",
                same,
            )
        )
    text = (
        "`dem run --threads`: wall-clock ns per contact point and step of walls whose geometry does not move, with the"
        " energy ledger, and how many times as quick as one thread."
    )
    return [text, "", *lines_of(head, rows)]


def _page_of_runs(records: list[Measurement]) -> list[str]:
    head = ("what", "number", "wall clock", "runs per minute", "failure load")
    rows = []
    for r in records:
        each = r.value if r.axis == BESIDE else 1
        same = ", ".join(f"{load:.15g}" for load in r.found["loads"])
        rows.append((r.axis, str(r.value), seconds(r.best), f"{60 * each / r.best:.0f}", same))
    text = (
        f"Processes of {records[0].case}, limit analysis beside the failure load, from shell to shell. Without"
        " `--threads` nothing in a run is parallel: threads of libraries change neither time nor answer, to the bit."
        " Give other cores other runs."
    )
    return [text, "", *lines_of(head, rows)]
