"""Reader of results: `read(folder)` gives back what a run left."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, overload

import h5py
import numpy as np

from dem_cli.errors import UsageError
from dem_cli.model.model import Model
from dem_cli.output.folder import SUMMARY
from dem_cli.output.layout import FRAMES, RESULTS_FORMAT, ROW_SCALARS, declared, units_of
from dem_cli.output.record import STAGES, ContactRecord, Energy, Frame, JointPlaces, JointStates, LinkPlaces, LinkRecord
from dem_cli.output.series import HistorySeries, read_series
from dem_cli.output.store import FRAME_ARRAYS, FRAME_SCALARS, RESULTS

Stored: TypeAlias = "np.ndarray | Any"  # an array in memory, or an h5py.Dataset

LAZY = (*FRAME_ARRAYS, "stresses")  # of frames: read when they are asked for


@dataclass(frozen=True)
class Results:
    """A finished or interrupted run; a killed one reads up to its last frame."""

    summary: dict[str, Any]  # {} where a killed run left none
    model: Model
    frames: Frames  # a sequence of Frame, in the order in which they came
    history: dict[
        str, np.ndarray
    ]  # "stage" (names), "step", "load", "displacement", "unbalanced", "overlap", "time", ...
    energy: dict[str, np.ndarray]  # [J], one value per history row, by the names of Energy
    monitors: dict[str, np.ndarray]  # one value per history row, by monitor name
    case_text: str
    provenance: dict[str, str]
    status: str
    kind: str
    series: HistorySeries | None  # of a time history
    joints: JointHistory | None = None  # None: results without frames, or of earlier versions
    source: ExitStack | None = None  # holds open the file that frames are read from; None: they are in memory


class JointHistory(NamedTuple):
    """The joints as they were drawn, and their states frame by frame."""

    places: JointPlaces
    states: JointStates  # in memory or datasets of a file that is open, (n_frames, n_joints) each

    def at(self, frame: int) -> JointStates:
        """Of one frame, by its number."""
        return JointStates(*(values[frame] for values in self.states))


class Frames(Sequence[Frame]):
    """All frames of a run, handed out one by one; their arrays are in memory, or datasets of a file that is open."""

    def __init__(
        self, columns: dict[str, Stored], contacts: dict[str, Stored], links: LinkRecord | None = None
    ):  # links: with forces of all frames
        self._columns, self._contacts, self._links = columns, contacts, links
        self._starts = np.concatenate(([0], np.cumsum(columns.get("n_contacts", np.zeros(0, dtype=np.int64)))))

    def __len__(self) -> int:
        return len(self._starts) - 1

    @property
    def units(self) -> dict[str, str]:
        """Units of the fields of a frame that have one."""
        d = self._columns["positions"].shape[-1] if len(self) else 2
        return units_of(declared(FRAMES, d))

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> list[Frame]: ...
    def __getitem__(self, index: int | slice) -> Frame | list[Frame]:
        if isinstance(index, slice):
            return [self[i] for i in range(len(self))[index]]
        i = range(len(self))[index]
        rows = slice(self._starts[i], self._starts[i + 1])
        contacts = ContactRecord(**{name: values[rows] for name, values in self._contacts.items()})
        columns = self._columns
        return Frame(
            stage=STAGES[columns["stage"][i]],
            step=int(columns["step"][i]),
            load=float(columns["load"][i]),
            displacement=float(columns["displacement"][i]),
            positions=columns["positions"][i],
            orientations=columns["orientations"][i],
            velocities=columns["velocities"][i],
            contacts=contacts,
            time=float(columns["time"][i]),
            stresses=columns["stresses"][i] if "stresses" in columns else None,
            links=self._links and self._links._replace(forces=self._links.forces[i]),
        )

    def __iter__(self) -> Iterator[Frame]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} frames>"


def read(folder: Path | str, *, lazy: bool = False) -> Results:
    """The results in `folder`; UsageError where there are none.

    lazy: frames are read when they are asked for, from a file that the caller closes by `Results.source`.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise UsageError(f"{folder}: no such folder")
    if not (folder / RESULTS).is_file():
        raise UsageError(f"{folder}: holds no results of dem run (no {RESULTS})")
    try:
        with ExitStack() as stack:
            if not lazy:
                file = stack.enter_context(h5py.File(folder / RESULTS, "r", locking=False))
                return _read(file["dem"], read_summary(folder), lazy)
            stream = stack.enter_context((folder / RESULTS).open("rb"))  # others may open the path as they like
            file = stack.enter_context(h5py.File(stream, "r"))
            return replace(_read(file["dem"], read_summary(folder), lazy), source=stack.pop_all())
    except (OSError, KeyError) as error:
        raise UsageError(f"{folder / RESULTS}: not a readable result of dem run ({error})") from None


