"""Limits of what is read: how large files, drawings, cases and results may be before they are refused, and why.

`LIMITS` is what docs/guide/limits.md shows; what is beyond one of them is refused with one message, within seconds and
in little memory.
"""

from __future__ import annotations

import os
import select
import stat
from pathlib import Path
from typing import NamedTuple

CASE_BYTES = 50_000_000
RECORD_BYTES = 200_000_000
DRAWING_BYTES = 200_000_000
SUMMARY_BYTES = 100_000_000
TABLE_BYTES = 1_000_000_000
MOST_EXPANSION = 100
SMALL_RESULTS = 1 << 30
PIPE_SECONDS = 10.0
_AT_ONCE = 1 << 20  # bytes that are read at once


class UnreadableInput(Exception):
    """A file that is not read: what it is, or how large, and what is allowed; without its name."""


def read_bounded(path: Path, most: int, pipes: bool = False) -> bytes:
    """What a file holds, at most so many bytes. Raises UnreadableInput, and OSError where it cannot be opened.

    pipes: whether it may be a pipe that something writes into, such as `<(...)` of a shell; devices never are read.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))  # a pipe may wait
    try:
        kind = os.fstat(handle)
        if stat.S_ISDIR(kind.st_mode):
            raise UnreadableInput("is a folder")
        piped = stat.S_ISFIFO(kind.st_mode)
        if not stat.S_ISREG(kind.st_mode) and not (piped and pipes):
            raise UnreadableInput(f"is {'a pipe' if piped else 'a device'}; only files are read")
        if kind.st_size > most:
            raise UnreadableInput(_too_large(kind.st_size, most))
        return _all_of(handle, most, piped)
    finally:
        os.close(handle)


def _all_of(handle: int, most: int, piped: bool) -> bytes:
    """Bytes up to the end, which may be further away than a file said when it was opened."""
    parts, total = [], 0
    while True:
        if piped and not select.select([handle], [], [], PIPE_SECONDS)[0]:
            raise UnreadableInput(f"is a pipe, through which nothing came in {PIPE_SECONDS:g} s")
        part = os.read(handle, _AT_ONCE)
        if not part:
            break
        parts.append(part)
        total += len(part)
        if total > most:
            raise UnreadableInput(_too_large(total, most))
    if piped and not total:
        raise UnreadableInput("is a pipe that nothing writes into")
    return b"".join(parts)


def _too_large(size: int, most: int) -> str:
    return f"has {size / 1e6:,.1f} MB; at most {most / 1e6:,.0f} MB are read"
