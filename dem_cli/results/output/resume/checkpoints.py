"""Checkpoints of a run in a hidden folder beside its results: states by name, and the output so far.

It is made with the first checkpoint, minutes into a run, and goes once the results are in place. A state that a kill
cut short does not exist: it gets its name when it is whole. Of the reported output, a last entry that was cut short is
dropped. What is whole and yet not what was written is damaged, and no run goes on from there. Only plain files of the
folder are opened, as `opened` says: whoever made the folder chooses none elsewhere.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping
from math import inf
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError
from dem_cli.results.output.folder import CHECKPOINTS, locked, write_error
from dem_cli.results.output.resume.kept_values import NotKept
from dem_cli.results.output.resume.leftovers import damaged, fits, in_use, opened, parsed, read_at

_FORMAT = 2
MOST_BYTES = 1 << 31  # of a state, and of an entry of reported output
_MOST_ABOUT = 1 << 20
_ABOUT, _TOLD, _LOCK = "about.json", "told", ".lock"
_STATE, _PART = ".state", ".part"
_SIZES, _CHECK = struct.Struct("<QI"), struct.Struct("<I")  # length and checksum of what follows; that of these two
_HEADER = _SIZES.size + _CHECK.size
_NAME = re.compile(r"[0-9]+(-[0-9]+)*\+?")  # of a state


class Checkpoints:
    """Checkpoints of one run.

    what    gives the facts that must be the same for a run to go on: {words for users: text}; called when needed
    resume  whether to go on from existing checkpoints; raises UsageError where they are of another run, or where there
            are some and resume is False
    """

    def __init__(self, folder: Path, name: str, what: Callable[[], Mapping[str, str]], resume: bool):
        self.path, self._what = folder / f".{name}{CHECKPOINTS}", what
        self._lock: int | None = None
        self._told: int | None = None
        self._out_of_use = False  # another run keeps its own there
        self.seconds = 0.0  # of work before, at the last checkpoint
        if self.path.is_symlink():
            raise self.damaged("it is a link")
        if not self.path.is_dir():
            return
        try:
            about = self._read_about()
            if not self._locks():
                raise in_use(folder / name)
            if about is None or not self._fit(about, resume):
                self.remove()
                self.seconds = 0.0
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise write_error(error, self.path) from None
            raise

    def damaged(self, why: object) -> UsageError:
        """Create the error of a damaged checkpoint."""
        return damaged(self.path, str(why))

    def _fit(self, about: Mapping[str, Any], resume: bool) -> bool:
        self.seconds = float(about.get("seconds", 0.0))
        left = f"{max(self.seconds / 60.0, 0.1):.2g} min of work"
        return fits(about, _FORMAT, self._what(), resume, left, self.path)

    @property
    def found(self) -> bool:
        """Tell whether there are checkpoints of an earlier run."""
        return self._told is not None

    def _read_about(self) -> dict[str, Any] | None:
        """Read the facts of an earlier run; None where a kill or the disk left nothing usable."""
        try:
            about = parsed(self._bytes(_ABOUT, _MOST_ABOUT))
        except OSError:
            return None
        whole = isinstance(about, dict) and isinstance(about.get("what"), dict) and type(about.get("seconds")) is float
        return about if whole and 0.0 <= about["seconds"] < inf else None

    def _locks(self) -> bool:
        self._lock = opened(self.path / _LOCK, os.O_CREAT | os.O_RDWR)
        if not locked(self._lock):
            self.close()
            return False
        self._told = opened(self.path / _TOLD, os.O_CREAT | os.O_RDWR | os.O_APPEND)
        return True

    def _ready(self) -> bool:
        """Create and lock the folder; False where another run has it."""
        if self._told is None and not self._out_of_use:
            self.path.mkdir(exist_ok=True)
            self._out_of_use = not self._locks()
        return not self._out_of_use

    # -- states ------------------------------------------------------------------------------------

    def write(self, name: str, data: bytes, seconds: float) -> None:
        """Write a state, replacing one of that name. seconds: of work so far. Raises OutputError and NotKept."""
        if len(data) > MOST_BYTES:
            raise NotKept(f"a state of {len(data):,} bytes is larger than the {MOST_BYTES:,} that are kept")
        try:
            if not self._ready():
                return
            self._whole(name + _STATE, _header(data) + data)
            self.seconds = seconds
            about = {"format": _FORMAT, "what": dict(self._what()), "seconds": seconds}
            self._whole(_ABOUT, json.dumps(about, ensure_ascii=False).encode())
        except OSError as error:
            raise write_error(error, self.path) from None

    def _whole(self, name: str, data: bytes) -> None:
        part = self.path / (name + _PART)
        part.unlink(missing_ok=True)
        _write_all(file := opened(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY), data)
        os.close(file)
        part.replace(self.path / name)

    def _bytes(self, name: str, most: int) -> bytes:
        """Read the bytes of a file. Raises UsageError where there are more than `most`, and OSError."""
        file = opened(self.path / name, os.O_RDONLY)
        try:
            if os.fstat(file).st_size > most:
                raise self.damaged(f"{name} is too large")
            return read_at(file, 0, most)
        finally:
            os.close(file)

    def read(self, name: str) -> bytes | None:
        """Read a state; None where there is no whole one. Raises UsageError where the disk has changed it."""
        if not self.found:
            return None
        try:
            data = self._bytes(name + _STATE, _HEADER + MOST_BYTES)
        except OSError:
            return None
        length = self._length(data)
        if length is None or _HEADER + length > len(data):
            return None
        return self._checked(data)

    def _length(self, data: bytes) -> int | None:
        """Return the length of the data after a header; None where it was cut short. Raises UsageError."""
        if len(data) < _HEADER:
            return None
        length, _ = _SIZES.unpack_from(data)
        if data[_SIZES.size : _HEADER] != _CHECK.pack(zlib.crc32(data[: _SIZES.size])) or length > MOST_BYTES:
            raise self.damaged("the length of an entry is wrong")
        return int(length)

    def _checked(self, data: bytes) -> bytes:
        """Return the data after its header, with its checksum verified. Raises UsageError."""
        length, checksum = _SIZES.unpack_from(data)
        found = data[_HEADER:]
        if len(found) != length or zlib.crc32(found) != checksum:
            raise self.damaged("a checksum is wrong")
        return found

    def names(self) -> list[str]:
        """List the names of all states."""
        if not self.found:
            return []
        names = (path.name.removesuffix(_STATE) for path in self.path.glob(f"*{_STATE}"))
        return [name for name in names if _NAME.fullmatch(name)]

    def drop(self, name: str) -> None:
        """Delete a state that is no longer needed."""
        (self.path / (name + _STATE)).unlink(missing_ok=True)

    # -- reported output ----------------------------------------------------------------------------

    def tell(self, entries: list[bytes]) -> list[tuple[int, int]]:
        """Append output records; returns where each entry begins and ends. Raises OutputError."""
        places: list[tuple[int, int]] = []
        try:
            if not entries or not self._ready():
                return places
            assert self._told is not None
            at = os.fstat(self._told).st_size
            for entry in entries:
                data = _header(entry) + entry
                places.append((at, at + len(data)))
                at += len(data)
                _write_all(self._told, data)
        except OSError as error:
            raise write_error(error, self.path) from None
        return places

    def told(self) -> list[tuple[int, int]]:
        """Return where each whole output record begins and ends, and cut off an incomplete one. Raises UsageError."""
        if self._told is None:
            return []
        places, at, size = [], 0, os.fstat(self._told).st_size
        while (length := self._length(read_at(self._told, at, _HEADER))) is not None:
            end = at + _HEADER + length
            if end > size:
                break
            places.append((at, end))
            at = end
        return self.only(places)

    def only(self, places: list[tuple[int, int]]) -> list[tuple[int, int]]:
        """Discard the output records after these places."""
        assert self._told is not None
        os.ftruncate(self._told, places[-1][1] if places else 0)
        return places

    def told_at(self, places: list[tuple[int, int]]) -> Iterator[bytes]:
        """Yield the output records at these places. Raises UsageError where the disk has changed them."""
        assert self._told is not None
        for begin, end in places:
            yield self._checked(read_at(self._told, begin, end - begin))

    # -- the end -----------------------------------------------------------------------------------

    def close(self) -> None:
        """Close the files and leave them for `--resume`."""
        for handle in (self._told, self._lock):
            if handle is not None:
                os.close(handle)
        self._told = self._lock = None

    def remove(self) -> None:
        """Remove the checkpoints once the results are in place, or they are not wanted."""
        if self._told is not None:
            self.close()
            shutil.rmtree(self.path, ignore_errors=True)


def _header(data: bytes) -> bytes:
    """Create the header of data: its length and checksum."""
    sizes = _SIZES.pack(len(data), zlib.crc32(data))
    return sizes + _CHECK.pack(zlib.crc32(sizes))


def _write_all(file: int, data: bytes) -> None:
    left = memoryview(data)
    while left:  # a nearly full disk takes a part
        left = left[os.write(file, left) :]
