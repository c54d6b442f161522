"""Read results: `read(folder)` returns a run, or an error that names the missing or damaged part."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, overload

import h5py
import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import (
    FRAME_ARRAYS,
    OPTIONAL_ARRAYS,
    STAGES,
    ContactRecord,
    Frame,
    JointPlaces,
    JointStates,
    LinkPlaces,
    LinkRecord,
)
from dem_cli.core.records.history_rows import Energy
from dem_cli.errors import DamagedResults, UsageError
from dem_cli.input_limits import SUMMARY_BYTES, UnreadableInput, read_bounded
from dem_cli.results.output.folder import SUMMARY, require_folder
from dem_cli.results.output.integrity.stored_arrays import LaterArray, StoredArrays, check_size, of_hdf5
from dem_cli.results.output.layout import FRAMES, MODEL, NAMES, RESULTS_FORMAT, ROW_SCALARS, declared, units_of
from dem_cli.results.output.series import HistorySeries, read_series
from dem_cli.results.output.store import FRAME_SCALARS, RESULTS
from dem_cli.results.output.sweep_files import RUNS

Stored: TypeAlias = "np.ndarray | LaterArray"  # an array in memory, or one that is read in parts

LAZY = (*FRAME_ARRAYS, *OPTIONAL_ARRAYS)  # of frames: read on access


@dataclass(frozen=True)
class Results:
    """Results of a finished or interrupted run; a killed one is read up to its last frame."""

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
    """Joints as drawn with their states frame by frame."""

    places: JointPlaces
    states: JointStates  # in memory or datasets of a file that is open, (n_frames, n_joints) each

    def at(self, frame: int) -> JointStates:
        """Return the joint states of one frame, by its number."""
        return JointStates(*(values[frame] for values in self.states))


class Frames(Sequence[Frame]):
    """Sequence of all frames of a run, in memory or read from an open file."""

    def __init__(
        self, columns: dict[str, Stored], contacts: dict[str, Stored], links: LinkRecord | None = None
    ):  # links: with forces of all frames
        self._columns, self._contacts, self._links = columns, contacts, links
        counts = np.asarray(columns["n_contacts"][:] if "n_contacts" in columns else (), np.int64)
        self._starts = np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])

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
            **{name: columns[name][i] if name in columns else None for name in OPTIONAL_ARRAYS},
            links=self._links and self._links._replace(forces=self._links.forces[i]),
        )

    def __iter__(self) -> Iterator[Frame]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} frames>"


def read(folder: Path | str, *, lazy: bool = False) -> Results:
    """Read the results in `folder`; UsageError where there are none, DamagedResults where they are damaged.

    lazy: frames are read on access, from a file that the caller closes by `Results.source`.
    """
    folder = Path(folder)
    require_folder(folder)
    if not (folder / RESULTS).is_file():
        runs = sorted(path.parent for path in folder.glob(f"{RUNS}/*/{RESULTS}"))
        hint = f"; each run of this sweep has its own, such as {runs[0]}" if runs else ""
        raise UsageError(f"{folder}: holds no results of dem run (no {RESULTS}){hint}")
    summary = read_summary(folder)
    try:
        with ExitStack() as stack:
            if not lazy:
                file = stack.enter_context(_opened(folder / RESULTS))
                return _read(_arrays(file, folder), summary, None)
            stream = stack.enter_context((folder / RESULTS).open("rb"))  # others may open the path as they like
            file = stack.enter_context(_opened(stream))
            return replace(_read(_arrays(file, folder), summary, folder), source=stack.pop_all())
    except DamagedResults as error:
        raise DamagedResults(error.damage, folder) from None
    except Exception as error:
        if not of_hdf5(error):
            raise
        raise DamagedResults(f"{RESULTS} cannot be read ({_reason(error)})", folder) from None


def read_summary(folder: Path) -> dict[str, Any]:
    """Read summary.json; {} where there is none. Raises DamagedResults."""
    path = folder / SUMMARY
    if not path.exists():
        return {}
    try:
        found = json.loads(read_bounded(path, SUMMARY_BYTES).decode("utf-8"), parse_constant=_no_number)
    except UnreadableInput as error:
        raise UsageError(f"{path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise DamagedResults(f"{SUMMARY} is not valid JSON ({_reason(error)})", folder) from None
    from dem_cli.results.output.integrity.summary_checks import check_summary

    try:
        return check_summary(found)
    except DamagedResults as error:
        raise DamagedResults(error.damage, folder) from None


def _no_number(name: str) -> Any:
    raise ValueError(f"{name} is no number of JSON")


def _reason(error: Exception) -> str:
    """Return the first line of a library's error message, without its punctuation."""
    return (str(error).strip("'\"").splitlines() or [type(error).__name__])[0]


def _opened(file: Path | Any) -> h5py.File:
    """Open an HDF5 file. Raises DamagedResults where a file is not HDF5, or is not whole."""
    try:
        return h5py.File(file, "r", locking=False) if isinstance(file, Path) else h5py.File(file, "r")
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise DamagedResults(f"{RESULTS} is not a whole file of HDF5 ({_reason(error)})") from None


