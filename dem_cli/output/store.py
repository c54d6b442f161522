"""Result writer: a run on disk as it goes, in results.h5 (blocks, histories, everything) and contacts.vtkhdf.

results.h5 holds `/VTKHDF` (float32, what ParaView shows) beside `/dem` (float64, what `reader.read` returns):

    /dem             attributes: format, status ("running" until closed)
    /dem/case        the effective case, text
    /dem/provenance  attributes: versions
    /dem/model       the arrays of Model
    /dem/frames      one row per frame; n_contacts says how many rows of /dem/contacts belong to it
    /dem/contacts    the contact points of all frames, one after the other
    /dem/history     one row per HistoryRow, with energy/ and monitors (names in its attribute)
    /dem/series      of time histories: base motion and monitors at an even rate (output/series.py)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from dem_cli.geometry.rotation import across, angles_of
from dem_cli.model.model import Model
from dem_cli.output.equilibrium_monitors import EquilibriumMonitors
from dem_cli.output.folder import write_error
from dem_cli.output.growing_dataset import GrowingGroup
from dem_cli.output.hdf5_file import Hdf5File
from dem_cli.output.record import STAGES, STATES, ContactRecord, Energy, Frame, HistoryRow, RunRow, Samples
from dem_cli.output.run_tables import TABLES, write_runs
from dem_cli.output.series import SeriesWriter
from dem_cli.output.summary import write_summary
from dem_cli.output.vertices import in_space, placed_vertices, rest_vertices, vertex_velocities
from dem_cli.output.vtkhdf import GridSeries, PointSeries

RESULTS_FORMAT = 1
RESULTS, CONTACTS, CASE, HISTORY = "results.h5", "contacts.vtkhdf", "case.toml", "history.csv"
ROW_SCALARS = ("step", "load", "displacement", "unbalanced", "overlap", "time")
FRAME_SCALARS = ("step", "load", "displacement", "time")
IN_SECONDS = frozenset(("time-history",))  # kinds whose frames ParaView counts in seconds; others by their number
FRAME_ARRAYS = ("positions", "orientations", "velocities")
_VTK_POLYGON = 7
_BUFFERED_ROWS = 4096
_BUFFERED_SAMPLES = 1024
_TEXT = h5py.string_dtype()
_UNSAID = ("aliases",)  # of a model: the case file says them


class ResultWriter:
    """Writer of results: give it frames and history rows as they come; `close(summary)` completes the folder."""

    def __init__(
        self,
        folder: Path,
        model: Model,
        case_text: str,
        provenance: Mapping[str, str],
        monitors: Sequence[str] = (),
        kind: str = "pushover",
        name: Path | None = None,
        quantities: Sequence[str] = (),
    ):
        self.folder, self.model, self.monitors = Path(folder), model, tuple(monitors)
        self.name = name or self.folder  # what messages call it
        self.kind, self.quantities = kind, tuple(quantities) or ("displacement",) * len(self.monitors)
        self.last_row: HistoryRow | None = None
        self.last_frame: Frame | None = None
        self.n_frames = 0
        self._rows: list[HistoryRow] = []
        self._held = EquilibriumMonitors(self.monitors, self.quantities)
        self._files: list[Hdf5File] = []
        self._vtk: tuple[GridSeries, PointSeries] | None = None
        self._series: SeriesWriter | None = None
        self._rest = rest_vertices(model)
        self._guarded(lambda: self._start(case_text, provenance))

    def _start(self, case_text: str, provenance: Mapping[str, str]) -> None:
        (self.folder / CASE).write_text(case_text, encoding="utf-8", newline="\n")
        file = self._open(RESULTS)
        self.dem = dem = file.create_group("dem")
        dem.attrs["format"] = RESULTS_FORMAT
        dem.attrs["kind"] = self.kind
        dem.attrs["status"] = "running"
        dem.attrs["stages"], dem.attrs["states"] = list(STAGES), list(STATES)
        dem.create_dataset("case", data=case_text, dtype=_TEXT)
        dem.create_group("provenance").attrs.update(provenance)
        _store_model(dem.create_group("model"), self.model)
        self._frames, self._contacts, self._history = (
            GrowingGroup(dem.create_group(name)) for name in ("frames", "contacts", "history")
        )
        dem["history"].attrs.create("monitors", list(self.monitors), dtype=_TEXT)
        self._flush()

    def _open(self, name: str) -> h5py.File:
        self._files.append(Hdf5File(self.folder / name))
        return self._files[-1].hdf

    def frame(self, frame: Frame) -> None:
        """Keep a snapshot; everything up to it is on disk when this returns."""
        self._guarded(lambda: self._frame(frame))
        self.last_frame = frame

    def row(self, row: HistoryRow) -> None:
        """Keep a row of the history; it goes to disk with the next frame."""
        if len(row.monitors) != len(self.monitors):
            raise ValueError(f"{len(row.monitors)} monitor values for {len(self.monitors)} monitors")
        self._rows.append(row)
        self._held.row(row)
        self.last_row = row
        if len(self._rows) >= _BUFFERED_ROWS:
            self._guarded(self._flush)

    def samples(self, samples: Samples) -> None:
        """Keep a stretch of a time history; it goes to disk with the next frame, or when many wait."""
        if self._series is None:
            self._series = SeriesWriter(self.dem.create_group("series"), self.monitors, self.quantities)
        self._series.append(samples)
        if self._series.n_waiting >= _BUFFERED_SAMPLES:
            self._guarded(self._flush)

    def structure(self, model: Model) -> None:
        """Frames to come are of this structure, not of that of the case. Raises ValueError after the first frame."""
        if self.n_frames:
            raise ValueError("frames of another structure are kept already")
        self.model, self._rest = model, rest_vertices(model)

        def store() -> None:
            del self.dem["model"]
            _store_model(self.dem.create_group("model"), model)
            self._flush()

        self._guarded(store)

    def runs(self, rows: Sequence[RunRow]) -> None:
        """Keep the table of an analysis that consists of many runs."""
        name = TABLES.get(self.kind, TABLES["time-history"])
        self._guarded(lambda: write_runs(self.folder / name, rows, self.monitors))

    def measured(self, found: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """What a summary says of the monitors: `peaks` of a time history, else `monitors` in the last equilibrium."""
        kept = {"peaks": self._series.peaks()} if self._series else {"monitors": self._held.values(found)}
        return {key: values for key, values in kept.items() if values}

    def close(self, summary: Mapping[str, Any]) -> None:
        """Complete the files and write summary.json, last of all."""

        def finish() -> None:
            self._flush_rows()
            if self._series is not None:
                self._series.write_csv(self.folder / HISTORY)
            self.dem.attrs["status"] = str(summary["status"])
            while self._files:
                self._files.pop().close()
            write_summary(self.folder, summary)

        self._guarded(finish)

    def abandon(self) -> None:
        """Close what is open without completing it, whatever the disk says."""
        while self._files:
            self._files.pop().abandon()

    def _guarded(self, work: Callable[[], None]) -> None:
        try:
            work()
        except OSError as error:
            self.abandon()
            raise write_error(error, self.name) from None

    def _flush(self) -> None:
        self._flush_rows()
        for file in self._files:
            file.flush()

    def _flush_rows(self) -> None:
        rows, self._rows = self._rows, []
        if rows:
            _store_rows(self._history, rows)
        if self._series is not None:
            self._series.flush()

    def _frame(self, frame: Frame) -> None:
        self._store_frame(frame)
        if self._vtk is None:
            self._vtk = self._start_vtk()
        grid, points = self._vtk
        vertices = placed_vertices(self.model, frame.positions, frame.orientations)
        velocities = vertex_velocities(self.model, vertices, frame.positions, frame.velocities)
        step_fields = {
            "load_multiplier": float(frame.load),
            "control_displacement": float(frame.displacement),
            "stage": STAGES.index(frame.stage),
            "step": int(frame.step),
            "time": float(frame.time),
        }
        moved = in_space(vertices - self._rest)
        cell_fields = {"rotation": angles_of(frame.orientations)[self.model.part_blocks].astype(np.float32)}
        value = float(frame.time if self.kind in IN_SECONDS else self.n_frames)
        fields = {"displacement": moved, "velocity": in_space(velocities)}
        grid.add(value, in_space(vertices), fields, cell_fields, step_fields)
        points.add(value, in_space(frame.contacts.points), contact_fields(frame.contacts), step_fields)
        self.n_frames += 1
        self._flush()

    def _start_vtk(self) -> tuple[GridSeries, PointSeries]:
        cells = block_fields(self.model)
        grid = GridSeries(self._files[0].hdf, self.model.part_starts, _VTK_POLYGON, cells)
        return grid, PointSeries(self._open(CONTACTS))

    def _store_frame(self, frame: Frame) -> None:
        frames, contacts = self._frames, self._contacts
        for name, values in frame.contacts._asdict().items():
            contacts.append(name, values)
        for name in FRAME_ARRAYS:
            frames.append(name, getattr(frame, name)[np.newaxis])
        frames.append_one("step", frame.step)
        for name in FRAME_SCALARS[1:]:
            frames.append_one(name, getattr(frame, name), np.float64)
        frames.append_one("stage", STAGES.index(frame.stage), np.int8)
        frames.append_one("n_contacts", len(frame.contacts.joint))  # last: it counts


def _store_model(group: h5py.Group, model: Model) -> None:
    for name, value in model._asdict().items():
        if name in _UNSAID:
            continue
        if isinstance(value, int):
            group.attrs[name] = value
        elif isinstance(value, tuple):
            group.create_dataset(name, data=list(value), dtype=_TEXT)
        else:
            group.create_dataset(name, data=value)


def _store_rows(history: GrowingGroup, rows: Sequence[HistoryRow]) -> None:
    for name in ROW_SCALARS:
        kind = np.int64 if name == "step" else np.float64
        history.append(name, np.array([getattr(row, name) for row in rows], dtype=kind))
    for i, name in enumerate(Energy._fields):
        history.append(f"energy/{name}", np.array([row.energy[i] for row in rows], dtype=np.float64))
    if rows[0].monitors:
        history.append("monitor_values", np.array([row.monitors for row in rows], dtype=np.float64))
    history.append("stage", np.array([STAGES.index(row.stage) for row in rows], dtype=np.int8))  # last: it counts


def contact_forces(contacts: ContactRecord) -> np.ndarray:
    """Force of each contact point on its second block [N], (n, d)."""
    normals = contacts.normals
    forces = contacts.normal_force[:, np.newaxis] * normals
    if normals.shape[1] == 2:
        tangents = across(normals)
        forces = forces + contacts.shear_force * tangents
    return forces


def block_fields(model: Model) -> dict[str, np.ndarray]:
    """What ParaView shows on the blocks, the same at all times; a value per convex part."""
    parts = model.part_blocks
    return {
        "block_id": parts.astype(np.int32),
        "material": model.block_material[parts].astype(np.int32),
        "fixed": model.fixed[parts].astype(np.uint8),
    }


def contact_fields(contacts: ContactRecord) -> dict[str, np.ndarray]:
    """What ParaView shows at the contact points."""
    shear = contacts.shear_force
    return {
        "joint": contacts.joint.astype(np.int32),
        "block_a": contacts.blocks[:, 0].astype(np.int32),
        "block_b": contacts.blocks[:, 1].astype(np.int32),
        "normal": in_space(contacts.normals),
        "force": in_space(contact_forces(contacts)),
        "normal_force": contacts.normal_force.astype(np.float32),
        "shear_force": (shear[:, 0] if shear.shape[1] == 1 else np.linalg.norm(shear, axis=1)).astype(np.float32),
        "gap": contacts.gap.astype(np.float32),
        "slip": contacts.slip.astype(np.float32),
        "state": contacts.state.astype(np.uint8),
    }
