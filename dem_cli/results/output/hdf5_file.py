"""HDF5 files that survive a kill and a full disk.

HDF5 writes piece by piece: killed between two pieces it leaves a file that nobody can open. So the pieces
are held back and reach the disk together, and a write that fails is kept from HDF5, which would otherwise
try again at every later call and when Python ends.
"""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import h5py


class TransactionalFile(io.RawIOBase):
    """Transactional file, whose writes reach the disk at `commit()`; the first one that fails is kept in `error`."""

    def __init__(self, path: Path, begun: bytes = b""):
        """Open the file. begun: its initial content, not yet on disk."""
        super().__init__()
        self.error: OSError | None = None
        self._disk = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0), 0o666)
        self._held: list[tuple[int, bytes]] = [(0, begun)] if begun else []
        self._size = len(begun)
        self._place = self._on_disk = 0

    def commit(self) -> None:
        """Write the buffered pieces to disk; nothing more once a write has failed.

        New space and what belongs there first, then the tables that point to it, the head of the file
        last, so that a kill in between almost always leaves the file as it was.
        """
        held, self._held = self._held, []
        old, self._on_disk = self._on_disk, self._size
        held.sort(key=lambda entry: 0 if entry[0] >= old else 2 if entry[0] == 0 else 1)
        try:
            if self.error is None:
                os.ftruncate(self._disk, self._size)
                for place, piece in held:
                    _write_at(self._disk, place, piece)
        except OSError as error:
            self.error = error

    def write(self, data: Any) -> int:
        """Buffer a piece to be written."""
        if self.error is None:
            self._held.append((self._place, bytes(data)))
        count = memoryview(data).nbytes
        self._place += count
        self._size = max(self._size, self._place)
        return count

    def readinto(self, buffer: Any) -> int:
        """Read the last written data at this place, buffered or not."""
        view = memoryview(buffer).cast("B")
        start, stop = self._place, self._place + len(view)
        on_disk = os.pread(self._disk, len(view), start)
        view[: len(on_disk)] = on_disk
        view[len(on_disk) :] = bytes(len(view) - len(on_disk))
        for place, piece in self._held:
            a, b = max(start, place), min(stop, place + len(piece))
            if a < b:
                view[a - start : b - start] = piece[a - place : b - place]
        self._place = stop
        return len(view)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a position; returns it."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        self._place = base + offset
        return self._place

    def tell(self) -> int:
        """Return the current position."""
        return self._place

    def truncate(self, size: int | None = None) -> int:
        """Truncate to a size, by default at the current position; returns it."""
        self._size = self._place if size is None else size
        return self._size

    def readable(self) -> bool:
        """Tell that the file is readable, as it is writable and seekable."""
        return True

    writable = seekable = readable

    def close(self) -> None:
        """Close the file; what was not committed is lost."""
        if not self.closed:
            os.close(self._disk)
        super().close()


def _write_at(disk: int, place: int, piece: bytes) -> None:
    left = memoryview(piece)
    while left:
        count = os.pwrite(disk, left, place)
        left, place = left[count:], place + count


class Hdf5File:
    """HDF5 file open for writing; on disk it is always as the last `flush()` left it."""

    def __init__(self, path: Path, begun: bytes = b""):
        """Open the file. begun: the bytes of a file that this one continues."""
        self._file = TransactionalFile(path, begun)
        self.hdf = h5py.File(self._file, "r+" if begun else "w")

    def flush(self) -> None:
        """Write everything to disk before returning, or raise OSError."""
        self.hdf.flush()
        self._commit()

    def close(self) -> None:
        """Close, then raise OSError if anything could not be written."""
        self.hdf.close()
        self._commit()
        self._file.close()

    def abandon(self) -> None:
        """Close and leave the file as the last `flush()` left it."""
        self.hdf.close()
        self._file.close()

    def _commit(self) -> None:
        self._file.commit()
        if self._file.error is not None:
            raise self._file.error
