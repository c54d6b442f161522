"""Limits on the size of files, drawings, cases and results, above which they are refused, with the reasons.

docs/guide/limits.md shows them all, with why (scripts/studies/site/limits.py). What is beyond one of them is refused
with one message, soon and in little memory: nothing that a file says makes the program wait or grow without end.
"""

from __future__ import annotations

import os
import select
import stat
from pathlib import Path

LARGEST = 1e30  # of numbers, by size
DEEPEST = 20  # levels of lists and tables
CASE_BYTES = 50_000_000  # of a case file
PIPE_SECONDS = 10.0  # s: silence of a pipe
MOST_BLOCKS = 1_000_000
MOST_TABLES = 10_000  # of one kind, such as [[load]]; blocks have a limit of their own
MOST_STONES = 100_000  # drawn at random, of one structure
MOST_CORNERS = 5_000  # of one outline, face or solid: shapes take memory by their square
MOST_DRAWN = 300  # corners of the elevation of a wall with its openings
MOST_ELEMENTS = 10_000  # of a bar
MOST_TOGETHER = 100  # blocks in the same place
MOST_MISTAKES = 500  # reported at once
MOST_FRAMES = 1_000_000
MOST_RUNS = 1_000_000
MOST_CYCLES = 1_000_000
LONGEST = 1e7  # s: times and durations of a shaking
STRONGEST_MOTION = 1e12  # m/s2: accelerations of the ground, by size
RECORD_BYTES = 50_000_000
LONGEST_LINE = 1_000_000  # characters of a line of a record
MOST_SAMPLES = 2_000_000  # of a record, in steps of the shortest
DRAWING_BYTES = 200_000_000
MOST_SHAPES = 1_000_000  # of a drawing, what it repeats written out
MOST_FACES = 1_000_000  # of a mesh
SUMMARY_BYTES = 100_000_000
TABLE_BYTES = 1_000_000_000  # of sweep.csv
SMALL_RESULTS = 1_000_000_000  # bytes of memory that any results.h5 may take
MOST_EXPANSION = 100  # times its size, that it may take where that is more
_AT_ONCE = 1 << 20  # bytes that are read at once


class UnreadableInput(Exception):
    """Error of a file that is not read: its kind or size, and what is allowed; without its name."""


def read_bounded(path: Path, most: int, pipes: bool = False) -> bytes:
    """Read at most so many bytes of a file. Raises UnreadableInput, and OSError where it cannot be opened.

    pipes: whether it may be a pipe that something writes into, such as `<(...)` of a shell; devices never are read.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))  # a pipe may wait
    try:
        kind = os.fstat(handle)
        if stat.S_ISDIR(kind.st_mode):
            raise UnreadableInput("is a folder")
        piped = stat.S_ISFIFO(kind.st_mode)
        if not stat.S_ISREG(kind.st_mode) and not (piped and pipes):
            raise UnreadableInput(f"is {what_else(path)}; only files are read")
        if kind.st_size > most:
            raise UnreadableInput(_too_large(kind.st_size, most))
        return _all_of(handle, most, piped)
    finally:
        os.close(handle)


def what_else(path: Path) -> str:
    """Name the kind of a path that is no file: `a folder`, `a pipe` or `a device`."""
    return "a folder" if path.is_dir() else "a pipe" if path.is_fifo() else "a device"


def _all_of(handle: int, most: int, piped: bool) -> bytes:
    """Read to the end of a file, which may have grown since it was opened."""
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
