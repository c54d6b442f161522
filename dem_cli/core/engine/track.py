"""Track of a simulation: rows and frames for the observer, now or after a pass proved worth keeping."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.core.engine import measures
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow
from dem_cli.core.records.ports import Observer

if TYPE_CHECKING:
    from dem_cli.core.engine.monitors import Monitors
    from dem_cli.core.engine.simulation import Simulation


class Track:
    """Rows and frames of one simulation."""

    LASTING = frozenset(("sim", "observer", "monitors"))

    def __init__(self, sim: Simulation, observer: Observer, monitors: Monitors, frames: int):
        self.sim, self.observer, self.monitors, self.frames = sim, observer, monitors, frames
        self.kept: list[HistoryRow] = []
        self.at_rest = 0.0  # of the live load under dead loads, as measures.live_travel [m]

    def row(self, stage: str, load: float | None = None) -> HistoryRow:
        """Build the history row of this instant. load: internal multiplier, where that of the instant is not
        wanted."""
        sim = self.sim
        load = sim.load if load is None else load
        travel = measures.live_travel(sim)
        if stage == "gravity":
            self.at_rest = travel
        return HistoryRow(
            stage, sim.steps, load * sim.live_scale, measures.largest_displacement(sim), sim.unbalanced,
            measures.largest_overlap(sim), measures.energy(sim), self.monitors.values(sim), sim.time,
            travel - self.at_rest,
        )  # fmt: skip

    def keep(self, stage: str) -> None:
        """Store a row until `flush`."""
        self.kept.append(self.row(stage))

    def frame(self, stage: str) -> None:
        """Hand over a frame of this instant where frames are wanted."""
        if self.frames > 0:
            self.hand_over(measures.frame(self.sim, stage))

    def hand_over(self, frame: Frame) -> None:
        """Hand over a frame."""
        self.observer.frame(frame)

    def flush(self) -> None:
        """Hand over the stored rows."""
        for row in self.kept:
            self.observer.row(row)
        self.kept.clear()

    def write(self, stage: str, load: float | None = None) -> HistoryRow:
        """Hand over a row now, as `row`."""
        row = self.row(stage, load)
        self.observer.row(row)
        return row
