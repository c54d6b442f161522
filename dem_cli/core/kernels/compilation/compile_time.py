"""Compile time of kernels: observers of when one is compiled, and how long it took; without loading numba."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["LISTENING", "Compilation"]


class Compilation:
    """Observer of compilation that really happens, not of what comes from the cache: it counts the seconds.

    `with Compilation(tell).heard():` listens; `tell` is called once for each kernel, with what it calls.
    """

    def __init__(self, tell: Callable[[], None]) -> None:
        self.tell, self.seconds, self._begun = tell, 0.0, 0.0

    @contextmanager
    def heard(self) -> Iterator[None]:
        """Listen to compilations within a `with` block."""
        LISTENING.append(self)
        try:
            yield
        finally:
            LISTENING.remove(self)

    def begins(self) -> None:
        """Start the clock of one compilation, with all that is compiled within it."""
        self._begun = time.perf_counter()
        self.tell()

    def ends(self) -> None:
        """Stop the clock and add the time."""
        self.seconds += time.perf_counter() - self._begun


LISTENING: list[Compilation] = []  # whom machine_code.py tells
