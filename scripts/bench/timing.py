"""CPU seconds of one core, repeated in turn.

Other work on a machine only ever adds time: each round measures each thing once, the best of all rounds
counts, and the median says how quiet the machine was.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from dem_cli.interrupts import insist

LONG = 4.0  # s: what takes longer is measured once


class TimedTask:
    """Task to be timed. `prepare` is called before each run, off the clock."""

    def __init__(self, run: Callable[[], Any], prepare: Callable[[], Any] | None = None):
        self.run, self.prepare = run, prepare
        self.seconds: list[float] = []
        self.result: Any = None

    def once(self) -> None:
        """One timed run."""
        if self.prepare is not None:
            self.prepare()
        begun = time.process_time()
        self.result = self.run()
        self.seconds.append(time.process_time() - begun)


def in_turn(jobs: Sequence[TimedTask], rounds: int, long: float = LONG) -> None:
    """Times every job once per round; the long ones once."""
    for _ in range(rounds):
        for job in jobs:
            if not job.seconds or min(job.seconds) < long:
                job.once()
                insist()  # a run answers Ctrl-C with what it has so far
