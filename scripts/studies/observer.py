"""Observer of a run for studies: it keeps frames, history rows and samples."""

from __future__ import annotations

import numpy as np

from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow, Samples
from dem_cli.core.records.ports import Observer


class RunKeeper(Observer):
    """Keeps frames, history rows and samples of monitors in the order in which they come."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self.rows: list[HistoryRow] = []
        self.stretches: list[Samples] = []

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def row(self, row: HistoryRow) -> None:
        self.rows.append(row)

    def samples(self, samples: Samples) -> None:
        if not samples.coda:
            self.stretches.append(samples)

    @property
    def times(self) -> np.ndarray:
        """Of the samples [s], (n,)."""
        return np.concatenate([s.times for s in self.stretches] or [np.zeros(0)])

    @property
    def values(self) -> np.ndarray:
        """Of the monitors, (n, n_monitors)."""
        return np.concatenate([s.monitors for s in self.stretches] or [np.zeros((0, 0))])
