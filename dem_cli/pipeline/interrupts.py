"""Ctrl-C, SIGTERM and SIGHUP interrupt a run between two writes, never inside one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


class Interrupts:
    """Raises KeyboardInterrupt once: at once, or at the end of a `shielded()` block.

    ends_program: once interrupted, the program is about to end, with an exit code of its own, and nothing disturbs it
    any more; False: it goes on, with its own handlers back in place.
    """

    def __init__(self, signals: Sequence[str] = SIGNALS, *, ends_program: bool = True) -> None:
        self.signals, self.ends_program = tuple(signals), ends_program
        self._depth = 0
        self._pending = False
        self._ignored = self._stopped = False
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            for name in self.signals:
                number = getattr(signal, name, None)
                if number is not None and signal.getsignal(number) not in (signal.SIG_IGN, None):  # nohup stays nohup
                    self._previous[number] = signal.signal(number, self._handle)
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, signal.SIG_IGN if self._stopped and self.ends_program else handler)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._ignored:
            return
        if self._depth:
            self._pending = True
        else:
            self._stop()

    def _stop(self) -> None:
        self._ignored = self._stopped = True
        raise KeyboardInterrupt

    def ignore(self) -> None:
        """From now on nothing interrupts: the last files are being written."""
        self._ignored = True

    @contextmanager
    def shielded(self) -> Iterator[None]:
        """What is in here is finished first."""
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
        if self._pending and not self._depth:
            self._pending = False
            self._stop()
