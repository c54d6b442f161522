"""Process pool of a command: runs side by side, each in a process of its own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from dem_cli.errors import SolverError
from dem_cli.sweep.pool import WorkerDeath, each_done

Item = TypeVar("Item")
Result = TypeVar("Result")


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def side_by_side(function: Callable[[Item], Result], items: Sequence[Item], jobs: int) -> Iterator[tuple[int, Result]]:
    """As sweep.pool.each_done; raises SolverError where an item kills its process."""
    for number, result in each_done(function, items, jobs):
        if isinstance(result, WorkerDeath):
            raise SolverError("a process of a run died, perhaps for want of memory; fewer --jobs need less")
        yield number, result
