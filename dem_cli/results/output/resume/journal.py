"""Journal of the finished runs of an analysis of many, one per line, from which `--resume` continues.

The file lies beside the output folder and goes once the results are in place. Its first line says what was run; a last
line that a kill cut short is dropped, and so is one whose checksum says that the disk has changed it.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from dem_cli.results.output.folder import JOURNAL, locked, write_error
from dem_cli.results.output.resume.kept_records import unfit
from dem_cli.results.output.resume.leftovers import damaged, fits, in_use, opened, parsed, read_at

JOURNAL_FORMAT = 2
_MOST_BYTES = 1 << 28
Key = tuple[Any, ...]
Values = tuple[Any, ...]


class Journal:
    """Journal of finished runs: `known()` are earlier ones; `add` stores one more.

    what    facts that must be the same for runs to be comparable: {words for users: text}
    resume  whether to go on from earlier runs; raises UsageError where they belong to something else, or where there
            are some and resume is False
    of      classes of a key and of values, whose fields say what they take; None: anything
    """

    def __init__(
        self, folder: Path, name: str, what: Mapping[str, str], resume: bool, of: tuple[type, type] | None = None
    ):
        self.of, self.path = of, folder / f".{name}{JOURNAL}"
        self.what, self._added = dict(what), 0
        self._known: dict[Key, Values] = {}
        self._ours = False  # whether it may be deleted
        try:
            self._file = opened(self.path, os.O_CREAT | os.O_RDWR)
        except OSError as error:
            raise write_error(error, self.path) from None
        if not locked(self._file):
            os.close(self._file)
            raise in_use(self.path.parent / name)
        try:
            self._start(resume)
        except BaseException:
            self.close()
            raise

    def _start(self, resume: bool) -> None:
        """Take over an existing journal, or begin one."""
        if os.fstat(self._file).st_size > _MOST_BYTES:
            raise damaged(self.path, "it is too large")
        lines = read_at(self._file, 0, _MOST_BYTES).split(b"\n")
        whole = lines[:-1]  # what follows the last line feed was cut short
        header = parsed(whole[0]) if whole else None
        if not isinstance(header, dict) or not isinstance(header.get("what"), dict):
            if resume and whole:
                raise damaged(self.path, "its first line says nothing of a run")
            self._begin()
            return
        rows = [row for row in map(_row, whole[1:]) if row is not None]
        if not fits(header, JOURNAL_FORMAT, self.what, resume, f"{len(rows):,} runs" if rows else None, self.path):
            self._begin()
            return
        self._ours = not rows
        for key, values in rows:
            self._check(key, values)
            self._known[key] = values
        os.ftruncate(self._file, sum(len(line) + 1 for line in whole))
        os.lseek(self._file, 0, os.SEEK_END)

    def _check(self, key: Key, values: Values) -> None:
        for of, found in zip(self.of or (), (key, values), strict=False):
            names = of._fields  # type: ignore[attr-defined]
            if len(names) != len(found) or unfit(of, dict(zip(names, found, strict=True))):
                raise damaged(self.path, f"a line is no {of.__name__}")

    def _begin(self) -> None:
        self._ours = True
        os.ftruncate(self._file, 0)
        os.lseek(self._file, 0, os.SEEK_SET)
        self._write({"format": JOURNAL_FORMAT, "what": self.what})

    def known(self) -> Mapping[Key, Values]:
        """Return the runs that were finished before."""
        return self._known

    def add(self, key: Sequence[Any], values: Sequence[Any]) -> None:
        """Store a run so that it survives a kill. Raises OutputError."""
        self._write([key, values, _checksum(key, values)])
        self._added += 1

    @property
    def count(self) -> int:
        """Number of stored runs."""
        return len(self._known) + self._added

    def _write(self, row: Any) -> None:
        line = json.dumps(row, ensure_ascii=False).encode() + b"\n"
        try:
            while line:  # a nearly full disk takes a part
                line = line[os.write(self._file, line) :]
        except OSError as error:
            raise write_error(error, self.path) from None

    def close(self) -> None:
        """Close the journal for `--resume`; one without runs is deleted."""
        if self._file >= 0:
            if self._ours and not self.count:
                self.path.unlink(missing_ok=True)
            os.close(self._file)
            self._file = -1

    def remove(self) -> None:
        """Delete the journal once the results are in place."""
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _row(line: bytes) -> tuple[Key, Values] | None:
    """Parse key and values of a line; None where it is damaged."""
    found = parsed(line)
    if not isinstance(found, list) or len(found) != 3 or _checksum(*found[:2]) != found[2]:
        return None
    key, values = _tuples(found[0]), _tuples(found[1])
    return (key, values) if isinstance(key, tuple) and isinstance(values, tuple) else None


def _checksum(key: Any, values: Any) -> int:
    return zlib.crc32(json.dumps([key, values]).encode())


def _tuples(value: Any) -> Any:
    """Convert the lists of JSON to tuples."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
