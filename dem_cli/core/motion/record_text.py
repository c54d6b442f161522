"""Text of accelerogram files: encodings (UTF-8, UTF-16, Latin-1), numbers with Fortran D exponents, columns that touch.

Nothing here guesses: text that could be read in two ways is no number.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from dem_cli.input_limits import RECORD_BYTES, UnreadableInput, read_bounded

# A number as people and Fortran write it: 1, -.5, 2.5E-3, 2.5D-03, and 2.5-103 where an exponent has three digits.
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]([+-]?\d+))?", re.ASCII)
LONG_EXPONENT = re.compile(r"([+-]?(?:\d+\.\d*|\.\d+))([+-]\d{3})", re.ASCII)
NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
TOUCHING = re.compile(r"[+-]?(?:\d+\.\d*|\.\d+)(?:[eEdD][+-]?\d+|[+-]\d{3}(?![\d.]))?", re.ASCII)  # with a point
DECIMALS = re.compile(r"\.(\d*)")
MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
CONTROL = re.compile(rb"[\x00-\x08\x0b\x0e-\x1f]")
END_OF_FILE = b"\x1a"  # of DOS


class RecordError(ValueError):
    """Accelerogram that cannot be used; the message says which file, where in it, and why."""


def read_text(path: Path) -> str:
    """Read a text file: UTF-8, UTF-16 with a mark, else Windows' Latin-1. Raises RecordError."""
    try:
        raw = read_bounded(path, RECORD_BYTES).rstrip(END_OF_FILE)
    except UnreadableInput as error:
        raise RecordError(f"{path.name}: {error}") from None
    except OSError as error:
        raise RecordError(f"{path.name}: cannot be read ({error.strerror or error})") from None
    marked = next((name for mark, name in MARKS.items() if raw.startswith(mark)), None)
    if marked is None and (control := CONTROL.search(raw)):
        raise RecordError(f"{path.name}: not a text file (byte {control.start()})")
    for encoding in [marked] if marked else ["utf-8", "cp1252"]:
        try:
            return raw.decode(encoding)
        except UnicodeDecodeError:
            continue
    return raw.decode(marked or "cp1252", errors="replace")  # a remark in a header may hold anything


def number(field: str) -> float:
    """Parse a field as a number; may be nan or infinite. Raises ValueError."""
    found = NUMBER.fullmatch(field) or LONG_EXPONENT.fullmatch(field)
    if found:
        return float(f"{found[1]}e{found[2] or 0}")
    if NOT_FINITE.fullmatch(field):
        return float(field)
    raise ValueError(field)


def is_number(field: str) -> bool:
    """Test whether a field is a number."""
    try:
        number(field)
    except ValueError:
        return False
    return True


def apart(field: str) -> list[str]:
    """Split numbers that touch at a sign, each with a point, such as `-.1234E-02-.5678E-02`; otherwise the field."""
    if is_number(field):
        return [field]
    parts = TOUCHING.findall(field)
    signed = all(part[0] in "+-" for part in parts[1:])
    return parts if signed and "".join(parts) == field else [field]


def by_width(lines: Sequence[str], count: int) -> list[float] | None:
    """Read values in columns of one width, which may touch; None where these lines are no such columns.

    As Fortran writes them, such as (5E15.7) or (8F10.6): lines of one length, all columns equally wide, numbers at
    their right end with equally many decimals, `count` of them; and only one width does all this.
    """
    lines = [line.rstrip() for line in lines if line.strip()]
    found = [values for width in _widths(lines, count) if (values := _cut(lines, width)) is not None]
    return found[0] if len(found) == 1 and len(found[0]) == count else None


def _widths(lines: Sequence[str], count: int) -> list[int]:
    """Find widths of columns that give so many values: all lines but the last one are full."""
    if not lines or any(len(line) != len(lines[0]) for line in lines[:-1]) or len(lines[-1]) > len(lines[0]):
        return []
    length = len(lines[0])
    per_line = [n for n in range(1, length) if length % n == 0 and math.ceil(count / n) == len(lines)]
    return [length // n for n in per_line]


def _cut(lines: Sequence[str], width: int) -> list[float] | None:
    """Read values in columns of one width; None where one is not a number at the right end, or has other decimals."""
    fields = [line[at : at + width] for line in lines for at in range(0, len(line), width)]
    decimals = {len(point[1]) for field in fields if (point := DECIMALS.search(field))}
    right = all(len(field) == width and not field[-1].isspace() for field in fields)
    fields = [field.strip() for field in fields]
    if not right or len(decimals) != 1 or not all("." in field and NUMBER.fullmatch(field) for field in fields):
        return None
    return [number(field) for field in fields]
