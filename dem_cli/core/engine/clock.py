"""Solving time: the clock of a run, which stands still while kernels are compiled and results are written."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, TypeVar

from dem_cli.core.kernels.compilation.compile_time import Compilation
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow, RunRow, Samples
from dem_cli.core.records.ports import Observer
from dem_cli.interrupts import at_once

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.certificate_record import Certificates

AnySimulation = TypeVar("AnySimulation", bound="Simulation")


class Clock(Observer):
    """Seconds of solving, by the wall and of CPU, without the compilation of kernels and what the observer does with
    results.

    It is an observer itself and hands everything on.
    """

    def __init__(self, observer: Observer) -> None:
        self.started, self.compiling, self.observing = time.perf_counter(), 0.0, 0.0
        self._started_cpu, self._cpu_off = time.process_time(), 0.0
        self.observer, self.stages = observer, observer.stages

    @contextmanager
    def _observing(self) -> Iterator[None]:
        """Stop the clock while the observer is busy."""
        begun, cpu = time.perf_counter(), time.process_time()
        yield
        self.observing += time.perf_counter() - begun
        self._cpu_off += time.process_time() - cpu

    @contextmanager
    def _preparing(self) -> Iterator[None]:
        """Stop the clock while kernels are compiled or modules imported."""
        begun, cpu = time.perf_counter(), time.process_time()
        yield
        self.compiling += time.perf_counter() - begun
        self._cpu_off += time.process_time() - cpu

    def frame(self, frame: Frame) -> None:
        """Pass a frame to the observer, off the clock."""
        with self._observing():
            self.observer.frame(frame)

    def row(self, row: HistoryRow) -> None:
        """Pass a row to the observer, off the clock."""
        with self._observing():
            self.observer.row(row)

    def samples(self, samples: Samples) -> None:
        """Pass samples to the observer, off the clock."""
        with self._observing():
            self.observer.samples(samples)

    def runs(self, rows: Sequence[RunRow]) -> None:
        """Pass the table of all runs to the observer."""
        self.observer.runs(rows)

    def certificates(self, found: Certificates) -> None:
        """Pass the certificates of a pushover to the observer, off the clock."""
        with self._observing():
            self.observer.certificates(found)

    def structure(self, model: Model) -> None:
        """Pass another structure to the observer."""
        self.observer.structure(model)

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Pass the progress of the run to the observer, off the clock."""
        with self._observing():
            self.observer.progress(stage, load, displacement, fraction)

    def compiled(self, make: Callable[[], AnySimulation]) -> AnySimulation:
        """Make a simulation with its kernels compiled or loaded off the clock, and all else on it."""
        compilation = Compilation(lambda: self.progress("compiling (once)", 0.0, 0.0, None))
        with compilation.heard():
            sim, made = make(), compilation.seconds
            sim.stages = self.stages
            with self._preparing(), at_once():  # a minute, the first time
                sim.compile()
        self.compiling += made
        self._cpu_off += made  # one thread compiles
        return sim

    def imported(self, module: str) -> None:
        """Import a module that only some runs need, off the clock."""
        with self._preparing():
            import_module(module)

    def seconds(self) -> float:
        """Seconds of solving so far, with those before a run that was resumed."""
        return self.stages.before + time.perf_counter() - self.started - self.compiling - self.observing

    def cpu_seconds(self) -> float | None:
        """CPU seconds of this process for solving so far, of all its threads; None for a run that was resumed."""
        spent = time.process_time() - self._started_cpu - self._cpu_off
        return None if self.stages.before else max(spent, 0.0)


def duration_words(value: float) -> str:
    """Format a duration with two figures: more than such an estimate is worth."""
    for limit, unit, name in ((0.1, 1e-3, "ms"), (120.0, 1.0, "s"), (7200.0, 60.0, "min")):
        if value < limit:
            return f"{value / unit:.2g} {name}"
    return f"{value / 3600.0:.2g} h"
