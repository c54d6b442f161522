"""Runs side by side, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from dem_cli.errors import SolverError

Item = TypeVar("Item")
Result = TypeVar("Result")


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def side_by_side(function: Callable[[Item], Result], items: Sequence[Item], jobs: int) -> Iterator[tuple[int, Result]]:
    """Number and result of each item, as they come; one process: in this one, in order.

    function must be importable, items and results picklable. Raises SolverError where a process dies.
    """
    if min(jobs, len(items)) <= 1:
        yield from ((i, function(item)) for i, item in enumerate(items))
        return
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")  # a fork would copy threads that hold locks
    with ProcessPoolExecutor(min(jobs, len(items)), context, initializer=_leave_interrupts_to_parent) as pool:
        numbers = {pool.submit(function, item): i for i, item in enumerate(items)}
        try:
            for done in as_completed(numbers):
                yield numbers[done], done.result()
        except BrokenProcessPool:
            raise SolverError("a process of a run died, perhaps for want of memory; fewer --jobs need less") from None
        except BaseException:  # also a caller that stops asking: what still runs is not waited for
            for child in set(multiprocessing.active_children()) - others:
                child.terminate()
            raise


def _leave_interrupts_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
