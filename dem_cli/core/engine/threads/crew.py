"""Threads inside one run (`dem run --threads`): number of threads that step a large structure together, and their
calls.

Answers do not depend on their number, bit for bit (kernels/tiles): a summary does not name it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor


@dataclass
class Crew:
    """Threads that simulations may step with, and the largest number used so far."""

    wanted: int
    used: int = 1


_crew: ContextVar[Crew | None] = ContextVar("crew", default=None)


@contextmanager
def crew_of(threads: int) -> Iterator[Crew]:
    """Let simulations that are made inside step with so many threads."""
    crew = Crew(threads)
    token = _crew.set(crew)
    try:
        yield crew
    finally:
        _crew.reset(token)


def threads_wanted() -> int:
    """Return the number of threads that a simulation may use."""
    crew = _crew.get()
    return crew.wanted if crew is not None else 1


def called_by_all(loop: Callable, arguments: tuple[Any, ...], members: int) -> Any:
    """Call a compiled loop by each member of its team, which wait for each other; returns what one returns.

    An interrupt, which may strike between any two lines here, leaves none of them waiting.
    """
    if members == 1:
        return loop(*arguments)
    from concurrent.futures import wait

    if (crew := _crew.get()) is not None:
        crew.used = max(crew.used, members)
    pool = _pool(os.getpid(), members)
    calls: list[Future] = []
    try:
        while len(calls) < members:
            calls.append(pool.submit(loop, *arguments))
        wait(calls)
    except BaseException:
        while len(calls) < members:
            calls.append(pool.submit(loop, *arguments))
        wait(calls)
        raise
    return calls[0].result()


@cache
def _pool(process: int, members: int) -> ThreadPoolExecutor:
    """Return threads that wait for calls, of one process: a forked one has none of its parent's."""
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(members, thread_name_prefix="crew")
