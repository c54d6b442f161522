"""Ctrl-C, SIGTERM and SIGHUP stop a run between two writes, never inside one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


class Interrupts:
    """Raises KeyboardInterrupt once: at once, or at the end of a `shielded()` block."""

    def __init__(self) -> None:
        self._depth = 0
        self._pending = False
        self._ignored = self._stopped = False
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            for name in _NAMES:
                number = getattr(signal, name, None)
                if number is not None and signal.getsignal(number) is not signal.SIG_IGN:  # nohup stays nohup
                    self._previous[number] = signal.signal(number, self._handle)
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for number, handler in self._previous.items():  # a stopped program ends with its own exit code
            signal.signal(number, signal.SIG_IGN if self._stopped else handler)

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
