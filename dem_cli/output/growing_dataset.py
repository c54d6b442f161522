"""Datasets of an HDF5 group that grow row by row.

Handles are kept: opening one costs more than a row. Rows wait for `write_out`: HDF5 takes as long for one as for many.
"""

from __future__ import annotations

from collections.abc import Mapping

import h5py
import numpy as np
from h5py import h5s

from dem_cli.output.described_dataset import described_dataset
from dem_cli.output.layout import Described

_CHUNK_BYTES = 32768
_FEWEST_ROWS = 64


class GrowingDataset:
    """HDF5 dataset that grows row by row."""

    def __init__(
        self,
        group: h5py.Group,
        name: str,
        shape: tuple[int, ...],
        dtype: np.dtype,
        n_rows: int,
        said: Described | None = None,
    ):
        """n_rows: how many rows space is made for at once, as far as that is little. said: what it holds."""
        width = tuple(max(1, size) for size in shape)
        row_bytes = dtype.itemsize * int(np.prod(width))
        chunk = max(1, min(n_rows, _CHUNK_BYTES // row_bytes))
        self.data = data = described_dataset(group, name, (0, *shape), dtype, said, (chunk, *width))
        self.id, self.shape, self.dtype, self.length = data.id, shape, dtype, 0
        self._waiting: list[np.ndarray] = []
        self._written = 0

    def append(self, rows: np.ndarray) -> int:
        """Add rows; returns the length that there was before."""
        start = self.length
        self.length = start + len(rows)
        if len(rows):
            self._waiting.append(np.array(rows, dtype=self.dtype, order="C"))  # which may change afterwards
        return start

    def write_out(self) -> None:
        """What waits becomes part of the file."""
        if self._waiting:
            rows = self._waiting[0] if len(self._waiting) == 1 else np.concatenate(self._waiting)
            self._waiting.clear()
            self.id.set_extent((self.length, *self.shape))
            space = self.id.get_space()
            space.select_hyperslab((self._written, *(0 for _ in self.shape)), rows.shape)
            self.id.write(h5s.create_simple(rows.shape), space, rows)
            self._written = self.length


class GrowingGroup:
    """The growing datasets of one group, made when they first get rows.

    declared     what each holds; one that is not there is written without attributes (bookkeeping of VTKHDF)
    fewest_rows  that space is made for at once
    """

    def __init__(self, group: h5py.Group, declared: Mapping[str, Described], fewest_rows: int = _FEWEST_ROWS):
        self.group, self.declared, self.fewest_rows = group, declared, fewest_rows
        self._columns: dict[str, GrowingDataset] = {}

    def append(self, name: str, rows: np.ndarray) -> int:
        """Add rows to the dataset `name` (a path inside the group); returns the length that it had."""
        rows = np.asarray(rows)
        column = self._columns.get(name)
        if column is None:
            n_rows, said = max(self.fewest_rows, len(rows)), self.declared.get(name)
            column = GrowingDataset(self.group, name, rows.shape[1:], rows.dtype, n_rows, said)
            self._columns[name] = column
        return column.append(rows)

    def write_out(self) -> None:
        """What waits becomes part of the file."""
        for column in self._columns.values():
            column.write_out()

    def append_one(self, name: str, value: float, dtype: type = np.int64) -> int:
        """Add a single number."""
        return self.append(name, np.array([value], dtype=dtype))

    def link(self, name: str, target: str) -> None:
        """Let `name` be another name of the dataset `target`."""
        self.group[name] = self.group[target]
