"""Handling of Ctrl-C, SIGTERM and SIGHUP: a signal is recorded and answered where the program checks for it.

A KeyboardInterrupt that a handler raises can strike anywhere, between the lines of a library that holds a lock, and
then somebody waits for that lock for ever; it can also be swallowed. So the handler only notes the signal, and `look`
raises: between two compiled calls, two waits, two runs. What is between two looks is finished first.

One library call is waited for, however long; what can take a minute and holds nothing that others wait for, compiling,
stands in `at_once`. Signals come to a process, so what is noted is known to all its threads.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType, TracebackType
from typing import Any

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
_APART = 1.0  # s: pressed again within it, while the first KeyboardInterrupt unwinds, is the same interrupt


@dataclass
class _Noted:
    """State of interrupts in this process: whether a signal came, and whether it was answered."""

    depth: int = 0  # of `Interrupts` around this moment
    asked: bool = False  # a signal came
    answered: bool = False  # and the main thread has heard of it
    at_once: bool = False  # the handler raises
    raised: float = -_APART  # when it did last


_noted = _Noted()


class Interrupts:
    """Context in which signals are recorded; nested in another one it only changes how they are answered.

    at_once       they are raised where they come: while nothing is promised yet that a half-done step could spoil
    ends_program  once interrupted, the program is about to end, with an exit code of its own, and nothing disturbs it
                  any more; False: it goes on with its own handlers, and what came too late for a look is raised then
    """

    def __init__(self, signals: Sequence[str] = SIGNALS, *, ends_program: bool = True, at_once: bool = False) -> None:
        self.signals, self.ends_program, self.at_once = tuple(signals), ends_program, at_once
        self._previous: dict[int, Any] = {}
        self._hears = self._over = False

    def __enter__(self) -> Interrupts:
        if not _in_main_thread():
            return self
        if _noted.depth:
            look()
        else:
            _noted.asked, _noted.answered, _noted.raised = False, False, -_APART
        self._hears, self._mode = True, _noted.at_once
        _noted.depth, _noted.at_once = _noted.depth + 1, self.at_once
        for name in self.signals:
            number = getattr(signal, name, None)
            handler = signal.SIG_IGN if number is None else signal.getsignal(number)
            if number is not None and handler not in (signal.SIG_IGN, None, _note):  # nohup stays nohup
                self._previous[number] = signal.signal(number, _note)
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if not self._hears:
            return
        _noted.depth, _noted.at_once = _noted.depth - 1, self._mode
        for number, handler in self._previous.items():
            ignored = self._over or (_noted.asked and self.ends_program)
            signal.signal(number, signal.SIG_IGN if ignored else handler)
        if not _noted.depth:
            too_late = _noted.asked and not _noted.answered
            _noted.asked = _noted.answered = False
            if kind is None and too_late and not self.ends_program:
                raise KeyboardInterrupt

    def over(self) -> None:
        """Mark the exit code as final: later signals are ignored."""
        _noted.answered = self._over = True


def asked() -> bool:
    """Tell whether an interrupt came."""
    return _noted.asked


def look() -> None:
    """Raise KeyboardInterrupt where one came: in the main thread once, so that the rest is finished; in others
    always.
    """
    if _noted.asked and not (_noted.answered and _in_main_thread()):
        _noted.answered = _noted.answered or _in_main_thread()
        raise KeyboardInterrupt


def insist() -> None:
    """Raise KeyboardInterrupt where one came, even if a run has answered it, so that no further run begins."""
    if _noted.asked:
        _noted.answered = True
        raise KeyboardInterrupt


@contextmanager
def at_once() -> Iterator[None]:
    """Allow immediate interrupts during a long library call on which nobody else waits."""
    if not _in_main_thread():
        yield
        return
    look()
    mode, _noted.at_once = _noted.at_once, _noted.depth > 0
    try:
        yield
    except BaseException:
        _noted.at_once = mode
        if _noted.asked:  # whatever the library made of it
            _noted.answered = True
            raise KeyboardInterrupt from None
        raise
    _noted.at_once = mode
    look()  # it may have been swallowed


def _note(number: int, frame: FrameType | None) -> None:
    """Record a signal; the handler of all signals."""
    _noted.asked = True
    now = time.monotonic()
    if _noted.at_once and not _noted.answered and now - _noted.raised >= _APART:
        _noted.raised = now
        raise KeyboardInterrupt


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
