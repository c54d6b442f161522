"""Process pool of this machine: a killed process does not stop the others, and none outlives the parent.

A pipe to each process and one item at a time: no threads, no shared locks, so that a process may die at any moment, it
is known what it was doing, and an interrupt finds the parent in a wait of its own. Items and results go through it as
pickles, which run what they say: both ends are processes of this program, nobody else holds them, and no file does.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import tempfile
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for
from typing import Any, NamedTuple, TypeVar

from dem_cli.interrupts import Interrupts, asked, insist

Item = TypeVar("Item")
Result = TypeVar("Result")
GRACE = 1.5  # s that processes have to end tidily
ASK = 0.2  # s between two looks at an interrupt


class WorkerDeath:
    """Death of a worker process in place of a result: the item killed it twice, the second time alone."""


def each_done(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, first_alone: bool = False
) -> Iterator[tuple[int, Result | WorkerDeath]]:
    """Yield number and result of each item as they finish; with one process, in this one and in order.

    function must be importable, items and results picklable. An item whose process died is done again at the end,
    alone in a new process; one that kills that one as well is a `WorkerDeath`.
    first_alone: the others wait for the first one, which leaves what they would otherwise all make (compiled code).
    Raises KeyboardInterrupt where one came; no item is begun after that.
    """
    if min(jobs, len(items)) <= 1:
        for number, item in enumerate(items):
            insist()
            result = function(item)
            insist()
            yield number, result
        return
    died: list[_Task] = []
    for task, answer in _answers(function, [_Task(*each) for each in enumerate(items)], jobs, first_alone):
        if answer is None:
            died.append(task)
        else:
            yield task.number, answer.value()
    for task in died:
        for _, answer in _answers(function, [task], 1):
            yield task.number, WorkerDeath() if answer is None else answer.value()


class _Task(NamedTuple):
    number: int
    item: Any


class _Answer(NamedTuple):
    """Result or error that a process sends back."""

    result: Any
    error: Exception | None

    def value(self) -> Any:
        if self.error is not None:
            raise self.error
        return self.result


def _answers(
    function: Callable[..., Any], tasks: Sequence[_Task], jobs: int, first_alone: bool = False
) -> Iterator[tuple[_Task, _Answer | None]]:
    """Yield answers as they come; None where the process died."""
    waiting, width = deque(tasks), 1 if first_alone else jobs
    with _Crew(function) as crew:
        crew.hand_out(waiting, width)
        while crew.busy():
            for task, answer in crew.answers():
                width = jobs
                crew.hand_out(waiting, width)  # before the caller does anything: nobody waits for him
                yield task, answer
            insist()


class _Worker:
    """Fresh worker process (a fork would copy threads that hold locks), and its current task."""

    def __init__(self, function: Callable[..., Any], temporary: str):
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs, function, temporary), daemon=True)
        with _no_interrupts_for_children():
            self.process.start()
        theirs.close()
        self.task: _Task | None = None

    def give(self, task: _Task) -> None:
        """Send the next task; a dead process is found when its answer is read."""
        self.task = task
        with suppress(OSError):
            self.pipe.send(task.item)


class _Crew:
    """All worker processes; on leaving, those still working are told to stop, and ended if they do not.

    Their temporary files are in a folder of ours: who is ended cannot remove them.
    """

    def __init__(self, function: Callable[..., Any]):
        self.function = function
        self.temporary = tempfile.TemporaryDirectory(prefix="dem-", ignore_cleanup_errors=True)
        self.workers: list[_Worker] = []

    def busy(self) -> list[_Worker]:
        return [worker for worker in self.workers if worker.task is not None]

    def hand_out(self, waiting: deque[_Task], width: int) -> None:
        """Give a task to every idle worker."""
        while waiting and len(self.busy()) < width:
            idle = [worker for worker in self.workers if worker.task is None]
            if not idle:
                idle = [_Worker(self.function, self.temporary.name)]
                self.workers += idle
            idle[0].give(waiting.popleft())

    def answers(self) -> list[tuple[_Task, _Answer | None]]:
        """Collect the answers within a short wait."""
        busy, found = self.busy(), []
        ready = wait_for([worker.pipe for worker in busy], ASK)
        for worker in busy:
            if worker.pipe in ready and worker.task is not None:
                task, worker.task = worker.task, None
                try:
                    found.append((task, pickle.loads(worker.pipe.recv_bytes())))
                except (EOFError, OSError):
                    self.workers.remove(worker)
                    _ended([worker])
                    found.append((task, None))
        return found

    def __enter__(self) -> _Crew:
        return self

    def __exit__(self, kind: type | None, *rest: Any) -> None:
        """Close the pool; a caller that stops early does not wait for running items."""
        for worker in self.workers:
            worker.pipe.close()  # who has nothing to do leaves
            if kind is not None:
                worker.process.terminate()
        _ended(self.workers)
        self.temporary.cleanup()


def _ended(workers: Sequence[_Worker]) -> None:
    """Join or end the processes within a time limit."""
    deadline = time.monotonic() + GRACE
    for worker in workers:
        worker.process.join(max(0.0, deadline - time.monotonic()))
        worker.process.kill()
        worker.process.join(GRACE)
        worker.pipe.close()


@contextmanager
def _no_interrupts_for_children() -> Iterator[None]:
    """Block Ctrl-C in child processes while they start; the parent handles it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(pipe: Connection, function: Callable[..., Any], temporary: str) -> None:
    """Process items one after the other, until there are no more or the parent stops it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = temporary
    parent = multiprocessing.parent_process()
    assert parent is not None

    def leave_with_parent() -> None:  # which was killed, even: nobody wants the result
        wait_for([parent.sentinel])
        os._exit(1)

    threading.Thread(target=leave_with_parent, daemon=True).start()
    with Interrupts(("SIGTERM",), at_once=True), suppress(EOFError, OSError, KeyboardInterrupt):
        while not asked():
            pipe.send_bytes(_answered(function, pipe.recv()))


def _answered(function: Callable[..., Any], item: Any) -> bytes:
    """Process an item; returns its result or error in pickled form."""
    try:
        answer = pickle.dumps(_Answer(function(item), None))
    except Exception as error:
        error.add_note(traceback.format_exc())
        answer = _of_error(error)
    insist()
    return answer


def _of_error(error: Exception) -> bytes:
    """Pickle an error as an answer; some can be sent but not received."""
    try:
        answer = pickle.dumps(_Answer(None, error))
        pickle.loads(answer)
    except Exception:
        return pickle.dumps(_Answer(None, RuntimeError(f"{type(error).__name__}: {error}")))
    return answer
