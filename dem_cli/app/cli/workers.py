"""Process pool of a command: parallel runs in separate processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from dem_cli.app.sweep.pool import WorkerDeath, each_done
from dem_cli.errors import SolverError

Item = TypeVar("Item")
Result = TypeVar("Result")


def side_by_side(function: Callable[[Item], Result], items: Sequence[Item], jobs: int) -> Iterator[tuple[int, Result]]:
    """Run items in parallel processes; raises SolverError where an item kills its process."""
    for number, result in each_done(function, items, jobs):
        if isinstance(result, WorkerDeath):
            raise SolverError("a process of a run died, perhaps for want of memory; fewer --jobs need less")
        yield number, result
