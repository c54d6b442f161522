"""Compile time of kernels: who asks is told when one is compiled, and how long it took; without loading numba."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["LISTENING", "Compilation"]


class Compilation:
    """Compilation that really happens, not what comes from the cache: told when it begins, its seconds counted.

    `with Compilation(tell).heard():` listens; `tell` is called once for each kernel, with what it calls.
    """

    def __init__(self, tell: Callable[[], None]) -> None:
        self.tell, self.seconds, self._begun = tell, 0.0, 0.0

    @contextmanager
    def heard(self) -> Iterator[None]:
        """Listens inside of it."""
        LISTENING.append(self)
        try:
            yield
        finally:
            LISTENING.remove(self)

    def begins(self) -> None:
        """Its time counts, and that of what it calls within it."""
        self._begun = time.perf_counter()
        self.tell()

    def ends(self) -> None:
        """Adds its time."""
        self.seconds += time.perf_counter() - self._begun


LISTENING: list[Compilation] = []  # whom machine_code.py tells
