"""Gain of more cores: threads of the libraries inside one run, and runs side by side."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from dem_cli.bench.cases import KNOWN_STRUCTURES, KnownStructure
from dem_cli.bench.record import BenchOptions, GroupResult, Measurement, record
from dem_cli.bench.table import lines_of, seconds

PICTURES: dict[str, Any] = {}
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS")
INSIDE, BESIDE = "threads in one run", "runs side by side"
LIMIT_OPTION = ["--set", "analysis.limit=true"]  # Clarabel, which can use threads, in the run as well


def measure(options: BenchOptions) -> GroupResult:
    """Wall-clock time of runs of T231 with 1 and 2 threads, and of 1 and 2 runs at once."""
    found = GroupResult()
    known = KNOWN_STRUCTURES["T21 μ 0.6" if options.quick else "T231"]
    counts = (1, 2) if (os.cpu_count() or 1) > 1 else (1,)
    if len(counts) == 1:
        found.notes.append("one core: only one thread and one run at a time")
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
    """The table."""
    head = ("what", "number", "wall clock", "runs per minute", "failure load")
    rows = []
    for r in records:
        each = r.value if r.axis == BESIDE else 1
        same = ", ".join(f"{load:.15g}" for load in r.found["loads"])
        rows.append((r.axis, str(r.value), seconds(r.best), f"{60 * each / r.best:.0f}", same))
    text = (
        f"Processes of {records[0].case}, limit analysis beside the failure load, from shell to shell. Without"
        " `--threads` nothing in a run is parallel: library threads change neither time nor answer, to the bit. Give"
        " other cores other runs."
    )
    return [text, "", *lines_of(head, rows)]
