"""What a whole process of `dem` takes: wall clock, CPU seconds and peak memory, from the shell's point of view."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from typing import NamedTuple

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
    before, begun = cpu_of_children(), time.perf_counter()
    process = subprocess.Popen(command, env=os.environ | (variables or {}), stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    printed, memory = process.stdout.read(), None
    if hasattr(os, "wait4"):
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        memory = used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    process.communicate()
    wall = time.perf_counter() - begun
    if process.returncode not in RESULTS:
        raise subprocess.CalledProcessError(process.returncode, command, printed)
    return ProcessCost(wall, cpu_of_children() - before, memory, printed)


def cpu_of_children() -> float:
    """CPU seconds of all processes that were started here and have ended, and of theirs."""
    spent = os.times()
    return spent.children_user + spent.children_system
