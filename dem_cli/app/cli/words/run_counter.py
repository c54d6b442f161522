"""Progress of many runs: number done, rate, remaining time."""

from __future__ import annotations

import sys
import time
from collections import deque
from types import TracebackType
from typing import Any, TextIO

from dem_cli.app.cli.words.numbers import seconds

LINE_EVERY = 10.0  # s, where there is no terminal
RECENT = 200  # runs from which the speed is taken


class RunCounter:
    """Progress of many runs: a bar on a terminal, otherwise a plain line every 10 s; nothing when `quiet`.

    total: runs in all; before: how many of them were there at the start.
    """

    def __init__(self, total: int, before: int = 0, quiet: bool = False, stream: TextIO | None = None):
        self.total, self.done, self.failed, self.quiet = total, before, 0, quiet
        self.stream = stream or sys.stderr
        self.start = time.monotonic()
        self._ends = deque([self.start], maxlen=RECENT + 1)
        self._next = self.start + LINE_EVERY
        self._bar: Any = None

    def update(self, failed: bool = False) -> None:
        """Count one more finished run."""
        now = time.monotonic()
        self.done += 1
        self.failed += failed
        self._ends.append(now)
        if self._bar is not None:
            said = {"speed": self.speed(), "failed": self._failures(), "left": self._left()}
            self._bar.update(self._task, completed=self.done, **said)
        elif not self.quiet and now >= self._next:
            self._next = now + LINE_EVERY
            print(self.line(), file=self.stream, flush=True)

    def rate(self) -> float:
        """Return the recent rate in runs per second."""
        took = self._ends[-1] - self._ends[0]
        return (len(self._ends) - 1) / took if took > 0.0 else 0.0

    def speed(self) -> str:
        """Format the rate with a readable unit."""
        rate = self.rate()
        return "" if not rate else f"{rate:.3g} runs/s" if rate >= 1.0 else f"{seconds(1.0 / rate)} a run"

    def line(self) -> str:
        """Format the progress in one line."""
        pace = ", ".join(filter(None, (self.speed(), self._left())))
        return f"{self.done:,} of {self.total:,} runs{self._failures()}, {pace}"

    def _left(self) -> str:
        rate = self.rate()
        return f"about {seconds((self.total - self.done) / rate)} left" if rate else ""

    def _failures(self) -> str:
        return f", {self.failed:,} failed" if self.failed else ""

    def __enter__(self) -> RunCounter:
        if not self.quiet and self.stream.isatty():
            self._bar = _new_bar(self.stream)
            self._task = self._bar.add_task("runs", total=self.total, completed=self.done, speed="", failed="", left="")
            self._bar.start()
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None


def _new_bar(stream: TextIO) -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TextColumn("{task.description}{task.fields[failed]}  {task.fields[speed]}"),
        TimeElapsedColumn(),
        TextColumn("so far  {task.fields[left]}"),
    )
    return Progress(*columns, console=Console(file=stream), transient=True)