def _arrays(file: h5py.File, folder: Path) -> StoredArrays:
    """Open the checked arrays of a file. Raises DamagedResults, and UsageError for another format."""
    check_size(file, folder / RESULTS)
    dem = file.get("dem")
    found = dem.attrs.get("format") if isinstance(dem, h5py.Group) else None
    if isinstance(found, (int, np.integer)) and found != RESULTS_FORMAT:
        raise UsageError(f"{folder}: results written in format {found}; this version of dem reads {RESULTS_FORMAT}")
    return StoredArrays(file)


def _read(arrays: StoredArrays, summary: dict[str, Any], lazy: Path | None) -> Results:
    """Read the results. lazy: the folder of results whose frames are read later."""
    dem = arrays.dem
    history = dem["history"]
    n_rows = len(history["stage"]) if "stage" in history else 0
    columns = {name: arrays.array(f"/dem/history/{name}", n_rows) for name in ROW_SCALARS if name in history}
    columns["stage"] = np.array(STAGES)[arrays.array("/dem/history/stage")] if n_rows else np.zeros(0, dtype=str)
    ledger = history.get("energy", ())
    energy = {name: arrays.array(f"/dem/history/energy/{name}", n_rows) for name in Energy._fields if name in ledger}
    names = [str(name) for name in history.attrs["monitors"]]
    values = arrays.array("/dem/history/monitor_values", n_rows) if n_rows and names else np.zeros((0, len(names)))
    monitors = {name: values[:, i] for i, name in enumerate(names)}
    model = _read_model(arrays)
    found = Results(
        summary=summary,
        model=model,
        frames=_read_frames(arrays, lazy),
        history=columns,
        energy=energy,
        monitors=monitors,
        case_text=str(arrays.text("/dem/case")),
        provenance={name: str(value) for name, value in dem["provenance"].attrs.items()},
        status=str(dem.attrs["status"]),
        kind=str(dem.attrs["kind"]),
        series=read_series(dem["series"], model.dimension) if "series" in dem else None,
        joints=_read_joints(arrays, lazy) if "joints" in dem else None,
    )
    _check_agreement(found)
    return found


def _check_agreement(found: Results) -> None:
    """Raise DamagedResults where summary.json belongs to another run than the arrays."""
    kind, modes = found.summary.get("kind", found.kind), found.summary.get("frequencies") or ()
    if kind != found.kind:
        raise DamagedResults(f"{SUMMARY} is of kind {kind!r}, {RESULTS} of kind {found.kind!r}")
    if found.kind == "modes" and found.summary:
        wrong = [frame.step for frame in found.frames if frame.stage == "mode" and not 1 <= frame.step <= len(modes)]
        if wrong:
            raise DamagedResults(f"{SUMMARY} has {len(modes)} frequencies, /dem/frames/step has mode {wrong[0]}")


def _read_frames(arrays: StoredArrays, lazy: Path | None) -> Frames:
    group = arrays.dem["frames"]
    if "n_contacts" not in group:
        return Frames({}, {})
    n_frames = len(group["n_contacts"])
    names = (*FRAME_SCALARS, *FRAME_ARRAYS, *OPTIONAL_ARRAYS, "stage", "n_contacts")

    def held(path: str, later: bool, rows: int | None = None) -> Stored:
        return LaterArray(arrays, path, lazy) if lazy is not None and later else arrays.array(path, rows)

    columns = {name: held(f"/dem/frames/{name}", name in LAZY, n_frames) for name in names if name in group}
    columns.setdefault("time", np.zeros(n_frames))  # results of earlier versions
    links = None
    if "forces" in arrays.dem.get("links", ()):
        places = LinkPlaces(*(arrays.array(f"/dem/links/{name}") for name in LinkPlaces._fields))
        links = LinkRecord(places, arrays.array("/dem/links/forces"))
    contacts = {name: held(f"/dem/contacts/{name}", True) for name in ContactRecord._fields if name in
                arrays.dem["contacts"]}  # fmt: skip
    return Frames(columns, contacts, links)


def _read_joints(arrays: StoredArrays, lazy: Path | None) -> JointHistory | None:
    group = arrays.dem["joints"]
    if "state" not in group:  # of a run that was killed before its first frame
        return None
    states: list[Any] = [
        arrays.array(f"/dem/joints/{name}") if lazy is None else LaterArray(arrays, f"/dem/joints/{name}", lazy)
        for name in JointStates._fields
    ]
    places = {name: arrays.array(f"/dem/joints/{name}") for name in JointPlaces._fields if name in group}
    return JointHistory(JointPlaces(**places), JointStates(*states))


def _read_model(arrays: StoredArrays) -> Model:
    group = arrays.dem["model"]
    values: dict[str, Any] = {"dimension": arrays.dimension}
    for name in group:
        if name in MODEL:
            found = arrays.array(f"/dem/model/{name}")
            values[name] = tuple(found) if MODEL[name].kind == NAMES else found
    return Model(**values)
