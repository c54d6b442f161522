"""A clock that is set by hand, for tests of what is said while time goes by."""

from __future__ import annotations


class HandClock:
    """Stands for the module `time` where only `monotonic` is asked for."""

    def __init__(self):
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now
