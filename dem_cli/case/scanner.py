"""Scan TOML text: its plain data, impossible values, and line and column of every key and value."""

from __future__ import annotations

import datetime
import re
from bisect import bisect_right
from collections.abc import Iterator
from typing import Any

import tomli

from dem_cli.case.wording import show
from dem_cli.errors import CONTROLS, CaseProblem, KeyPath
from dem_cli.input_limits import DEEPEST, LARGEST

BLANK = re.compile(r"(?:[ \t\n,]|#[^\n]*)*")  # between elements: space, lines, commas, comments
KEY_PART = re.compile(r"""[ \t]*("(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[^\s.=\]"']+)[ \t]*""")
EQUALS = re.compile(r"[ \t]*=[ \t]*")
STRING = re.compile(
    r'''"""(?:[^\\]|\\.)*?"""+|\'\'\'.*?\'\'\'+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*\'''',
    re.DOTALL,
)
NAMES = (("id",),)  # keys of names that stand in one line
SCALAR = re.compile(r"[^,\]}\n#]*")


def parsed(text: str) -> dict[str, Any]:
    """Parse TOML to plain data. Raises tomli.TOMLDecodeError, also for excessive nesting and endless digits."""
    try:
        return tomli.loads(text)
    except RecursionError:
        raise tomli.TOMLDecodeError("lists or tables are nested too deeply", text, 0) from None
    except tomli.TOMLDecodeError:
        raise
    except ValueError:  # of int(), which reads so many digits
        raise tomli.TOMLDecodeError("a number has too many digits", text, 0) from None


def impossible_values(value: Any, path: KeyPath = ()) -> Iterator[CaseProblem]:
    """Report values that no key of a case accepts, such as dates; inf and nan are left to the keys."""
    if isinstance(value, (datetime.date, datetime.time)):
        yield CaseProblem(path, f"{value} is a date; no key takes one")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        size = abs(value)
        if LARGEST < size < float("inf"):
            said = show(value) if isinstance(value, float) or size < 10**50 else "a number of so many digits"
            message = f"{said} is not allowed; numbers are at most {LARGEST:g} in size"
            yield CaseProblem(path, message)
    elif isinstance(value, (dict, list)):
        if len(path) >= DEEPEST:
            yield CaseProblem(path, "nested too deeply: no key takes that")
            return
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            if isinstance(key, str) and _unprinted(key, name=True):
                yield CaseProblem(path, f"the name {show(key)} is not allowed; names have no control characters")
            else:
                yield from impossible_values(item, (*path, key))
    elif isinstance(value, str) and _unprinted(value, name=path[-1:] in NAMES):
        yield CaseProblem(path, f"{show(value)} is not allowed; text has no control characters")


def _unprinted(text: str, name: bool) -> bool:
    """Test whether a text contains control characters that a terminal would obey; a name may have no line break."""
    return CONTROLS.search(text) is not None or (name and "\n" in text)


class KeyPositions:
    """Line and column (from 1) of keys and values, by key path, in a text whose syntax is right."""

    def __init__(self, text: str):
        self.text = text.replace("\r\n", "\n")
        self.keys: dict[KeyPath, int] = {}
        self.values: dict[KeyPath, int] = {}
        self._tables: dict[KeyPath, int] = {}  # number of [[tables]] seen under a path
        self._lines = [0, *(match.end() for match in re.finditer("\n", self.text))]
        self._scan()

    def locate(self, path: KeyPath, key: bool = False) -> tuple[int, int]:
        """Return line and column of the value at `path`, or of its key; where it is missing, of its table."""
        places = self.keys if key else self.values
        for length in range(len(path), 0, -1):
            if path[:length] in places:
                return self._line_and_column(places[path[:length]])
            places = self.keys  # from here on: the table that should have held it
        return 1, 1

    def _line_and_column(self, offset: int) -> tuple[int, int]:
        line = bisect_right(self._lines, offset)
        return line, offset - self._lines[line - 1] + 1

    def _scan(self) -> None:
        table: KeyPath = ()
        at = self._blank(0)
        while at < len(self.text):
            if self.text.startswith("[[", at):
                table, end = self._header(at, at + 2, array=True)
                at = end + 2
            elif self.text[at] == "[":
                table, end = self._header(at, at + 1, array=False)
                at = end + 1
            else:
                at = self._pair(at, table)
            at = self._blank(at)

    def _blank(self, at: int) -> int:
        return self._end(BLANK, at)

    def _end(self, pattern: re.Pattern[str], at: int) -> int:
        """Return the end of the match of a pattern at a position of text whose syntax is right."""
        match = pattern.match(self.text, at)
        assert match is not None, f"not {pattern.pattern} at {at}"
        return match.end()

    def _dotted(self, at: int) -> tuple[list[str], int]:
        """Split a dotted key at a position of the text into its parts; returns them and its end."""
        parts = []
        while True:
            match = KEY_PART.match(self.text, at)
            assert match is not None, f"not a key at {at}"
            word = match[1]
            parts.append(next(iter(tomli.loads(f"{word} = 0"))) if word[0] in "\"'" else word)
            at = match.end()
            if self.text[at : at + 1] != ".":
                return parts, at
            at += 1

    def _header(self, start: int, at: int, array: bool) -> tuple[KeyPath, int]:
        parts, end = self._dotted(at)
        path: KeyPath = ()
        for i, part in enumerate(parts):
            path += (part,)
            self.keys.setdefault(path, start)
            self.values.setdefault(path, start)
            last = i == len(parts) - 1
            if last and array:
                self._tables[path] = self._tables.get(path, 0) + 1
            if path in self._tables:
                path += (self._tables[path] - 1,)
                self.keys.setdefault(path, start)
                self.values.setdefault(path, start)
        self.keys[path] = self.values[path] = start
        return path, end

    def _pair(self, at: int, table: KeyPath) -> int:
        parts, end = self._dotted(at)
        path = table
        for part in parts:
            path += (part,)
            self.keys.setdefault(path, at)
            self.values.setdefault(path, at)
        return self._value(self._end(EQUALS, end), path)

    def _value(self, at: int, path: KeyPath) -> int:
        """Record the position of the value at `path` and of the values inside it; returns its end."""
        self.values[path] = at
        first = self.text[at]
        if first in "\"'":
            return self._end(STRING, at)
        if first not in "[{":
            return self._end(SCALAR, at)
        closing = "]" if first == "[" else "}"
        count = 0
        at = self._blank(at + 1)
        while self.text[at] != closing:
            if first == "[":
                self.keys[(*path, count)] = at
                at = self._value(at, (*path, count))
                count += 1
            else:
                at = self._pair(at, path)
            at = self._blank(at)
        return at + 1
