"""Write the results of a run as it proceeds, in results.h5 (float64) and files for ParaView.

What results.h5 holds is declared in output/layout.py and described in docs/results.md. `/VTKHDF` in it is a link to
that of blocks.vtkhdf, for those who open results.h5 itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.certificate_record import Certificates
from dem_cli.core.records.frames import FRAME_ARRAYS, OPTIONAL_ARRAYS, STAGES, Frame, FrameStack, LinkRecord, stacked
from dem_cli.core.records.history_rows import Energy, HistoryRow, RunRow, Samples
from dem_cli.results.output.case_order import CaseOrder
from dem_cli.results.output.described_dataset import store_described
from dem_cli.results.output.equilibrium_monitors import EquilibriumMonitors
from dem_cli.results.output.folder import write_error
from dem_cli.results.output.growing_dataset import GrowingGroup
from dem_cli.results.output.hdf5_file import Hdf5File
from dem_cli.results.output.layout import CERTIFICATES, JOINT_PLACES, JOINT_STATES, LINKS, ROW_SCALARS, declared
from dem_cli.results.output.paraview.snapshot_files import BLOCKS, FollowedJoints, ParaViewFiles
from dem_cli.results.output.run_tables import TABLES, write_runs
from dem_cli.results.output.series import SeriesWriter
from dem_cli.results.output.skeleton import FRAMES_AT_ONCE, declare_model, fill_model, growing_parts, skeleton
from dem_cli.results.output.summary import write_summary

RESULTS, CASE, HISTORY_TABLE = "results.h5", "case.toml", "history.csv"
FRAME_SCALARS = ("step", "load", "displacement", "time")
_BUFFERED_ROWS = 4096
_BUFFERED_SAMPLES = 16_384
_UNFLUSHED = 30_000_000  # contact points × steps, a second or two of work
_OF_A_STEP = 15  # contact points that a step counts as, beside its own
_TEXT = h5py.string_dtype()
JointsOf = Callable[[Model], FollowedJoints]


class ResultWriter:
    """Writer of results: takes frames and history rows as they come; `close(summary)` completes the folder."""

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
        self.folder, self.monitors = Path(folder), tuple(monitors)
        self._take(model)
        self.name = name or self.folder  # what messages call it
        self._named = [(name, link.kind) for name, link in _links_of(model)]
        self.kind, self.quantities = kind, tuple(quantities) or ("displacement",) * len(self.monitors)
        self.last_row: HistoryRow | None = None
        self.last_frame: Frame | None = None
        self.n_frames = 0
        self._waiting: list[Frame] = []
        self._n_points = 2 * model.n_blocks  # contact points, as long as no frame has said it
        self._flushed_step = -_UNFLUSHED
        self._rows: list[HistoryRow] = []
        self._held = EquilibriumMonitors(self.monitors, self.quantities)
        self._files: list[Hdf5File] = []
        self._joints_of: JointsOf | None = None
        self._joints: FollowedJoints | None = None
        self._links: GrowingGroup | None = None
        self._joint_states: GrowingGroup | None = None
        self._vtk: ParaViewFiles | None = None
        self._series: SeriesWriter | None = None
        self._guarded(lambda: self._start(case_text, provenance))

    def _take(self, model: Model) -> None:
        """Set the structure of the frames to come, reordered as in the case."""
        self.drawn, self.order = model, CaseOrder(model)
        self.model = self.order.model(model)

    def _start(self, case_text: str, provenance: Mapping[str, str]) -> None:
        (self.folder / CASE).write_text(case_text, encoding="utf-8", newline="\n")
        scene = (self.monitors, self.quantities)
        self.dem = self._open(RESULTS, skeleton(self.model, self.kind, provenance, *scene))["dem"]
        self.dem["case"][()] = case_text
        fill_model(self.dem["model"], self.model)
        self._frames, self._contacts, self._history = growing_parts(self.dem, self.model.dimension, self.kind, *scene)
        self._flush()

    def follow(self, joints_of: JointsOf) -> None:
        """Store the state of every joint with each frame. joints_of: finds the joints of a structure."""
        self._joints_of = joints_of

    def _open(self, name: str, begun: bytes = b"") -> h5py.File:
        self._files.append(Hdf5File(self.folder / name, begun))
        return self._files[-1].hdf

    def frame(self, frame: Frame) -> None:
        """Store a snapshot; everything up to it is on disk when this returns.

        In a time history all of that waits until a second or two of work have come together.
        """
        self._guarded(lambda: self._frame(frame))

    def row(self, row: HistoryRow) -> None:
        """Store a row of the history; it goes to disk with the next frame, in a time history as frames do."""
        if len(row.monitors) != len(self.monitors):
            raise ValueError(f"{len(row.monitors)} monitor values for {len(self.monitors)} monitors")
        self._rows.append(row)
        self._held.row(row)
        self.last_row = row
        if len(self._rows) >= _BUFFERED_ROWS or (len(self._rows) > 1 and self._worked(row.step)):
            self._flushed_step = row.step
            self._guarded(self._flush)

    def samples(self, samples: Samples) -> None:
        """Store a stretch of a time history; it goes to disk as frames do, or when many wait."""
        if self._series is None:
            self._series = SeriesWriter(
                self.dem.create_group("series"), self.monitors, self.quantities, self.model.dimension
            )
        self._series.append(samples)
        if self._series.n_waiting >= _BUFFERED_SAMPLES:
            self._guarded(self._flush)

    def structure(self, model: Model) -> None:
        """Set another structure for the frames to come. Raises ValueError after the first frame."""
        if self.n_frames:
            raise ValueError("frames of another structure are kept already")
        self._take(model)  # of modes and limit analysis: frames of it have no links

        def store() -> None:
            del self.dem["model"]
            declare_model(self.dem.create_group("model"), self.model)
            fill_model(self.dem["model"], self.model)
            self._flush()

        self._guarded(store)

    def certificates(self, found: Certificates) -> None:
        """Write the certificates of a pushover."""
        said = declared(CERTIFICATES, self.model.dimension)

        def store() -> None:
            group = self.dem.create_group("certificates")
            for name, words in found.words.items():
                group.attrs[name] = words
            for name, values in self.order.certificates(found).stored().items():
                store_described(group, name, values, said[name])

        self._guarded(store)

    def runs(self, rows: Sequence[RunRow]) -> None:
        """Write the table of an analysis that consists of many runs."""
        name = TABLES.get(self.kind, TABLES["time-history"])
        self._guarded(lambda: write_runs(self.folder / name, rows, self.monitors))

    def measured(self, found: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """Return the monitor values of a summary: `peaks` of a time history, else `monitors` in the last
        equilibrium.
        """
        kept = (
            {"peaks": self._series.peaks(bool(found.get("impacts")))}
            if self._series
            else {"monitors": self._held.values(found)}
        )
        return {key: values for key, values in kept.items() if values}

    def close(self, summary: Mapping[str, Any]) -> None:
        """Complete the files and write summary.json, last of all."""

        def finish() -> None:
            self._store_frames()
            self._flush_rows()
            self._write_out()
            self._history.drop_unused()
            if self._series is not None:
                self._series.write_csv(self.folder / HISTORY_TABLE)
            self.dem.attrs["status"] = str(summary["status"])
            while self._files:
                self._files.pop().close()
            write_summary(self.folder, summary)

        self._guarded(finish)

    def abandon(self) -> None:
        """Close open files without completing them, whatever the disk says."""
        while self._files:
            self._files.pop().abandon()

    def _guarded(self, work: Callable[[], None]) -> None:
        try:
            work()
        except OSError as error:
            self.abandon()
            raise write_error(error, self.name) from None

    def _flush(self) -> None:
        self._store_frames()
        self._flush_rows()
        self._write_out()
        for file in self._files:
            file.flush()

    def _write_out(self) -> None:
        for each in (self._frames, self._contacts, self._history, self._joint_states, self._links, self._vtk):
            if each is not None:
                each.write_out()

    def _flush_rows(self) -> None:
        rows, self._rows = self._rows, []
        if rows:
            _store_rows(self._history, rows)
        if self._series is not None:
            self._series.flush()

    def _frame(self, frame: Frame) -> None:
        self._waiting.append(frame)
        self.n_frames += 1
        self.last_frame = frame
        self._n_points = len(frame.contacts.joint)
        if not kind_of(self.kind).timed or self._worked(frame.step):
            self._flushed_step = frame.step
            self._flush()

    def _worked(self, step: int) -> bool:
        """Test whether enough work has been done since the last write to be worth another.

        By steps and not by a clock: the same run leaves the same bytes.
        """
        work = abs(step - self._flushed_step) * (self._n_points + _OF_A_STEP)
        return kind_of(self.kind).timed and work >= _UNFLUSHED

    def _store_frames(self) -> None:
        """Write all buffered frames together."""
        if not self._waiting:
            return
        if self._vtk is None:
            self._begin_frames(self._waiting[0].links)
            assert self._vtk is not None
        stack, now = stacked(self._waiting), None
        first, n = self.n_frames - len(self._waiting), len(self._waiting)
        self._waiting.clear()
        if self._joints is not None and self._joint_states is not None:
            now = self._joints.at(stack.positions, stack.orientations, stack.contacts)
            for name, values in now.states._asdict().items():
                self._joint_states.append(name, values.reshape(n, -1))
        stack = self.order.stack(stack)
        self._keep(stack)
        self._vtk.add(stack.numbers("time") if kind_of(self.kind).timed else first + np.arange(float(n)), stack, now)

    def _begin_frames(self, links: LinkRecord | None) -> None:
        """Open the ParaView files, and store the constant data of joints and links."""
        joints = self._joints_of and self._joints_of(self.drawn)
        links = links and self.order.links(links)
        places = None
        if joints is not None and len(joints.places.area):
            self._joints, places = joints, self.order.joints(joints.places)
            group = self.dem.create_group("joints")
            said, states = (declared(table, self.model.dimension) for table in (JOINT_PLACES, JOINT_STATES))
            for name, values in places.stored().items():
                store_described(group, name, values, said[name])
            self._joint_states = GrowingGroup(group, states, FRAMES_AT_ONCE)
        if links is not None:
            group = self.dem.create_group("links")
            group.attrs.create("names", [name for name, _ in self._named], dtype=_TEXT)
            group.attrs.create("kinds", [kind for _, kind in self._named], dtype=_TEXT)
            said = declared(LINKS, self.model.dimension)
            for name, values in links.places._asdict().items():
                store_described(group, name, values, said[name])
            self._links = GrowingGroup(group, said, FRAMES_AT_ONCE)
        self._vtk = ParaViewFiles(self.model, places, self._open, links and links.places)
        self.dem.parent["VTKHDF"] = h5py.ExternalLink(BLOCKS, "/VTKHDF")

    def _keep(self, stack: FrameStack) -> None:
        """Store frames in results.h5."""
        frames, contacts, n = self._frames, self._contacts, len(stack.frames)
        for name, values in stack.own_contacts().stored().items():
            contacts.append(name, values)
        for name in FRAME_ARRAYS:
            frames.append(name, _by_frame(getattr(stack, name), n))
        for name in OPTIONAL_ARRAYS:
            if (values := getattr(stack, name)) is not None:
                frames.append(name, _by_frame(values, n))
        if self._links is not None:
            forces = [frame.links.forces for frame in stack.frames if frame.links is not None]
            self._links.append("forces", np.array(forces))
        frames.append("step", stack.numbers("step", np.int64))
        for name in FRAME_SCALARS[1:]:
            frames.append(name, stack.numbers(name))
        frames.append("stage", stack.numbers("stage", np.int8))
        frames.append("n_contacts", stack.n_points)  # last: it counts


def _by_frame(rows: np.ndarray, n_frames: int) -> np.ndarray:
    """Reshape rows of blocks frame by frame, (n_frames, n_blocks, ...)."""
    return rows.reshape(n_frames, -1, *rows.shape[1:])


def _links_of(model: Model) -> list[tuple[str, Any]]:
    """Return name and arrays of each tie and bar."""
    return list(zip(model.link_names, (link for link in model.links for _ in range(link.n_drawn)), strict=True))


def _store_rows(history: GrowingGroup, rows: Sequence[HistoryRow]) -> None:
    for name in ROW_SCALARS:
        kind = np.int64 if name == "step" else np.float64
        history.append(name, np.array([getattr(row, name) for row in rows], dtype=kind))
    for i, name in enumerate(Energy._fields):
        history.append(f"energy/{name}", np.array([row.energy[i] for row in rows], dtype=np.float64))
    if rows[0].monitors:
        history.append("monitor_values", np.array([row.monitors for row in rows], dtype=np.float64))
    history.append("stage", np.array([STAGES.index(row.stage) for row in rows], dtype=np.int8))  # last: it counts
