"""Growing datasets of an HDF5 group, extended row by row.

Handles are kept: opening one costs more than a row. Rows wait for `write_out`: HDF5 takes as long for one as for many.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import h5py
import numpy as np
from h5py import h5d, h5s

from dem_cli.results.output.described_dataset import described_dataset
from dem_cli.results.output.layout import Described

_CHUNK_BYTES = 32768
_FEWEST_ROWS = 64


class GrowingDataset:
    """Growing HDF5 dataset, extended row by row; empty at first."""

    def __init__(self, id: h5d.DatasetID, shape: tuple[int, ...], dtype: np.dtype):
        """Open an empty dataset with rows of a shape."""
        self.id, self.shape, self.dtype, self.length = id, shape, dtype, 0
        self._waiting: list[np.ndarray] = []
        self._written = 0
        self._piece: np.ndarray | None = None  # of the file, that is being filled: as many rows as are stored together

    def append(self, rows: np.ndarray) -> int:
        """Append rows; returns the previous length."""
        start = self.length
        self.length = start + len(rows)
        if len(rows):
            self._waiting.append(np.array(rows, dtype=self.dtype, order="C"))  # which may change afterwards
        return start

    def write_out(self) -> None:
        """Write the buffered rows to the file."""
        if self._waiting:
            rows = self._waiting[0] if len(self._waiting) == 1 else np.concatenate(self._waiting)
            self._waiting.clear()
            self.id.set_extent((self.length, *self.shape))
            if not self._written:
                self.id.write(h5s.ALL, h5s.ALL, rows)
            elif not self._fits(rows):
                space = self.id.get_space()
                space.select_hyperslab((self._written, *(0 for _ in self.shape)), rows.shape)
                self.id.write(h5s.create_simple(rows.shape), space, rows)
            self._note(rows)

    def _fits(self, rows: np.ndarray) -> bool:
        """Test whether rows fit the current chunk, and write it directly if so, in half the time."""
        piece, n = self._piece, len(rows)
        if piece is None or not rows.size or rows.dtype != self.id.dtype:
            return False
        filled = self._written % len(piece)
        if not filled or filled + n > len(piece):
            return False
        piece[filled : filled + n] = rows
        self.id.write_direct_chunk((self._written - filled, *(0 for _ in self.shape)), piece)
        return True

    def _note(self, rows: np.ndarray) -> None:
        """Update the current chunk after rows were written."""
        if self._piece is None:
            self._piece = np.zeros(self.id.get_create_plist().get_chunk(), self.dtype)
        self._written, size = self.length, len(self._piece)
        filled = self.length % size
        if filled <= len(rows):  # it began within them
            self._piece[:] = 0
            if rows.size:
                self._piece[:filled] = rows[len(rows) - filled :]


class GrowingGroup:
    """Growing datasets of one group, created with their first rows.

    declared     what each holds; one that is not there is written without attributes (bookkeeping of VTKHDF)
    fewest_rows  that space is made for at once
    made         those that are there already, without rows
    """

    def __init__(
        self,
        group: h5py.Group,
        declared: Mapping[str, Described],
        fewest_rows: int = _FEWEST_ROWS,
        made: Collection[str] = (),
    ):
        self.group, self.declared, self.fewest_rows, self.made = group, declared, fewest_rows, made
        self._columns: dict[str, GrowingDataset] = {}

    def append(self, name: str, rows: np.ndarray) -> int:
        """Append rows to the dataset `name` (a path inside the group); returns its previous length."""
        rows = np.asarray(rows)
        column = self._columns.get(name)
        if column is None:
            column = self._columns[name] = GrowingDataset(self._first(name, rows), rows.shape[1:], rows.dtype)
        return column.append(rows)

    def _first(self, name: str, rows: np.ndarray) -> h5d.DatasetID:
        """Return the dataset for the first rows of a name, recreated where its chunks are too small."""
        if name in self.made:
            if len(rows) <= self.fewest_rows:
                return h5d.open(self.group.id, name.encode())
            del self.group[name]
        return self.make(name, rows.shape[1:], rows.dtype, len(rows))

    def make(self, name: str, shape: tuple[int, ...], dtype: np.dtype, n_rows: int = 0) -> h5d.DatasetID:
        """Create a dataset without rows. shape: of a row. n_rows: rows to reserve at once, within a limit."""
        width = tuple(max(1, size) for size in shape)
        row_bytes = dtype.itemsize * math.prod(width)
        chunk = max(1, min(max(self.fewest_rows, n_rows), _CHUNK_BYTES // row_bytes))
        said = self.declared.get(name)
        return described_dataset(self.group, name, (0, *shape), dtype, said, (chunk, *width)).id

    def write_out(self) -> None:
        """Write the buffered rows to the file."""
        for column in self._columns.values():
            column.write_out()

    def drop_unused(self) -> None:
        """Delete datasets that never got rows, and groups that are empty."""
        for name in self.made:
            if name not in self._columns:
                del self.group[name]
                parent = name.rpartition("/")[0]
                if parent and not len(self.group[parent]):
                    del self.group[parent]

    def link(self, name: str, target: str) -> None:
        """Create a hard link `name` to the dataset `target`."""
        self.group[name] = self.group[target]