def read_summary(folder: Path) -> dict[str, Any]:
    """What summary.json says; {} where there is none. Raises UsageError."""
    path = folder / SUMMARY
    if not path.is_file():
        return {}
    try:
        summary: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise UsageError(f"{path}: not valid JSON ({error})") from None
    return summary


def _read(dem: h5py.Group, summary: dict[str, Any], lazy: bool) -> Results:
    if dem.attrs["format"] != RESULTS_FORMAT:
        raise UsageError(f"results written in format {dem.attrs['format']}; this version of dem reads {RESULTS_FORMAT}")
    history = dem["history"]
    n_rows = len(history["stage"]) if "stage" in history else 0
    columns = {name: history[name][:n_rows] for name in ROW_SCALARS if name in history}
    columns["stage"] = np.array(STAGES)[history["stage"][:]] if n_rows else np.zeros(0, dtype=str)
    energy = {name: history["energy"][name][:n_rows] for name in Energy._fields if name in history.get("energy", ())}
    monitors = {
        str(name): history["monitor_values"][:n_rows, i] if n_rows else np.zeros(0)
        for i, name in enumerate(history.attrs["monitors"])
    }
    model = _read_model(dem["model"])
    return Results(
        summary=summary,
        model=model,
        frames=_read_frames(dem, lazy),
        history=columns,
        energy=energy,
        monitors=monitors,
        case_text=dem["case"].asstr()[()],
        provenance={name: str(value) for name, value in dem["provenance"].attrs.items()},
        status=str(dem.attrs["status"]),
        kind=str(dem.attrs["kind"]),
        series=read_series(dem["series"], model.dimension) if "series" in dem else None,
        joints=_read_joints(dem["joints"], lazy) if "joints" in dem else None,
    )


def _read_frames(dem: h5py.Group, lazy: bool) -> Frames:
    group = dem["frames"]
    if "n_contacts" not in group:
        return Frames({}, {})
    n_frames = len(group["n_contacts"])
    names = (*FRAME_SCALARS, *FRAME_ARRAYS, "stresses", "stage", "n_contacts")
    held = {name: group[name] for name in names if name in group}
    columns = {name: data if lazy and name in LAZY else data[:n_frames] for name, data in held.items()}
    columns.setdefault("time", np.zeros(n_frames))  # results of earlier versions
    contacts, links = dem["contacts"], None
    if "forces" in dem.get("links", ()):
        held = dem["links"]
        links = LinkRecord(LinkPlaces(*(held[name][:] for name in LinkPlaces._fields)), held["forces"][:])
    return Frames(columns, {name: data if lazy else data[:] for name, data in contacts.items()}, links)


def _read_joints(group: h5py.Group, lazy: bool) -> JointHistory:
    states = [group[name] for name in JointStates._fields]
    places = JointPlaces(**{name: group[name][:] for name in JointPlaces._fields if name in group})
    return JointHistory(places, JointStates(*(states if lazy else [data[:] for data in states])))


def _read_model(group: h5py.Group) -> Model:
    values: dict[str, Any] = {name: int(value) for name, value in group.attrs.items()}
    for name, data in group.items():
        values[name] = tuple(data.asstr()[:]) if data.dtype.kind == "O" else data[:]
    return Model(**values)
