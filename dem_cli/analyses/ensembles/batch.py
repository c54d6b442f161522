"""Parallel runs over threads, since the compiled loops release the interpreter; finished runs go to a journal."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

from dem_cli.analyses.ensembles.shaken_run import RestedStructure, ShakenRunResult
from dem_cli.core.engine.dynamic_settings import StatisticsSettings
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.interrupts import look

if TYPE_CHECKING:
    from dem_cli.core.motion.motion import Motion


class ShakingTrial(NamedTuple):
    """Run to be done: structure, record and intensity."""

    structure: int
    record: int
    intensity: float


class RunStore(Protocol):
    """Store of finished runs, which are not repeated."""

    def known(self) -> Mapping[tuple, tuple]:
        """Return finished runs: ShakingTrial and ShakenRunResult as plain tuples."""

    def add(self, key: tuple, values: tuple) -> None:
        """Store a run so that it survives a killed process."""


class Batch(NamedTuple):
    """Threads and journal of many runs."""

    threads: int = 1
    journal: RunStore | None = None


Answer = Callable[[ShakingTrial], ShakenRunResult]  # does a run, or looks it up
Task = Callable[[Answer], None]  # asks for runs, one after the other
Say = Callable[[int], None]  # called with the number of finished runs


class Batcher:
    """Executor of runs of rested structures under scaled records; results do not depend on the number of threads.

    done   all results so far
    fresh  how many of them were computed here
    """

    def __init__(
        self,
        structures: Sequence[RestedStructure],
        motions: Callable[[ShakingTrial], Sequence[Motion]],
        batch: Batch,
        settings: StatisticsSettings = DEFAULT.statistics,
    ):
        self.structures, self.motions, self.batch, self.settings = structures, motions, batch, settings
        known = batch.journal.known() if batch.journal else {}
        self.done: dict[ShakingTrial, ShakenRunResult] = {
            ShakingTrial(*key): ShakenRunResult(*values) for key, values in known.items()
        }
        self.fresh = 0
        self._lock, self._cancelled = threading.Lock(), threading.Event()

    def answer(self, trial: ShakingTrial) -> ShakenRunResult:
        """Return the result of a run, computed or from the journal."""
        found = self.done.get(trial)
        if found is not None:
            return found
        run = self.structures[trial.structure].shaken(self.motions(trial), self._cancelled.is_set)
        with self._lock:
            if self.batch.journal is not None:
                self.batch.journal.add(trial, run)
            self.done[trial] = run
            self.fresh += 1
        return run

    def work(self, tasks: Sequence[Task], say: Say) -> None:
        """Do all tasks. Raises KeyboardInterrupt where one came; what is finished is in the journal."""
        with ThreadPoolExecutor(max(1, min(self.batch.threads, len(tasks)))) as pool:
            try:
                pending = {pool.submit(task, self.answer) for task in tasks}
                while pending:
                    finished, pending = wait(pending, self.settings.ask, FIRST_COMPLETED)
                    say(len(self.done))
                    look()
                    for future in finished:
                        future.result()
            except BaseException:
                self._cancelled.set()
                pool.shutdown(wait=False, cancel_futures=True)
                raise


def each(trials: Sequence[ShakingTrial]) -> Iterator[Task]:
    """Yield a task per run."""
    return (partial(_ask, trial) for trial in trials)


def _ask(trial: ShakingTrial, answer: Answer) -> None:
    answer(trial)
