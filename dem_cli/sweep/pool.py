"""Process pool of this machine: what kills a process does not stop the others, and nobody outlives the parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import wait as wait_for
from typing import Any, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
GRACE = 1.0  # s
AHEAD = 2  # items handed out per process: nobody waits for the next one


class WorkerDeath:
    """Death of a worker process in place of a result: it died, alone and for the second time."""


def each_done(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, first_alone: bool = False
) -> Iterator[tuple[int, Result | WorkerDeath]]:
    """Number and result of each item as they come; one process: in this one, in order.

    function must be importable, items and results picklable. When a process dies, items that it may have had are done
    again, each alone in a new process; one that kills that one as well is a `WorkerDeath`.
    first_alone: the others wait for the first one, which leaves what they would otherwise all make (compiled code).
    """
    if min(jobs, len(items)) <= 1:
        yield from ((i, function(item)) for i, item in enumerate(items))
        return
    waiting = deque(enumerate(items))
    width = 1 if first_alone else AHEAD * jobs
    while waiting:
        suspects: list[tuple[int, Item]] = []
        with _Pool(jobs) as pool:
            flying: dict[Future[Result], tuple[int, Item]] = {}
            while (waiting or flying) and not suspects:
                while waiting and len(flying) < width and not suspects:
                    try:
                        flying[pool.submit(function, waiting[0][1])] = waiting[0]
                        waiting.popleft()
                    except BrokenProcessPool:
                        suspects = list(flying.values())
                for future in wait(flying, return_when=FIRST_COMPLETED).done:
                    number, item = flying.pop(future)
                    width = AHEAD * jobs
                    if isinstance(future.exception(), BrokenProcessPool):
                        suspects = [(number, item), *flying.values()]
                        break
                    yield number, future.result()
        for number, item in suspects:
            with _Pool(1) as alone:
                try:
                    yield number, alone.submit(function, item).result()
                except BrokenProcessPool:
                    yield number, WorkerDeath()


class _Pool(ProcessPoolExecutor):
    """Fresh processes (a fork would copy threads that hold locks); those still working are ended where one leaves."""

    def __init__(self, jobs: int):
        self._before = set(multiprocessing.active_children())
        super().__init__(jobs, multiprocessing.get_context("spawn"), initializer=_begin)

    def __exit__(self, kind: type | None, *rest: Any) -> None:
        if kind is not None:  # also a caller that stops asking: what still runs is not waited for
            self.shutdown(wait=False, cancel_futures=True)
            children = set(multiprocessing.active_children()) - self._before
            for child in children:
                child.terminate()
            for child in children:  # a run that is told to stop tidies up, but the next one is handed out already
                child.join(GRACE)
                child.kill()
        super().__exit__(kind, *rest)


def _begin() -> None:
    """Ctrl-C is the parent's to handle; when the parent is gone, killed even, nobody wants the result."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def leave_with_parent() -> None:
        wait_for([parent.sentinel])
        os._exit(1)

    threading.Thread(target=leave_with_parent, daemon=True).start()
