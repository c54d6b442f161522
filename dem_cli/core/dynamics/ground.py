"""Ground motion under a structure: the base, which carries the frame of coordinates, and single supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.kernels.records import Ground
from dem_cli.core.model.model import Model
from dem_cli.core.motion.record import MOTION_QUANTITIES

if TYPE_CHECKING:
    from dem_cli.core.motion.motion import Motion

AHEAD, LONGEST = 16, 65_536  # requests that are worked out at once, and rows at most


class RowsAhead:
    """Rows of endless tables, read one stretch behind the other and computed for many of these at once.

    rows: the rows from a number on, so many, of all tables; each row whatever comes with it.
    """

    def __init__(self, rows: Callable[[int, int], tuple[np.ndarray, ...]]):
        self.rows, self.first, self.end = rows, 0, 0
        self.tables: tuple[np.ndarray, ...] = ()

    def stretch(self, first: int, n: int) -> tuple[np.ndarray, ...]:
        """Return n rows from a number on."""
        if not self.first <= first <= first + n <= self.end:
            more = max(n, min(AHEAD * n, LONGEST))
            self.tables, self.first, self.end = self.rows(first, more), first, first + more
        since = first - self.first
        return tuple(table[since : since + n] for table in self.tables)


class GroundMotion:
    """Ground motion of each support: the sum of all motions that act on it.

    Motions without `blocks` move the base. A support that motions name follows these alone; where all supports have
    the same ones, they move the base.
    """

    def __init__(self, motions: Sequence[Motion], model: Model):
        self.dimension, self.n_dof = model.dimension, model.dead_loads.shape[1]
        named = [
            (motion, {i for name in motion.blocks for i in model.chosen(name, True).tolist()}) for motion in motions
        ]
        own = {i: [motion for motion, blocks in named if i in blocks] for i in np.flatnonzero(model.fixed).tolist()}
        self.motions = motions
        self.base = [motion for motion in motions if not motion.blocks]
        shared = next(iter(own.values()), [])
        if shared and all(found == shared for found in own.values()):
            self.base, own = shared, {}
        self.own = {i: found for i, found in own.items() if found}
        self.moving = np.array(sorted(self.own), np.int64)
        self.duration = max((motion.duration for motion in motions), default=0.0)
        self.peak = max((motion.peak for motion in motions), default=0.0)
        self._ahead: dict[tuple[float, int], RowsAhead] = {}
        self._sampled: tuple[np.ndarray, ...] = np.zeros(0), np.zeros((0, 3, self.dimension))  # last times, base there

    def of_base(self, times: np.ndarray) -> np.ndarray:
        """Acceleration, velocity and displacement of the base [m, s], (n, 3, d)."""
        return np.stack([self._sum(self.base, name, times) for name in MOTION_QUANTITIES], 1)

    def sampled(self, first: int, n: int, every: int, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Times of the steps first, first + every ..., n of them, and `of_base` there; first is a multiple of every.

        From then on `along` knows these times.
        """

        def rows(row: int, count: int) -> tuple[np.ndarray, ...]:
            times = dt * (every * row + every * np.arange(count))
            return times, self.of_base(times)

        times, base = self._sampled = self._table(dt, every, rows).stretch(first // every, n)
        return times, base

    def along(self, time: float) -> float:
        """Acceleration of the base along its first motion [m/s²]."""
        if not self.base:
            return 0.0
        times, base = self._sampled
        place = int(times.searchsorted(time))
        if place < len(times) and times[place] == time:  # a fiftieth of the cost of working it out
            acceleration = base[place, 0]
        else:
            acceleration = self._sum(self.base, "acceleration", np.array([time]))[0]
        return float(product(acceleration, np.array(self.base[0].direction)))

    def stretch(self, start: float, n_steps: int, dt: float) -> Ground:
        """Compute the ground motion over n_steps steps from the time `start` [s]. The frame is accelerated by as
        much as it gains in velocity over each step, so that no impulse is lost between samples.

        Times are counted in steps: where a stretch starts changes no bit of the motion.
        """
        gained, velocities = self._table(dt, 0, lambda first, n: self._gained(first, n, dt)).stretch(
            round(start / dt), n_steps
        )
        return Ground(gained, self.moving, velocities)

    def _table(self, dt: float, every: int, rows: Callable[[int, int], tuple[np.ndarray, ...]]) -> RowsAhead:
        """Return the table computed ahead for steps of dt; every: 0 for the steps themselves."""
        if (dt, every) not in self._ahead:
            self._ahead = {key: table for key, table in self._ahead.items() if key[0] == dt}  # of one run at a time
            self._ahead[dt, every] = RowsAhead(rows)
        return self._ahead[dt, every]

    def _gained(self, first: int, n_steps: int, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Ground.accelerations and Ground.velocities of the steps from a number on."""
        times = dt * (first + np.arange(n_steps + 1))
        gained = np.diff(self._sum(self.base, "velocity", times - 0.5 * dt), axis=0)
        velocities = np.zeros((n_steps, len(self.moving), self.n_dof))
        if len(self.moving):
            carried = self._sum(self.base, "displacement", times)
            for j, block in enumerate(self.moving.tolist()):
                way = self._sum(self.own[block], "displacement", times) - carried
                velocities[:, j, : self.dimension] = np.diff(way, axis=0) / dt
        return np.ascontiguousarray(gained / dt), velocities

    def _sum(self, motions: Sequence[Motion], name: str, times: np.ndarray) -> np.ndarray:
        total = np.zeros((len(times), self.dimension))
        for motion in motions:
            total += getattr(motion, name)(times)[:, None] * np.array(motion.direction)
        return total
