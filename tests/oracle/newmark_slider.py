"""A rigid block that slides on a base in motion, Coulomb friction, exactly: two-way on the level, on an incline too.

The block moves by s along the base (positive to the right, or up a slope that rises to the right by β), the base by a
motion along the unit vector (dx, dy). While it slides with the sign σ = sgn v

    s'' = −g sin β − a d·t − σ μ (g cos β + a d·n),   t = (cos β, sin β), n = (−sin β, cos β)

whose integrals over time are those of a: nothing is stepped (Newmark 1965). It sticks while |−g sin β − a d·t| stays
below μ (g cos β + a d·n). Times at which it starts, stops or turns are roots, found between points closer than `step`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from oracle.base_motion import Motion

TINY = 1e-13


class Slope(NamedTuple):
    """What the block slides on."""

    friction: float
    angle: float = 0.0  # β [rad]
    gravity: float = 9.81  # [m/s2]
    direction: tuple[float, float] = (1.0, 0.0)  # of the motion, unit vector


class Sliding(NamedTuple):
    """The times at which the block started, stopped or turned, and how it moved there along the base."""

    times: np.ndarray  # [s], (n,)
    slips: np.ndarray  # s [m], (n,)
    speeds: np.ndarray  # s' [m/s], (n,)

    @property
    def final(self) -> float:
        """Slip at the end [m]."""
        return float(self.slips[-1])

    @property
    def path(self) -> float:
        """Length of the way [m]: the slip turns only where the speed is zero, at one of the times."""
        return float(np.abs(np.diff(self.slips)).sum())


def slide(slope: Slope, motion: Motion, duration: float, *, speed: float = 0.0, step: float = 1e-3) -> Sliding:
    """From s = 0 with `speed` at t = 0."""
    return _Slider(slope, motion, duration, step).run(speed)


class _Slider:
    def __init__(self, slope: Slope, motion: Motion, duration: float, step: float) -> None:
        self.motion, self.duration = motion, duration
        breaks = motion.breaks
        count = int(np.ceil(duration / step)) + 1
        grid = np.concatenate([np.linspace(0.0, duration, count), breaks[(breaks > 0.0) & (breaks < duration)]])
        self.grid = np.unique(grid)
        c, s = np.cos(slope.angle), np.sin(slope.angle)
        dx, dy = slope.direction
        self.push = -slope.gravity * s, -(dx * c + dy * s)  # s'' without friction: constant, factor of a
        self.hold = slope.friction * slope.gravity * c, slope.friction * (dy * c - dx * s)
        assert (self.hold[0] + self.hold[1] * motion.acceleration(self.grid) >= 0.0).all(), "the block takes off"

    def run(self, speed: float) -> Sliding:
        t, s, v = 0.0, 0.0, speed
        rows = [(t, s, v)]
        while t < self.duration - TINY:
            if v == 0.0:
                start = self._start(t)
                if start is None:
                    break
                t, sign = start
            else:
                sign = np.sign(v)
            rows.append((t, s, v))
            t, s, v = self._until_it_stops(t, s, v, sign)
            rows.append((t, s, v))
        rows.append((self.duration, s, v))
        return Sliding(*np.array(rows).T)

    def _excess(self, t, sign):
        """s'' in the sense `sign` if it slides so; positive: it starts."""
        a = self.motion.acceleration(t)
        return sign * (self.push[0] + self.push[1] * a) - (self.hold[0] + self.hold[1] * a)

    def _start(self, t: float) -> tuple[float, float] | None:
        """When the block starts at or after t, and in which sense."""
        later = np.concatenate([[t + TINY], self.grid[self.grid > t + TINY]])
        found = []
        for sign in (-1.0, 1.0):
            over = np.flatnonzero(self._excess(later, sign) > 0.0)
            if len(over) == 0:
                continue
            first = over[0]
            low, high = later[max(first - 1, 0)], later[first]
            below = self._excess(low, sign) < 0.0
            found.append((brentq(self._excess, low, high, (sign,), xtol=1e-15) if below else max(t, low - TINY), sign))
        return min(found, default=None)

    def _sliding(self, t, start, s, v, sign):
        """Slip and speed at t of a block that slides since `start`."""
        past = t - start
        constant, factor = self.push[0] - sign * self.hold[0], self.push[1] - sign * self.hold[1]
        gained = self.motion.velocity(t) - self.motion.velocity(start)
        moved = self.motion.displacement(t) - self.motion.displacement(start) - self.motion.velocity(start) * past
        return s + v * past + 0.5 * constant * past**2 + factor * moved, v + constant * past + factor * gained

    def _until_it_stops(self, start: float, s: float, v: float, sign: float) -> tuple[float, float, float]:
        later = self.grid[self.grid > start + TINY]
        speeds = sign * self._sliding(later, start, s, v, sign)[1]
        stopped = np.flatnonzero(speeds <= 0.0)
        if len(stopped) == 0:
            end = self.duration
            return end, *map(float, self._sliding(end, start, s, v, sign))
        first = stopped[0]
        low = later[first - 1] if first else start
        high = later[first]
        if low == start and v == 0.0:  # started within this step: go past the root at the start itself
            low = start + 1e-6 * (high - start)
            if sign * self._sliding(low, start, s, v, sign)[1] <= 0.0:
                return high, float(self._sliding(high, start, s, v, sign)[0]), 0.0
        end = brentq(lambda t: sign * self._sliding(t, start, s, v, sign)[1], low, high, xtol=1e-15)
        return end, float(self._sliding(end, start, s, v, sign)[0]), 0.0
