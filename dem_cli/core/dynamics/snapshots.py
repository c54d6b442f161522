"""Snapshots of a time history: enough frames per second for the motion, and always the one where it went farthest.

Even instants alone alias what moves faster, and miss every peak. A snapshot is due when so much time has passed that
the ground would be lost, or when a block has moved by a part of its swings, or turned by much; beside these, a swing
that goes farther than all before it leaves the frame of its turning point. Until a block has moved visibly against the
ground a few are enough.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.geometry.rotation import largest_angle_between

if TYPE_CHECKING:
    from dem_cli.core.dynamics.ground import GroundMotion
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.engine.dynamic_settings import SnapshotSettings
    from dem_cli.core.engine.track import Track


class EvenTimes:
    """Snapshots at even times from a start to an end, each once."""

    def __init__(self, start: float, end: float, count: int):
        self.times, self.shown = np.linspace(start, end, max(count, 2)), 0 if start > 0.0 else 1

    def due(self, time: float, _since: float, _still: bool) -> bool:
        """Test whether a snapshot was due up to now [s] since the last one."""
        before, self.shown = self.shown, max(self.shown, int((self.times <= time).sum()))
        return self.shown > before

    def left(self, _since: float, _still: bool) -> float:
        """Return 0: every look may be due."""
        return 0.0


class Intervals:
    """Snapshots no further apart than an interval [s], or another one where all is still, and one at the end."""

    def __init__(self, interval: float, interval_still: float, end: float):
        self.interval, self.interval_still, self.end = interval, max(interval, interval_still), end

    def due(self, time: float, since: float, still: bool) -> bool:
        """Test whether the last snapshot is long ago [s], or this is the end; still: no block has moved visibly
        until now."""
        return since >= self._wanted(still) or time >= self.end

    def left(self, since: float, still: bool) -> float:
        """Return the time until the next snapshot [s]."""
        return self._wanted(still) - since

    def _wanted(self, still: bool) -> float:
        return self.interval_still if still else self.interval


class Snapshots:
    """Frames of a time history, in the order of time; the simulation calls `look` along the way.

    wanted: as many at even times as a case asks for; None: as many as the motion needs.
    """

    LASTING = frozenset(("track", "sim", "ground", "settings", "drawn"))

    def __init__(self, track: Track, sim: DynamicSimulation, ground: GroundMotion, gravity: float, wanted: int | None):
        self.track, self.sim, self.ground, self.gravity = track, sim, ground, gravity
        self.settings: SnapshotSettings = sim.settings.snapshots
        self.wanted, self.stage, self.due = wanted, "shaking", 0
        self.ahead: measures.Moment | None = None  # of the largest displacement so far, where none is kept since
        self.drawn = sim.reference_positions[sim.free]
        self.visible = self.settings.visible * size_of(sim)
        self.room = max(self.settings.bytes // bytes_of(sim), self.settings.fewest)  # frames that may still be kept

    def begin(self, duration: float, sampled: int) -> None:
        """Begin the snapshots of a motion that lasts `duration` [s]; the frame of its start is kept by others.

        sampled: steps from one sample of the monitors to the next. Looks fall on samples, so that both see one peak.
        """
        settings, sim = self.settings, self.sim
        self.close = self.spaced = sampled * max(1, round(settings.look / (sampled * sim.dt)))
        self.last, self.last_turns, self.last_step = self._places(), self._turns(), sim.steps  # of the last one kept
        self.farthest = _largest(self.last)  # [m]
        self.seen = sim.steps, self.farthest, 0.0, 0.0  # at the last look: step, and as `look` has them
        of_ground = settings.per_cycle * frequency_of(self.ground, duration)
        self.per_second = min(max(settings.per_second, of_ground), settings.most_per_second)
        self.times = self._until(duration, duration, self.per_second)
        self.spaced = self.close * self._times_as_far()
        self._look_again_after(self.close)

    def collapsed(self, end: float) -> None:
        """Follow a collapse with snapshots from now until `end` [s]."""
        self.stage, self.ahead, left = "collapse", None, end - self.sim.time
        self.spaced = self.close
        self.times = self._until(end, left, max(self.per_second, self.settings.per_second_of_collapse))
        self.look()

    def _until(self, end: float, left: float, per_second: float) -> EvenTimes | Intervals:
        """Choose the times of snapshots until an end that is so far off [s]."""
        if self.wanted is None:
            return Intervals(max(1.0 / per_second, left / max(self.room, 1)), 1.0 / self.settings.per_second_still, end)
        return EvenTimes(end - left, end, self.wanted if self.stage == "shaking" else self.wanted // 2)

    def look(self) -> None:
        """Keep this instant, or remember it."""
        self._look_again_after(self.close)
        sim, places = self.sim, self._places()
        moved, since = _largest(places), sim.dt * (sim.steps - self.last_step)
        if self.track.frames == 0 or not math.isfinite(moved) or since == 0.0:
            return
        record, away = moved > self.farthest, _largest(places - self.last)
        turned = largest_angle_between(self._turns(), self.last_turns)
        looks, self.farthest = self._looks_ahead(moved, away, turned), max(moved, self.farthest)
        still = self.farthest < self.settings.swing * self.visible
        if self.times.due(sim.time + 0.5 * sim.dt, since + 0.5 * sim.dt, still) or self._swung(away, turned):
            if self.ahead is not None and not record:
                self._keep(self.ahead)
            self.ahead, self.last, self.last_turns, self.last_step = None, places, self._turns(), sim.steps
            self.seen, since = (sim.steps, moved, 0.0, 0.0), 0.0
            self._keep(measures.moment(sim))
        elif record and self.stage == "shaking":
            self.ahead = measures.moment(sim)
        due = math.ceil(self.times.left(since, still) / (self.close * sim.dt) - 1e-6)
        self._look_again_after(self.close * max(min(looks, due), 1))

    def _look_again_after(self, steps: int) -> None:
        """Set the next look, on a sample."""
        done = round(self.sim.time / self.sim.dt)
        self.due = done - done % self.close + steps

    def _times_as_far(self) -> int:
        """Compute how much wider looks may be spaced where nothing is near: a part of the time between snapshots."""
        if self.wanted is not None:
            return 1
        between = self.settings.between / (self.per_second * self.close * self.sim.dt)
        return max(1, min(int(between), self.settings.spaced))

    def _looks_ahead(self, moved: float, away: float, turned: float) -> int:
        """Estimate the looks, in units of `close`, before a block goes farther than ever or by a swing, at twice
        the last rate."""
        (step, *before), now = self.seen, (moved, away, turned)
        self.seen = self.sim.steps, *now
        passed, looks = max(self.sim.steps - step, 1) / self.close, self.spaced // self.close
        size = max(self.farthest, self.visible)
        ends = self.farthest + self.settings.trifle * size, self.settings.swing * size, self.settings.turn
        for one, was, end in zip(now, before, ends, strict=True):
            if one > was and looks > 1:
                looks = min(looks, int(0.5 * passed * (end - one) / (one - was)))
        return max(looks, 1)

    def _places(self) -> np.ndarray:
        """Displacements of the free blocks [m], (n_free, d)."""
        sim = self.sim
        return sim.bodies.positions.take(sim.free, axis=0) - self.drawn

    def _turns(self) -> np.ndarray:
        return self.sim.bodies.orientations.take(self.sim.free, axis=0)

    def _swung(self, away: float, turned: float) -> bool:
        """Test whether a block moved or turned so far since the last snapshot that even times would lose it.

        away: how far one moved at most [m]; turned: how far one turned [rad].
        """
        if self.wanted is not None or self.room <= 0:
            return False
        return away > self.settings.swing * max(self.farthest, self.visible) or turned > self.settings.turn

    def _keep(self, moment: measures.Moment) -> None:
        self.room -= 1
        self.sim.show_base(self.ground.along(moment.time), self.gravity)
        self.track.hand_over(measures.frame_of(self.sim, moment, self.stage))


def _largest(displacements: np.ndarray) -> float:
    return math.sqrt((displacements * displacements).sum(axis=1).max(initial=0.0))


def frequency_of(ground: GroundMotion, duration: float) -> float:
    """Compute the mean frequency of the sign of the ground velocity (Rice): σ(a) / 2πσ(v), of its fastest motion
    [Hz]."""
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
    """Estimate the size of a frame on disk [bytes], both files together."""
    return 2000 + 160 * len(sim.contacts.normal) + 90 * sim.model.n_blocks + 40 * len(sim.model.vertices)
