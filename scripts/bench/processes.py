"""What a whole process of `dem` takes: wall clock, CPU seconds and peak memory, from the shell's point of view."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

LOOK = 0.005  # s between two looks at a process
RESULTS = (0, 1, 3)  # exit codes of runs with a summary: solved, outside a reference or falls, gave up


class ProcessCost(NamedTuple):
    """Wall clock and CPU [s], peak memory [B] (None: this system does not tell), and what was printed."""

    wall: float
    cpu: float
    memory: int | None
    printed: str


def dem_process(words: list[str], variables: Mapping[str, str] | None = None) -> ProcessCost:
    """One `dem WORDS`, until it ended. variables: of the environment, set for it.

    Raises CalledProcessError where it ends without a result.
    """
    command = [sys.executable, "-m", "dem_cli", *words]
    before, begun, memory = cpu_of_children(), time.perf_counter(), None
    with tempfile.TemporaryFile("w+", encoding="utf-8") as said:
        process = subprocess.Popen(command, env=os.environ | (variables or {}), stdout=said)
        while process.poll() is None:
            memory = _peak(process.pid) or memory
            time.sleep(LOOK)
        wall = time.perf_counter() - begun
        said.seek(0)
        printed = said.read()
    if process.returncode not in RESULTS:
        raise subprocess.CalledProcessError(process.returncode, command, printed)
    return ProcessCost(wall, cpu_of_children() - before, memory, printed)


def _peak(process: int) -> int | None:
    """Peak memory of a process so far [B]. What the system says at its end is no less than that of its parent."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:")), None)


def cpu_of_children() -> float:
    """CPU seconds of all processes that were started here and have ended, and of theirs."""
    spent = os.times()
    return spent.children_user + spent.children_system
