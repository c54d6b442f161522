"""Journal of the finished runs of an analysis of many, one per line as they come: what `--resume` goes on from.

The file lies beside the output folder and goes once the results are in place. Its first line says what was run; a last
line that a kill cut short is dropped.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from dem_cli.errors import UsageError
from dem_cli.output.folder import JOURNAL, locked, write_error
from dem_cli.output.resume.leftovers import fits, in_use

JOURNAL_FORMAT = 1
Key = tuple[Any, ...]
Values = tuple[Any, ...]


class Journal:
    """Journal of finished runs: `known()` are those of before; `add` keeps one more.

    what    facts that must be the same for runs to be comparable: {words for users: text}
    resume  whether runs of before are wanted; raises UsageError where they were made of something else,
            or where there are some and nobody asked for them
    """

    def __init__(self, folder: Path, name: str, what: Mapping[str, str], resume: bool):
        self.path = folder / f".{name}{JOURNAL}"
        self.what, self._added = dict(what), 0
        self._known: dict[Key, Values] = {}
        self._ours = False  # whether it may be deleted
        try:
            self._file = os.open(self.path, os.O_CREAT | os.O_RDWR, 0o644)
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
        """Take over what is there, or begin."""
        lines = os.read(self._file, os.fstat(self._file).st_size).split(b"\n")
        whole = lines[:-1]  # what follows the last line feed was cut short
        header = _parsed(whole[0]) if whole else None
        if not isinstance(header, dict) or not isinstance(header.get("what"), dict):
            if resume and whole:
                raise UsageError(f"{self.path}: is damaged; delete it to start anew")
            self._begin()
            return
        rows = [row for row in map(_parsed, whole[1:]) if isinstance(row, list) and len(row) == 2]
        if not fits(header, JOURNAL_FORMAT, self.what, resume, f"{len(rows):,} runs" if rows else None, self.path):
            self._begin()
            return
        self._ours = not rows
        self._known = {tuple(row[0]): _tuples(row[1]) for row in rows}
        os.ftruncate(self._file, sum(len(line) + 1 for line in whole))
        os.lseek(self._file, 0, os.SEEK_END)

    def _begin(self) -> None:
        self._ours = True
        os.ftruncate(self._file, 0)
        os.lseek(self._file, 0, os.SEEK_SET)
        self._write({"format": JOURNAL_FORMAT, "what": self.what})

    def known(self) -> Mapping[Key, Values]:
        """Runs that were finished before."""
        return self._known

    def add(self, key: Sequence[Any], values: Sequence[Any]) -> None:
        """Keep a run; a kill does not lose it. Raises OutputError."""
        self._write([key, values])
        self._added += 1

    @property
    def count(self) -> int:
        """How many runs it keeps."""
        return len(self._known) + self._added

    def _write(self, row: Any) -> None:
        line = json.dumps(row, ensure_ascii=False).encode() + b"\n"
        try:
            while line:  # a nearly full disk takes a part
                line = line[os.write(self._file, line) :]
        except OSError as error:
            raise write_error(error, self.path) from None

    def close(self) -> None:
        """Leave it for `--resume`; nothing stays of one without runs."""
        if self._file >= 0:
            if self._ours and not self.count:
                self.path.unlink(missing_ok=True)
            os.close(self._file)
            self._file = -1

    def remove(self) -> None:
        """The results are in place."""
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def _parsed(line: bytes) -> Any:
    try:
        return json.loads(line)
    except ValueError:
        return None


def _tuples(value: Any) -> Any:
    """Lists, as JSON has them, as tuples."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
