"""Skeletons of results.h5: groups, attributes and empty datasets, made once for runs that differ in numbers alone.

A sweep would otherwise create the same thirty datasets with their hundred attributes in every run.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import h5py
import numpy as np
from h5py import h5d, h5s

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import SPATIAL_MODEL, WHERE_ASKED_FOR, Model
from dem_cli.core.records.frames import STAGES, STATES
from dem_cli.core.records.history_rows import MONITOR_UNITS, Energy
from dem_cli.results.output.described_dataset import described_dataset
from dem_cli.results.output.growing_dataset import GrowingGroup
from dem_cli.results.output.layout import (
    CONTACTS,
    DEM,
    ENERGY,
    FRAMES,
    HISTORY,
    MODEL,
    PER_STEP_FRAMES,
    RESULTS_FORMAT,
    ROW_SCALARS,
    Described,
    declared,
    describe,
)

FRAMES_AT_ONCE = 8  # that space is made for: few are kept
_TEXT = h5py.string_dtype()
_UNSAID = (  # of a model: the case file says them
    "aliases", "selections", "links", "link_names", "following", "ranks", "dead_first_moments", "live_first_moments"
)  # fmt: skip
_MOST_KEPT = 4
_images: dict[Any, bytes] = {}


class GrowingParts(NamedTuple):
    """Groups of results.h5 that grow during a run."""

    frames: GrowingGroup
    contacts: GrowingGroup
    history: GrowingGroup


def skeleton(
    model: Model, kind: str, provenance: Mapping[str, str], monitors: tuple[str, ...], quantities: tuple[str, ...]
) -> bytes:
    """Create the bytes of results.h5 of a run that has begun, with empty arrays of model and case."""
    sizes = tuple(
        (name, value.shape, value.dtype.str) if isinstance(value, np.ndarray) else (name, value)
        for name, value in _stored(model)
    )
    key = (sizes, kind, tuple(provenance.items()), monitors, quantities)
    if key not in _images:
        if len(_images) >= _MOST_KEPT:
            _images.clear()
        _images[key] = _image(model, kind, provenance, monitors, quantities)
    return _images[key]


def _image(
    model: Model, kind: str, provenance: Mapping[str, str], monitors: tuple[str, ...], quantities: tuple[str, ...]
) -> bytes:
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        dem = file.create_group("dem")
        dem.attrs["format"] = RESULTS_FORMAT
        dem.attrs["kind"] = kind
        dem.attrs["status"] = "running"
        dem.attrs["stages"], dem.attrs["states"] = list(STAGES), list(STATES)
        describe(dem.create_dataset("case", data="", dtype=_TEXT), DEM["case"])
        dem.create_group("provenance").attrs.update(provenance)
        declare_model(dem.create_group("model"), model)
        for name in ("frames", "contacts", "history"):
            dem.create_group(name)
        dem["history"].attrs.create("monitors", list(monitors), dtype=_TEXT)
        history = GrowingGroup(dem["history"], _said_of_history(monitors, quantities))
        for name, (shape, dtype) in _columns_of_history(len(monitors)).items():
            history.make(name, shape, np.dtype(dtype))
    return memory.getvalue()


def growing_parts(
    dem: h5py.Group, dimension: int, kind: str, monitors: tuple[str, ...], quantities: tuple[str, ...]
) -> GrowingParts:
    """Open the growing groups of a skeleton."""
    moving = FRAMES if kind_of(kind).timed else PER_STEP_FRAMES
    said = _said_of_history(monitors, quantities)
    return GrowingParts(
        GrowingGroup(dem["frames"], declared(moving, dimension), FRAMES_AT_ONCE),
        GrowingGroup(dem["contacts"], declared(CONTACTS, dimension)),
        GrowingGroup(dem["history"], said, made=_columns_of_history(len(monitors))),
    )


def _said_of_history(monitors: tuple[str, ...], quantities: tuple[str, ...]) -> dict[str, Described]:
    units = tuple(MONITOR_UNITS[quantity] for quantity in quantities)
    watched = HISTORY["monitor_values"]._replace(columns=monitors, units=units)
    return HISTORY | {"monitor_values": watched} | {f"energy/{name}": said for name, said in ENERGY.items()}


def _columns_of_history(n_monitors: int) -> dict[str, tuple[tuple[int, ...], type]]:
    """Return the shape of a row and type of each dataset of the history."""
    columns: dict[str, tuple[tuple[int, ...], type]] = dict.fromkeys(ROW_SCALARS, ((), np.float64))
    columns |= {f"energy/{name}": ((), np.float64) for name in Energy._fields}
    columns |= {"monitor_values": ((n_monitors,), np.float64)} if n_monitors else {}
    return columns | {"step": ((), np.int64), "stage": ((), np.int8)}


def _stored(model: Model) -> Iterator[tuple[str, Any]]:
    """Yield the stored arrays and numbers of a model, by name."""
    for name, value in model._asdict().items():
        if name not in _UNSAID and (name not in (*SPATIAL_MODEL, *WHERE_ASKED_FOR) or len(value)):
            yield name, value


def declare_model(group: h5py.Group, model: Model) -> None:
    """Create datasets and attributes for a model, without its values."""
    said = declared(MODEL, model.dimension)
    for name, value in _stored(model):
        if isinstance(value, int):
            group.attrs[name] = value
        elif isinstance(value, tuple):
            describe(group.create_dataset(name, data=list(value), dtype=_TEXT), said[name])
        else:
            described_dataset(group, name, value.shape, value.dtype, said[name])


def fill_model(group: h5py.Group, model: Model) -> None:
    """Write the arrays of a model to existing datasets."""
    for name, value in _stored(model):
        if isinstance(value, np.ndarray):
            h5d.open(group.id, name.encode()).write(h5s.ALL, h5s.ALL, np.ascontiguousarray(value))
