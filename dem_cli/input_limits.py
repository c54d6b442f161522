"""Limits of what is read: how large files, drawings, cases and results may be before they are refused, and why.

`LIMITS` is what docs/guide/limits.md shows. What is beyond one of them is refused with one message, soon and in little
memory: nothing that a file says makes the program wait or grow without end.
"""

from __future__ import annotations

import os
import select
import stat
from pathlib import Path
from typing import NamedTuple

LARGEST = 1e30
DEEPEST = 20
CASE_BYTES = 50_000_000
PIPE_SECONDS = 10.0
MOST_BLOCKS = 1_000_000
MOST_STONES = 100_000
MOST_CORNERS = 5_000
MOST_TOGETHER = 100
MOST_MISTAKES = 500
MOST_FRAMES = 1_000_000
MOST_RUNS = 1_000_000
MOST_CYCLES = 1_000_000
LONGEST = 1e7
RECORD_BYTES = 50_000_000
MOST_SAMPLES = 2_000_000
DRAWING_BYTES = 200_000_000
MOST_SHAPES = 1_000_000
MOST_FACES = 1_000_000
SUMMARY_BYTES = 100_000_000
TABLE_BYTES = 1_000_000_000
SMALL_RESULTS = 1_000_000_000
MOST_EXPANSION = 100
_AT_ONCE = 1 << 20  # bytes that are read at once


class InputLimit(NamedTuple):
    """A limit as the page of limits shows it."""

    of: str
    most: float
    unit: str
    why: str


LIMITS = {
    "cases": (
        InputLimit("numbers, by size", LARGEST, "", "products of larger ones overflow"),
        InputLimit("levels of lists and tables in each other", DEEPEST, "", "the format has 6"),
        InputLimit("a case file", CASE_BYTES, "bytes", "a case of a million blocks has fewer"),
        InputLimit("silence of a pipe that a case comes through", PIPE_SECONDS, "s", "else the program waits for ever"),
        InputLimit("blocks", MOST_BLOCKS, "", "contact search and results need some 10 kB for each"),
        InputLimit("stones that are drawn at random, of one structure", MOST_STONES, "", "drawing more takes minutes"),
        InputLimit("corners of one outline, face or solid", MOST_CORNERS, "", "shapes take memory by their square"),
        InputLimit("blocks in the same place", MOST_TOGETHER, "", "each touches each; stone is not in stone"),
        InputLimit("mistakes that are told at once", MOST_MISTAKES, "", "nobody reads more"),
        InputLimit("`output.frames`", MOST_FRAMES, "", "each is written"),
        InputLimit("runs of a sweep", MOST_RUNS, "", "more are a slip, or a case for several sweeps"),
        InputLimit("cycles of a harmonic motion", MOST_CYCLES, "", "each takes thousands of steps"),
        InputLimit("times and durations of a shaking", LONGEST, "s", "four months, in steps of less than 1 ms"),
    ),
    "files that a case names": (
        InputLimit("a record", RECORD_BYTES, "bytes", "all of it is held in memory"),
        InputLimit("samples of a record", MOST_SAMPLES, "", "five hours at 100 Hz have fewer"),
        InputLimit("values of a record, by size", LARGEST, "", "products of larger ones overflow"),
        InputLimit("a drawing or mesh", DRAWING_BYTES, "bytes", "all of it is held in memory"),
        InputLimit("faces of a mesh", MOST_FACES, "", "contact search compares the faces of neighbours"),
        InputLimit("shapes of a drawing, parts that it repeats written out", MOST_SHAPES, "", "each becomes a block"),
    ),
    "results that are read": (
        InputLimit("`summary.json`", SUMMARY_BYTES, "bytes", "all of it is held in memory"),
        InputLimit("`sweep.csv`", TABLE_BYTES, "bytes", "all of it is held in memory"),
        InputLimit("memory for `results.h5` in any case", SMALL_RESULTS, "bytes", "a file may be compressed"),
        InputLimit("memory for `results.h5` over its size", MOST_EXPANSION, "times", "dem does not compress"),
    ),
}  # fmt: skip


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
            raise UnreadableInput(f"is {what_else(path)}; only files are read")
        if kind.st_size > most:
            raise UnreadableInput(_too_large(kind.st_size, most))
        return _all_of(handle, most, piped)
    finally:
        os.close(handle)


def what_else(path: Path) -> str:
    """What a path is that is no file: `a folder`, `a pipe` or `a device`."""
    return "a folder" if path.is_dir() else "a pipe" if path.is_fifo() else "a device"


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
