"""docs/guide/limits.md: how large what is read may be, from the limits that the program keeps."""

from __future__ import annotations

from typing import NamedTuple

from dem_cli.input_limits import (
    CASE_BYTES,
    DEEPEST,
    DRAWING_BYTES,
    LARGEST,
    LONGEST,
    LONGEST_LINE,
    MOST_BLOCKS,
    MOST_CORNERS,
    MOST_CYCLES,
    MOST_DRAWN,
    MOST_ELEMENTS,
    MOST_EXPANSION,
    MOST_FACES,
    MOST_FRAMES,
    MOST_MISTAKES,
    MOST_RUNS,
    MOST_SAMPLES,
    MOST_SHAPES,
    MOST_STONES,
    MOST_TABLES,
    MOST_TOGETHER,
    PIPE_SECONDS,
    RECORD_BYTES,
    SMALL_RESULTS,
    STRONGEST_MOTION,
    SUMMARY_BYTES,
    TABLE_BYTES,
)
from studies.template import table as markdown


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
        InputLimit("tables of one kind but `[[block]]`", MOST_TABLES, "", "each is laid upon the whole structure"),
        InputLimit("stones that are drawn at random, of one structure", MOST_STONES, "", "drawing more takes minutes"),
        InputLimit("corners of one outline, face or solid", MOST_CORNERS, "", "shapes take memory by their square"),
        InputLimit("corners of the outline of a wall, with its openings", MOST_DRAWN, "", "stones are cut along each"),
        InputLimit("elements of a bar", MOST_ELEMENTS, "", "each has its bond in every step"),
        InputLimit("blocks in the same place", MOST_TOGETHER, "", "each touches each; stone is not in stone"),
        InputLimit("mistakes that are told at once", MOST_MISTAKES, "", "nobody reads more"),
        InputLimit("`output.frames`", MOST_FRAMES, "", "each is written"),
        InputLimit("runs of a sweep", MOST_RUNS, "", "more are a slip, or a case for several sweeps"),
        InputLimit("cycles of a harmonic motion", MOST_CYCLES, "", "each takes thousands of steps"),
        InputLimit("times and durations of a shaking", LONGEST, "s", "four months, in steps of less than 1 ms"),
        InputLimit("accelerations of the ground", STRONGEST_MOTION, "m/s2", "no ground moves like that"),
    ),
    "files that a case names": (
        InputLimit("a record", RECORD_BYTES, "bytes", "all of it is held in memory"),
        InputLimit("a line of a record", LONGEST_LINE, "characters", "no record has such lines"),
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


INTRODUCTION = """# Limits: how large input may be

What is beyond a limit is refused with one message and exit code 2, before it takes long or fills the memory. The
message says the file, the key, the value and what is allowed. Only files are read; a case may also come through a pipe,
such as `dem check -` or `dem check <(...)`. Devices and folders are refused at once, pipes that stay silent soon.

Made from the program's own limits by `scripts/docs --write`; do not edit."""
HEAD = ("what", "at most", "why")


def text() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for title, limits in LIMITS.items():
        parts += [f"## {title[0].upper()}{title[1:]}", markdown(HEAD, [row(limit) for limit in limits])]
    return "\n\n".join(parts) + "\n"


def row(limit: InputLimit) -> tuple[str, str, str]:
    """A line of the table."""
    number = f"{limit.most:g}" if limit.most > 1e12 else f"{limit.most:,.0f}"
    return (limit.of, f"{number} {limit.unit}".strip(), limit.why)
