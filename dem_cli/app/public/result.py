"""Results of a run in Python: summary, histories, frames, contact forces, monitors, with units."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Mapping
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from dem_cli.app.public.arrays import ArrayTable, MonitorHistory, NamedRecords
from dem_cli.case.reader import parse_toml
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import OUTLINE, STATES, Frame
from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.errors import SolverError, UsageError
from dem_cli.results.output.layout import CONTACTS, JOINT_PLACES, JOINT_STATES, declared, units_of
from dem_cli.results.output.paraview.vertices import placed_vertices
from dem_cli.results.output.reader import Frames, Results, read
from dem_cli.results.post.labels import KNOWN_QUANTITIES
from dem_cli.results.post.run_columns import tables as columns_of


class Result:
    """Results of a run. `dem_cli.run` and `dem_cli.open` create it; a `with` block, or `close()`, ends it.

    Frames are read from the file on access; all else stays in memory after its first use. Closing releases the file,
    and deletes the results of a run that keeps none (`out=None`).
    """

    def __init__(self, folder: Path, temporary: Path | None = None):
        self._results = read(folder, lazy=True)
        self._path = folder.resolve()
        self._closed = False
        self._release = weakref.finalize(self, release, self._results.source or ExitStack(), temporary)

    @property
    def path(self) -> Path:
        """Folder of the results; of a run that keeps none it is gone with the Result."""
        return self._path

    @property
    def summary(self) -> dict[str, Any]:
        """Answer and how it was obtained, as in summary.json; {} of a run that was killed."""
        return self._results.summary

    @property
    def status(self) -> str:
        """Status of the run: "ok", "not converged", "interrupted", "running" of one that was killed, ..."""
        return self._results.status

    @property
    def exit_code(self) -> int:
        """Exit code of `dem run`: 0 solved, 1 outside a reference or does not stand, 3 gave up, 130 interrupted.

        Of a run that was killed 3.
        """
        from dem_cli.results.output.summary import exit_code

        return exit_code(self.summary) if self.summary else SolverError.exit_code

    @property
    def kind(self) -> str:
        """Kind of the analysis: "pushover", "time-history", ..."""
        return self._results.kind

    @property
    def failure_load(self) -> float | None:
        """Failure load multiplier of a pushover; None where none was found or sought."""
        load: float | None = self.summary.get("failure_load")
        return load

    @property
    def case(self) -> str:
        """Effective case as text: defaults filled in, overrides applied. Running it gives the same."""
        return self._results.case_text

    @property
    def provenance(self) -> dict[str, str]:
        """Versions of the software that computed the results, by name."""
        return self._results.provenance

    @property
    def model(self) -> Model:
        """Structure as arrays: names, masses, places and corners of the blocks."""
        return self._results.model

    @cached_property
    def history(self) -> ArrayTable:
        """History with one row per state that the solver reported: "stage", "step", "load", "displacement", "time",
        ...
        """
        return ArrayTable({name: unit_of(name) for name in self._results.history}, self._results.history.__getitem__)

    @cached_property
    def energy(self) -> ArrayTable:
        """Energy balance [J], one value per row of `history`."""
        return ArrayTable(dict.fromkeys(self._results.energy, "J"), self._results.energy.__getitem__)

    @cached_property
    def tables(self) -> Mapping[str, ArrayTable]:
        """Tables that `dem plot` draws from, by title: "history", "time history", "response spectra", ..."""
        return NamedRecords({
            table.title: ArrayTable({name: q.unit for name, q in table.quantities.items()}, table.values)
            for table in columns_of(self._results)
        })  # fmt: skip

    @cached_property
    def monitors(self) -> Mapping[str, MonitorHistory]:
        """Histories of the [[monitor]] tables of the case, by name."""
        names, asked = list(self._results.monitors), parse_toml(self._path, self.case).get("monitor", ())
        tables = asked if len(asked) == len(names) else [{}] * len(names)
        return NamedRecords({name: monitor_history(self._results, name, t) for name, t in zip(names, tables)})

    @property
    def frames(self) -> Frames:
        """Snapshots as a sequence: `frames[-1].positions` [m]; `frames.units` has the units. Raises UsageError."""
        self._check_open()
        return self._results.frames

    def contacts(self, frame: int | Frame = -1) -> ArrayTable:
        """Return all contact points at a frame (by default the last): "blocks", "points", "normal_force", "gap", ...

        Forces are those on the second block, compression positive; "force" is the vector. Raises UsageError.
        """
        record = self.frame(frame).contacts
        columns = record.stored() | {"state": np.array(STATES)[record.state], "force": record.forces()}
        units = units_of(declared(CONTACTS, self.model.dimension)) | {"force": "N"}
        return ArrayTable({name: units.get(name, "") for name in columns}, columns.__getitem__)

    def joints(self, frame: int = -1) -> ArrayTable:
        """Return the joints as drawn, at a frame by its number (by default the last).

        "blocks", "ends", "length", "area", and what became of them: "opening", "crack_width", "slip",
        "normal_stress" (compression positive), "shear_stress", "eccentricity", "state". Raises UsageError.
        """
        self.frame(frame)
        found = self._results.joints
        if found is None:
            raise UsageError(f"{self._path}: these results have no joints; an earlier version wrote them")
        states = found.at(frame % len(self.frames))
        places = {name: values for name, values in found.places._asdict().items() if name not in OUTLINE}
        columns = places | states._asdict() | {"state": np.array(STATES)[states.state]}
        units = units_of(declared(JOINT_PLACES | JOINT_STATES, self.model.dimension))
        return ArrayTable({name: units.get(name, "") for name in columns}, columns.__getitem__)

    def corners(self, frame: int | Frame = -1) -> list[np.ndarray]:
        """Return the corners in space [m] of each convex part at a frame (by default the last), (n_corners, d) each.

        Part p belongs to the block `model.part_blocks[p]`. Raises UsageError.
        """
        shot = self.frame(frame)
        placed = placed_vertices(self.model, shot.positions, shot.orientations)
        return np.split(placed, self.model.part_starts[1:-1])

    def frame(self, frame: int | Frame = -1) -> Frame:
        """Return a frame by its number, negative from the end. Raises UsageError where there is none."""
        if isinstance(frame, Frame):
            return frame
        try:
            return self.frames[frame]
        except IndexError:
            raise UsageError(f"frame {frame}: these results have {len(self.frames)} frames") from None

    def close(self) -> None:
        """Close the file, and delete results that are not kept; harmless when repeated."""
        self._closed = True
        self._release()

    @property
    def closed(self) -> bool:
        """Tell whether `close` was called."""
        return self._closed

    def _check_open(self) -> None:
        if self._closed:
            raise UsageError(f"the results of {self._path} are closed; ask for frames before that")

    def __enter__(self) -> Result:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _repr_html_(self) -> str:
        """Return the HTML for a notebook: the answer, and the collapse as a player while the results are open."""
        from dem_cli.results.report.notebook import cell

        return cell(self._results, self.summary, readable=not self._closed)

    def __repr__(self) -> str:
        load = "" if self.failure_load is None else f", failure load {self.failure_load:.6g}"
        return f"<Result of {self.summary.get('title') or self._path.name!r}: {self.kind}, {self.status}{load}>"


def unit_of(column: str) -> str:
    """Return the unit of a column of the history."""
    return KNOWN_QUANTITIES[column].unit if column in KNOWN_QUANTITIES else ""


def monitor_history(results: Results, name: str, table: dict[str, Any]) -> MonitorHistory:
    """Return the history of one monitor. table: its own in the case."""
    quantity, absolute = str(table.get("quantity", "displacement")), bool(table.get("absolute", False))
    unit, series = MONITOR_UNITS[quantity], results.series
    if series is not None and name in series.monitors:
        return MonitorHistory(series.monitors[name], unit, quantity, absolute, series.time, None)
    load = results.history.get("load", np.zeros(0))  # none yet in a run that was killed at once
    return MonitorHistory(results.monitors[name], unit, quantity, absolute, None, load)


def release(source: ExitStack, folder: Path | None) -> None:
    """Close the source of results; remove the folder of those that are not kept."""
    source.close()
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)
