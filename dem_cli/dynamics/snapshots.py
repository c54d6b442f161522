"""Snapshots of a time history: enough frames per second for the motion, and always the one where it went farthest.

Even instants alone alias what moves faster, and miss every peak. A snapshot is due when time has passed that the ground
or the structure needs to be followed; beside these, a swing that goes farther than all before it leaves the frame of its
turning point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.engine import measures

if TYPE_CHECKING:
    from dem_cli.dynamics.ground import GroundMotion
    from dem_cli.engine.dynamic import DynamicSimulation
    from dem_cli.engine.dynamic_settings import SnapshotSettings
    from dem_cli.engine.track import Track
    from dem_cli.output.record import Frame


class SnapshotTimes:
    """When snapshots are due: at even times from a start to an end, each once."""

    def __init__(self, start: float, end: float, count: int):
        self.times, self.shown = np.linspace(start, end, max(count, 2)), 0 if start > 0.0 else 1

    def due(self, time: float) -> bool:
        """Whether a snapshot was due up to now since the last one."""
        before, self.shown = self.shown, max(self.shown, int((self.times <= time).sum()))
        return self.shown > before


class Snapshots:
    """The frames that a time history keeps, in the order of time; the simulation calls `look` along the way.

    wanted: as many at even times as a case asks for; None: as many as the motion needs.
    """

    def __init__(self, track: Track, sim: DynamicSimulation, ground: GroundMotion, gravity: float, wanted: int | None):
        self.track, self.sim, self.ground, self.gravity = track, sim, ground, gravity
        self.settings: SnapshotSettings = sim.settings.snapshots
        self.wanted, self.stage = wanted, "shaking"
        self.farthest = 0.0  # [m]
        self.ahead: Frame | None = None  # of the largest displacement so far, where none is kept since
        self.last = np.zeros((len(sim.free), sim.model.dimension))  # displacements in the last one kept [m]
        self.visible = self.settings.visible * size_of(sim)
        self.room = max(self.settings.bytes // bytes_of(sim), self.settings.fewest)

    def begin(self, duration: float, sampled: int) -> None:
        """Even times until `duration` [s], close enough to follow the ground; the start itself is kept by others.

        sampled: steps from one sample of the monitors to the next. Looks fall on samples, so that both see one peak.
        """
        settings, between = self.settings, sampled * self.sim.dt
        self.every = sampled * max(1, round(settings.look / between))
        of_ground = settings.per_cycle * frequency_of(self.ground, duration)
        self.per_second = min(max(settings.per_second, of_ground), settings.most_per_second)
        self.times = SnapshotTimes(0.0, duration, self._count(duration, self.per_second))
        self.room -= len(self.times.times)  # what is left is for what moves faster

    def _count(self, duration: float, per_second: float) -> int:
        """How many at even times, within the room that there is."""
        return self.wanted if self.wanted is not None else 1 + math.ceil(min(duration * per_second, self.room))

    def collapsed(self, end: float) -> None:
        """A collapse is followed from now until `end` [s]."""
        self.stage, now = "collapse", self.sim.time
        if self.wanted is None:
            self.room += int((self.times.times > now).sum())
            count = self._count(end - now, max(self.per_second, self.settings.per_second_of_collapse))
        else:
            count = max(self.wanted // 2, 2)
        self.times = SnapshotTimes(now, end, count)

    def look(self) -> None:
        """Keep this instant, or remember it."""
        if self.track.frames == 0:
            return
        sim = self.sim
        places = measures.displacements(sim)[sim.free]
        moved = math.sqrt((places**2).sum(axis=1).max(initial=0.0))
        if not math.isfinite(moved):
            return
        record = moved > self.farthest
        self.farthest = max(moved, self.farthest)
        if self.times.due(sim.time + 0.5 * sim.dt) or self._swung(places):
            if self.ahead is not None and not record:
                self.track.hand_over(self.ahead)
            self.ahead, self.last = None, places
            self.track.hand_over(self._frame())
        elif record and self.stage == "shaking":
            self.ahead = self._frame()

    def _swung(self, places: np.ndarray) -> bool:
        """Whether a block moved so far since the last snapshot that its swings would be lost between even times."""
        if self.wanted is not None or self.room <= 0:
            return False
        limit = self.settings.swing * max(self.farthest, self.visible)
        swung = bool(((places - self.last) ** 2).sum(axis=1).max(initial=0.0) > limit**2)
        self.room -= swung
        return swung

    def _frame(self) -> Frame:
        self.sim.show_base(self.ground.along(self.sim.time), self.gravity)
        return measures.frame(self.sim, self.stage)


def frequency_of(ground: GroundMotion, duration: float) -> float:
    """Mean frequency of the velocity of the ground, as its zeros come (Rice): σ(a) / 2πσ(v) of its fastest motion [Hz]."""
    found = 0.0
    for motion in [*ground.base, *(motion for motions in ground.own.values() for motion in motions)]:
        times = np.linspace(motion.start, min(motion.duration, max(duration, motion.start)), 4001)
        deviations = [float(np.std(values(times))) for values in (motion.acceleration, motion.velocity)]
        found = max(found, deviations[0] / (2.0 * math.pi * deviations[1]) if deviations[1] > 0.0 else 0.0)
    return found


def size_of(sim: DynamicSimulation) -> float:
    """Largest extent of the free blocks at the start [m]."""
    model = sim.model
    corners = (model.centroids[model.vertex_blocks] + model.vertices)[~model.fixed[model.vertex_blocks]]
    return float(np.ptp(corners, axis=0).max()) if len(corners) else 0.0


def bytes_of(sim: DynamicSimulation) -> int:
    """About what a frame takes on disk, both files together."""
    return 2000 + 160 * len(sim.contacts.normal) + 90 * sim.model.n_blocks + 40 * len(sim.model.vertices)
