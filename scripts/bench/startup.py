"""Start-up time from shell to shell: what a user waits for, wall clock and CPU."""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bench.cases import FOLDER
from bench.processes import dem_process
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import lines_of, seconds

PICTURES: dict[str, Any] = {}
FIRST_RUN = "first run of T21, nothing compiled"


def measure(options: BenchOptions) -> GroupResult:
    """`dem --help`, `dem check`, the first run with an empty cache of compiled code, later runs."""
    found, times = GroupResult(), {}
    with tempfile.TemporaryDirectory() as folder:
        case, cache = str(FOLDER / "wall.toml"), {"DEM_CACHE_DIR": folder}
        run = ["run", case, "--quiet", "-o", str(Path(folder) / "results")]
        commands = {"`dem --help`": ["--help"], "`dem check` of T21": ["check", case], "later runs of T21": run}
        if find_spec("matplotlib") is not None:
            commands["later runs of T21 with `--plot`"] = [*run, "--plot"]
        if options.quick:
            commands = {"`dem --help`": ["--help"]}
        else:
            times[FIRST_RUN] = [dem_process(run, cache)]
        for _ in range(options.rounds(5)):
            for name, words in commands.items():
                times.setdefault(name, []).append(dem_process(words, cache))
    for name, costs in times.items():
        wall, cpu = [cost.wall for cost in costs], [cost.cpu for cost in costs]
        best, median = min(wall), sorted(wall)[len(wall) // 2]
        found.records.append(record("T21 μ 0.6", "command", name, cpu, best_wall=best, median_wall=median))
    return found


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("command", "wall clock", "median", "CPU")
    rows = [(r.value, seconds(r.found["best_wall"]), seconds(r.found["median_wall"]), seconds(r.best)) for r in records]
    text = "A new process each time, from the shell's point of view. The first run compiles the kernels and keeps them."
    return [text, "", *lines_of(head, rows)]
