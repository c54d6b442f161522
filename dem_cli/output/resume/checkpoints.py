"""Checkpoints of a run in a hidden folder beside its results: states by name, and what was told to the results so far.

It is made with the first checkpoint, minutes into a run, and goes once the results are in place. A state that a kill
cut short does not exist: it gets its name when it is whole. Of what was told, the last entry that was cut short is
dropped.
"""

from __future__ import annotations

import json
import os
import shutil
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from dem_cli.errors import OutputError
from dem_cli.output.folder import CHECKPOINTS, locked, write_error
from dem_cli.output.resume.leftovers import fits, in_use

_FORMAT = 1
_ABOUT, _TOLD, _LOCK = "about.json", "told", ".lock"
_STATE, _PART = ".state", ".part"
_SIZES = struct.Struct("<QI")  # length and checksum of what follows


class Checkpoints:
    """Checkpoints of one run.

    what    gives the facts that must be the same for a run to go on: {words for users: text}; asked for when needed
    resume  whether what is there is wanted; raises UsageError where it was made of something else, or where there is
            some and nobody asked for it
    """

    def __init__(self, folder: Path, name: str, what: Callable[[], Mapping[str, str]], resume: bool):
        self.path, self._what = folder / f".{name}{CHECKPOINTS}", what
        self._lock: int | None = None
        self._told: int | None = None
        self._out_of_use = False  # another run keeps its own there
        self.seconds = 0.0  # of work before, at the last checkpoint
        if not self.path.is_dir():
            return
        about = self._read_about()
        if not self._locks():
            raise in_use(folder / name)
        try:
            if about is None or not self._fit(about, resume):
                self.remove()
                self.seconds = 0.0
        except BaseException:
            self.close()
            raise

    def _fit(self, about: Mapping[str, Any], resume: bool) -> bool:
        self.seconds = float(about.get("seconds", 0.0))
        left = f"{max(self.seconds / 60.0, 0.1):.2g} min of work"
        return fits(about, _FORMAT, self._what(), resume, left, self.path)

    @property
    def found(self) -> bool:
        """Whether there are any of before."""
        return self._told is not None

    def _read_about(self) -> dict[str, Any] | None:
        """None where a kill or the disk left nothing to go on from."""
        try:
            about = json.loads((self.path / _ABOUT).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        whole = isinstance(about, dict) and isinstance(about.get("what"), dict)
        return about if whole and isinstance(about.get("seconds"), (int, float)) else None

    def _locks(self) -> bool:
        self._lock = os.open(self.path / _LOCK, os.O_CREAT | os.O_RDWR, 0o644)
        if not locked(self._lock):
            self.close()
            return False
        self._told = os.open(self.path / _TOLD, os.O_CREAT | os.O_RDWR | os.O_APPEND, 0o644)
        return True

    def _ready(self) -> bool:
        """The folder, made now; False where another run has it."""
        if self._told is None and not self._out_of_use:
            self.path.mkdir(exist_ok=True)
            self._out_of_use = not self._locks()
        return not self._out_of_use

    # -- states ------------------------------------------------------------------------------------

    def write(self, name: str, data: bytes, seconds: float) -> None:
        """Keeps a state, in place of one of that name. seconds: of work so far. Raises OutputError."""
        try:
            if not self._ready():
                return
            header = _SIZES.pack(len(data), zlib.crc32(data))
            self._whole(name + _STATE, header + data)
            self.seconds = seconds
            about = {"format": _FORMAT, "what": dict(self._what()), "seconds": seconds}
            self._whole(_ABOUT, json.dumps(about, ensure_ascii=False).encode())
        except OSError as error:
            raise write_error(error, self.path) from None

    def _whole(self, name: str, data: bytes) -> None:
        part = self.path / (name + _PART)
        part.write_bytes(data)
        part.replace(self.path / name)

    def read(self, name: str) -> bytes | None:
        """A state; None where there is none that is whole."""
        if not self.found:
            return None
        try:
            data = (self.path / (name + _STATE)).read_bytes()
        except OSError:
            return None
        return _checked(data)

    def names(self) -> list[str]:
        """Of all states."""
        return [path.name.removesuffix(_STATE) for path in self.path.glob(f"*{_STATE}")] if self.found else []

    def drop(self, name: str) -> None:
        """A state that nobody needs any more."""
        (self.path / (name + _STATE)).unlink(missing_ok=True)

    # -- what was told -----------------------------------------------------------------------------

    def tell(self, entries: list[bytes]) -> list[tuple[int, int]]:
        """Appends what was told to the results: where each entry begins and ends. Raises OutputError."""
        places: list[tuple[int, int]] = []
        try:
            if not entries or not self._ready():
                return places
            assert self._told is not None
            at = os.fstat(self._told).st_size
            for entry in entries:
                data = memoryview(_SIZES.pack(len(entry), zlib.crc32(entry)) + entry)
                places.append((at, at + len(data)))
                at += len(data)
                while data:  # a nearly full disk takes a part
                    data = data[os.write(self._told, data) :]
        except OSError as error:
            raise write_error(error, self.path) from None
        return places

    def told(self) -> list[tuple[int, int]]:
        """Where each whole entry begins and ends; what a kill cut short behind them is taken off."""
        if self._told is None:
            return []
        places, at, size = [], 0, os.fstat(self._told).st_size
        while at + _SIZES.size <= size:
            length = _SIZES.unpack(os.pread(self._told, _SIZES.size, at))[0]
            end = at + _SIZES.size + length
            if end > size:
                break
            places.append((at, end))
            at = end
        return self.only(places)

    def only(self, places: list[tuple[int, int]]) -> list[tuple[int, int]]:
        """Forgets what was told behind these places."""
        assert self._told is not None
        os.ftruncate(self._told, places[-1][1] if places else 0)
        return places

    def told_at(self, places: list[tuple[int, int]]) -> Iterator[bytes]:
        """The entries at these places, one after the other. Raises OutputError where the disk has changed them."""
        assert self._told is not None
        for begin, end in places:
            entry = _checked(os.pread(self._told, end - begin, begin))
            if entry is None:
                raise OutputError(f"{self.path}: is damaged; delete it to start anew")
            yield entry

    # -- the end -----------------------------------------------------------------------------------

    def close(self) -> None:
        """Leaves them for `--resume`."""
        for handle in (self._told, self._lock):
            if handle is not None:
                os.close(handle)
        self._told = self._lock = None

    def remove(self) -> None:
        """The results are in place, or what is there is not wanted."""
        if self._told is not None:
            self.close()
            shutil.rmtree(self.path, ignore_errors=True)


def _checked(data: bytes) -> bytes | None:
    """What follows its length and checksum; None where it is not that."""
    if len(data) < _SIZES.size:
        return None
    length, checksum = _SIZES.unpack_from(data)
    found = data[_SIZES.size :]
    return found if len(found) == length and zlib.crc32(found) == checksum else None
