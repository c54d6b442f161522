"""Threads inside one run (`dem run --threads`): how many step a large structure together, and their calls.

Answers do not depend on their number, bit for bit (kernels/tiles): a summary does not name it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

_wanted: ContextVar[int] = ContextVar("threads", default=1)


@contextmanager
def crew_of(threads: int) -> Iterator[None]:
    """Simulations that are made inside may step with so many threads."""
    token = _wanted.set(threads)
    try:
        yield
    finally:
        _wanted.reset(token)


def threads_wanted() -> int:
    """How many threads a simulation may use."""
    return _wanted.get()


def called_by_all(loop: Callable, arguments: tuple[Any, ...], members: int) -> Any:
    """One call of a compiled loop by each member of its team, which wait for each other; returns what one returns.

    An interrupt, which may strike between any two lines here, leaves none of them waiting.
    """
    if members == 1:
        return loop(*arguments)
    from concurrent.futures import wait

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
    """Threads that wait for calls, of one process: a forked one has none of its parent's."""
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(members, thread_name_prefix="crew")
