"""HDF5 datasets with attributes, copied from templates in memory, which is seven times faster than writing them.

A sweep writes the same thirty datasets with their hundred attributes in every run.
"""

from __future__ import annotations

import io
from functools import cache

import h5py
import numpy as np
from h5py import h5d, h5s

from dem_cli.results.output.layout import Described, describe


def described_dataset(
    group: h5py.Group, name: str, shape: tuple[int, ...], dtype: np.dtype, said: Described | None,
    chunks: tuple[int, ...] | None = None,
) -> h5py.Dataset:  # fmt: skip
    """Create a described dataset `name` (a path inside the group) of numbers.

    said: None for one without attributes. chunks: those of a dataset that grows along its first axis.
    """
    templates().copy(_template(shape, dtype, said, chunks), group, name)
    return h5py.Dataset(h5d.open(group.id, name.encode()))  # a third of the cost of group[name]


def store_described(group: h5py.Group, name: str, values: np.ndarray, said: Described) -> None:
    """Store an array of numbers as a dataset with its description."""
    values = np.ascontiguousarray(values)
    described_dataset(group, name, values.shape, values.dtype, said).id.write(h5s.ALL, h5s.ALL, values)


@cache
def templates() -> h5py.File:
    """Return the HDF5 file in memory that holds all templates of this process."""
    return h5py.File(io.BytesIO(), "w")


@cache
def _template(
    shape: tuple[int, ...], dtype: np.dtype, said: Described | None, chunks: tuple[int, ...] | None
) -> h5py.Dataset:
    """Create an empty template dataset of this kind."""
    grows = None if chunks is None else (None, *shape[1:])
    made = templates().create_dataset(f"{len(templates())}", shape, dtype, maxshape=grows, chunks=chunks)
    if said is not None:
        describe(made, said)
    return made
