"""Runs in space with what a reader asks of any of them: book of energy, re-weighting, cost."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.app.pipeline.execution import Destination, execute
from dem_cli.case.reader import LoadedCase
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import Energy, HistoryRow, Samples
from dem_cli.core.records.ports import Observer
from studies.observer import RunKeeper
from studies.solution import from_tables

ROWS = 200  # of the history: often enough for a book


class BookedRun(NamedTuple):
    """A run and what it cost."""

    summary: dict[str, Any]
    seen: RunKeeper
    seconds: float  # of CPU
    blocks: int

    @property
    def books(self) -> dict[str, Any]:
        """What each row of the study's tables ends with."""
        return {
            **(self._in_time() if self.summary.get("largest_time_step") else self._at_rest()),
            "steps": self.summary["steps"],
            "seconds": round(self.seconds, 2),
            "blocks": self.blocks,
            "status": self.summary["status"],
        }

    def _in_time(self) -> dict[str, float]:
        return book_of([row.energy for row in self.seen.rows])

    def _at_rest(self) -> dict[str, float]:
        """Of pseudo-time the program's own closure, over the largest energy in the ledger."""
        table = np.array([row.energy for row in self.seen.rows])
        changed = self.summary.get("reweighting") or {"net": 0.0, "sum": 0.0}
        largest = float(np.abs(table).max()) or 1.0
        book = abs(self.summary["energy_closure"])
        return {"book": book, "net": changed["net"] / largest, "moved": changed["sum"] / largest, "kinetic": 0.0}

    def column(self, k: int) -> np.ndarray:
        """Of a monitor, (n,)."""
        return self.seen.values[:, k]

    def at(self, when: float, k: int) -> float:
        """Of a monitor at a time [s]."""
        return float(np.interp(when, self.seen.times, self.column(k)))


class PassingKeeper(RunKeeper):
    """Keeps what a solver reports, and passes it on to who writes it."""

    def __init__(self, writer: Observer) -> None:
        super().__init__()
        self.writer = writer

    def frame(self, frame: Frame) -> None:
        super().frame(frame)
        self.writer.frame(frame)

    def row(self, row: HistoryRow) -> None:
        super().row(row)
        self.writer.row(row)

    def samples(self, samples: Samples) -> None:
        super().samples(samples)
        self.writer.samples(samples)


def run(tables: dict[str, Any], *overrides: str) -> BookedRun:
    """A case that is a table."""
    loaded = from_tables(tables, *overrides)
    return solved(loaded, api.build_model(loaded))


def solved(loaded: LoadedCase, model: Model) -> BookedRun:
    """A case with this model, the way `dem run` goes; what it writes is not kept."""
    kept: list[tuple[PassingKeeper, float]] = []

    def measured(case, model, observer):
        both, begun = PassingKeeper(observer), time.process_time()
        outcome = solve(case, model, both)
        kept.append((both, time.process_time() - begun))
        return outcome

    with tempfile.TemporaryDirectory() as folder:
        summary, _ = execute(loaded, model, Destination(Path(folder) / "run"), time.perf_counter(), solve=measured)
    if not kept:
        raise RuntimeError(f"{loaded.case.title or 'run'}: {summary['status']}: {summary['warnings']}")
    seen, seconds = kept[0]
    return BookedRun(summary, seen, seconds, int((~model.fixed).sum()))


def book_of(rows: list[Energy]) -> dict[str, float]:
    """Error of the book of a time history, energy that re-weighting took (net) and moved (sum of amounts), over the
    largest kinetic energy.

    From the first row after the start on: what is thrown there is given half a step before. Net and sum are those of
    the rows: a sum of what changed between them.
    """
    sums = dict(zip(Energy._fields, np.array(rows[1:]).T, strict=True))
    given = sums["external"] + sums["supports"]
    error = sum(values for name, values in sums.items() if name not in ("external", "supports")) - given
    kinetic = float(sums["kinetic"].max())
    changed = np.diff(sums["reweighting"], prepend=0.0)
    return {
        "book": float(np.abs(error - error[0]).max()) / kinetic,
        "net": float(changed.sum()) / kinetic,
        "moved": float(np.abs(changed).sum()) / kinetic,
        "kinetic": kinetic,
    }
