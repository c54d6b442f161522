"""Accelerogram files: columns of time and value (CSV and similar text), and the AT2, VT2, DT2 files of PEER.

Errors are RecordError: one message with the file, the line and what is wrong.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dem_cli.core.motion.record_text import RecordError, apart, by_width, is_number, number, read_text
from dem_cli.core.motion.units import SI_FACTORS
from dem_cli.input_limits import LARGEST, LONGEST, LONGEST_LINE, MOST_SAMPLES

EVEN_SHARE, EVEN_WITHIN = 0.8, 0.4  # so many steps that close to the median make a record that is meant to be even
GAP = 1.6  # steps of the median: longer is a gap in such a record
FEWEST = 20  # rows below which any steps are taken as meant
PEER_QUANTITIES = {"ACCELERATION": "acceleration", "VELOCITY": "velocity", "DISPLACEMENT": "displacement"}
PEER_UNITS = {"G": "g", "CM/S": "cm/s", "CM/SEC": "cm/s", "CM": "cm", "CM/S2": "cm/s2", "M/S2": "m/s2"}
_POSITIVE = r"((?:\d+\.?\d*|\.\d+)(?:[ED][-+]?\d+)?)"
PEER_COUNT = re.compile(r"NPTS\s*=?\s*(\d+)", re.IGNORECASE)
PEER_STEP = re.compile(rf"DT\s*=?\s*{_POSITIVE}", re.IGNORECASE)
PEER_OLD = re.compile(rf"^\s*(\d+)\s+{_POSITIVE}\s+NPTS", re.IGNORECASE)
WORD = re.compile(r"\W*[^\W\d_]{2}")  # what a header begins with, not a digit that was mistyped
IN_BRACKETS = re.compile(r"[\[(]\s*([a-zA-Z]+(?:/s(?:ec)?(?:\^?2|²|/s)?)?)\s*[\])]")  # such as `acceleration [cm/s^2]`
DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eEdD][+-]?\d+)?", re.ASCII)
ALONG = "all"  # `column` of values that go on from line to line


class RecordSamples(NamedTuple):
    """Samples of an accelerogram as they stand in a file."""

    times: np.ndarray  # [s], (n,)
    values: np.ndarray  # in `unit`, (n,)
    quantity: str | None = None  # as a header says; None: the file does not say
    unit: str | None = None


def read_series(
    path: Path, step: float | None = None, column: int | str | None = None, uneven: bool = False
) -> RecordSamples:
    """Read the samples of an accelerogram file. Raises RecordError.

    step    time step of a file that has values only [s]
    column  number of the column with the values, the first one is 1; may be left out when there is no choice; "all":
            beside a step, values go on from line to line, several in each
    uneven  steps that differ are meant: no gaps are looked for
    """
    lines = read_text(path).splitlines()
    for at, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise RecordError(
                f"{path.name}:{at}: {len(line):,} characters in a line; at most {LONGEST_LINE:,} are read"
            )
    if any(PEER_COUNT.search(line) or PEER_OLD.search(line) for line in lines[:8]):
        return _peer(path.name, lines)
    rows, numbers = _rows(path.name, lines, along=column == ALONG)
    if step is None:
        times, values = _two_columns(path.name, rows, numbers, column)
        _check_times(path.name, times, numbers, uneven)
    else:
        values = _column(path.name, rows, numbers, column)
        times = step * np.arange(len(values))
    _check_sizes(path.name, times, values)
    plain = column is None or column == ALONG  # else the unit may be that of another column
    return RecordSamples(times, values, *(said_unit(lines[: numbers[0] - 1]) if plain else (None, None)))


def _check_sizes(name: str, times: np.ndarray, values: np.ndarray) -> None:
    """Raises RecordError where times or values are those of no record: too many samples, or none that can be used."""
    end = float(max(abs(times[0]), abs(times[-1])))
    if end > LONGEST:
        raise RecordError(f"{name}: a time of {end:.3g} s is not allowed; at most {LONGEST:g} s are read")
    steps = float(times[-1] - times[0]) / max(float(np.diff(times).min()), np.finfo(float).tiny)
    if max(len(times), steps) > MOST_SAMPLES:
        shortest = float(np.diff(times).min())
        made = f"{len(times):,} samples" if len(times) > MOST_SAMPLES else (
            f"a step of {shortest:.3g} s in {times[-1] - times[0]:.3g} s")  # fmt: skip
        raise RecordError(f"{name}: {made} are not allowed; at most {MOST_SAMPLES:,} steps of the shortest are read")
    most = float(np.abs(values).max())
    if most > LARGEST:
        raise RecordError(f"{name}: a value of {most:.3g} is not allowed; numbers are at most {LARGEST:g} in size")


def said_unit(header: list[str]) -> tuple[str | None, str | None]:
    """Read quantity and unit of the values from the line above them, in brackets; None, None: no unit, or two.

    Lengths are not looked for: they may be those of anything.
    """
    written = {unit.lower() for line in header[-1:] for unit in IN_BRACKETS.findall(line)}
    plain = {unit.replace("²", "2").replace("^", "").replace("sec", "s").replace("/s/s", "/s2") for unit in written}
    found = [
        (quantity, unit) for quantity in ("acceleration", "velocity") for unit in SI_FACTORS[quantity] if unit in plain
    ]
    return found[0] if len(found) == 1 else (None, None)


def _rows(name: str, lines: list[str], along: bool) -> tuple[list[list[float]], list[int]]:
    """Read the numbers of each line that has any, with the line numbers; along: lines may differ in length."""
    rows: list[list[float]] = []
    numbers: list[int] = []
    for at, line in enumerate(lines, 1):
        fields = _fields(line)
        if not fields or (not rows and _is_header(fields)):
            continue
        row = _finite(fields, f"{name}:{at}")
        if rows and len(row) != len(rows[0]) and not along:
            columns = f"{len(row)} column{'s' * (len(row) > 1)} where the lines above have {len(rows[0])}"
            raise RecordError(f"{name}:{at}: {columns}")
        rows.append(row)
        numbers.append(at)
    if sum(map(len, rows)) < 2 or (len(rows) < 2 and not along):
        found = "no numbers" if not rows else "a single row of numbers"
        raise RecordError(f"{name}: {found}; a record has at least two")
    return rows, numbers


def _is_header(fields: list[str]) -> bool:
    """Test whether a line before any numbers has none, or begins with a word, such as `Station 12`."""
    return not any(map(is_number, fields)) or (not is_number(fields[0]) and bool(WORD.match(fields[0])))


def _finite(fields: list[str], place: str) -> list[float]:
    """Parse the numbers of a line; raises RecordError for one that is not a finite number. Raises RecordError,
    which says where: FILE:LINE."""
    row = []
    for field in fields:
        try:
            row.append(number(field))
        except ValueError:
            raise RecordError(f"{place}: '{field[:40]}' is not a number") from None
        if not math.isfinite(row[-1]):
            raise RecordError(f"{place}: '{field}' is not allowed; a record has finite numbers only")
    return row


def _fields(line: str) -> list[str]:
    """Split a line at its separators: ';', tab, ',' or blanks; beside all but ',' a comma is decimal."""
    line = line.partition("#")[0].strip()
    if ";" in line or "\t" in line:
        fields = [field.replace(",", ".") for field in re.split(r"[;\t]", line)]
    elif "," in line:
        fields = line.split()
        if len(fields) > 1 and all(map(DECIMAL_COMMA.fullmatch, fields)):
            return [field.replace(",", ".") for field in fields]
        fields = line.split(",")
    else:
        return [part for field in line.split() for part in apart(field)]
    fields = [field.strip(' "') for field in fields]
    while fields and not fields[-1]:  # a separator at the end of the line
        fields.pop()
    return fields


def _two_columns(
    name: str, rows: list[list[float]], numbers: list[int], column: int | str | None
) -> tuple[np.ndarray, np.ndarray]:
    width = len(rows[0])
    if column == ALONG:
        raise RecordError(f"{name}: column = 'all' needs a step = ... [s]; values only, several in a line")
    if width == 1:
        raise RecordError(f"{name}:{numbers[0]}: one column; time and value are two, or give step = ... [s]")
    if column == 1:
        raise RecordError(f"{name}: column 1 is the time; values stand in another one")
    if width > 2 and column is None:
        raise RecordError(f"{name}:{numbers[0]}: {width} columns; say which one holds the values, such as column = 2")
    return np.array([row[0] for row in rows]), _column(name, rows, numbers, column or 2)


def _column(name: str, rows: list[list[float]], numbers: list[int], column: int | str | None) -> np.ndarray:
    width = len(rows[0])
    if isinstance(column, str):
        return np.array([value for row in rows for value in row])
    if column is not None and column > width:
        raise RecordError(f"{name}:{numbers[0]}: there is no column {column}, only {width}")
    if column is None and width > 1:
        raise RecordError(
            f"{name}:{numbers[0]}: {width} columns beside 'step'; say which one holds the values, such as column = 2, "
            "or column = 'all' where they go on from line to line"
        )
    return np.array([row[(column or 1) - 1] for row in rows])


def _check_times(name: str, times: np.ndarray, numbers: list[int], uneven: bool) -> None:
    """Raises RecordError where time does not increase, or makes a jump in a record that is even otherwise."""
    steps = np.diff(times)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        i = back[0] + 1
        raise RecordError(f"{name}:{numbers[i]}: time does not increase ({times[i]:g} s after {times[i - 1]:g} s)")
    median = float(np.median(steps))
    even = np.abs(steps - median) <= EVEN_WITHIN * median
    gaps = np.flatnonzero(steps > GAP * median)
    if uneven or len(times) < FEWEST or even.mean() < EVEN_SHARE or not gaps.size:
        return
    i = gaps[0] + 1
    more = f", and {gaps.size - 1} more gaps" if gaps.size > 1 else ""
    raise RecordError(
        f"{name}:{numbers[i]}: a gap in time, from {times[i - 1]:g} s to {times[i]:g} s where the step is {median:g} s"
        f"{more}; uneven = true if that is meant"
    )


def _peer(name: str, lines: list[str]) -> RecordSamples:
    """Read a file of the PEER strong-motion database: header with NPTS and DT, then values, several in a line."""
    at = next(i for i, line in enumerate(lines[:8]) if PEER_COUNT.search(line) or PEER_OLD.search(line))
    count, step = _peer_size(lines[at], f"{name}:{at + 1}")
    values = by_width(lines[at + 1 :], count)  # columns of one width are certain even where they touch
    if values is None:
        values = []
        for i, line in enumerate(lines[at + 1 :], at + 2):
            values += _finite([part for field in line.split() for part in apart(field)], f"{name}:{i}")
    if len(values) != count:
        raise RecordError(f"{name}:{at + 1}: NPTS says {count} values, the file has {len(values)}")
    if count < 2:
        raise RecordError(f"{name}:{at + 1}: NPTS = {count}; a record has at least two values")
    quantity, unit = _peer_quantity("\n".join(lines[:at]).upper())
    return RecordSamples(step * np.arange(count), np.array(values), quantity, unit)


def _peer_size(line: str, place: str) -> tuple[int, float]:
    """Read the number of values and the time step [s] from a header. Raises RecordError."""
    old = PEER_OLD.search(line)
    count_found, step_found = PEER_COUNT.search(line), PEER_STEP.search(line)
    if old:
        count, step = int(old[1]), number(old[2])
    elif count_found and step_found:
        count, step = int(count_found[1]), number(step_found[1])
    else:
        raise RecordError(f"{place}: DT is missing beside NPTS")
    if step <= 0.0:
        raise RecordError(f"{place}: DT = {step:g} is not allowed; must be > 0")
    return count, step


def _peer_quantity(header: str) -> tuple[str | None, str | None]:
    """Read quantity and unit from the line `ACCELERATION TIME SERIES IN UNITS OF G`."""
    said = re.search(r"(ACCELERATION|VELOCITY|DISPLACEMENT)[^\n]*?UNITS?\s+OF\s+(\S+)", header)
    if not said:
        return None, None
    return PEER_QUANTITIES[said[1]], PEER_UNITS.get(said[2].rstrip(".,"))
