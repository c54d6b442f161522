"""Base motion: one scalar history along a direction, with its exact integrals."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

ENDS_MOVING = 0.02  # end velocity over the largest one: more than this deserves a warning


class Waveform(Protocol):
    """Waveform of a motion, which starts at t = 0 from rest; times given to it lie within [0, duration].

    velocity is the exact integral of acceleration and displacement that of velocity, both 0 at t = 0.
    """

    duration: float  # [s]
    peak: float  # largest absolute acceleration [m/s2]
    step: float  # time step that shows it well [s]

    def acceleration(self, t: np.ndarray) -> np.ndarray:
        """Acceleration [m/s2] at times t [s]."""

    def velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] at times t [s]."""

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """Displacement [m] at times t [s]."""


@dataclass(frozen=True)
class Motion:
    """Motion of the base: `factor` times a waveform, from `start` on, along `direction`.

    Before the start everything is 0; after the end the acceleration is 0 and the velocity stays what it was.
    Times are scalars or arrays of any shape [s]; results have the same shape, in m/s2, m/s and m.

    direction  unit vector, (d,)
    blocks     ids of the fixed blocks that move; () for all
    """

    shape: Waveform
    direction: tuple[float, ...] = (1.0, 0.0)
    blocks: tuple[str, ...] = ()
    start: float = 0.0
    factor: float = 1.0
    name: str = ""
    warnings: tuple[str, ...] = field(default=())

    @property
    def duration(self) -> float:
        """Time at which the motion ends [s]."""
        return self.start + self.shape.duration

    @property
    def peak(self) -> float:
        """Largest absolute acceleration [m/s2]."""
        return abs(self.factor) * self.shape.peak

    def acceleration(self, t: np.ndarray | float) -> np.ndarray:
        """Acceleration [m/s2]; of two values at a jump, one of them."""
        inside, after, before = self._times(t)
        return np.where((after > 0.0) | before, 0.0, self.factor * self.shape.acceleration(inside))

    def velocity(self, t: np.ndarray | float) -> np.ndarray:
        """Velocity [m/s], exact integral of the acceleration."""
        inside, _, _ = self._times(t)
        return self.factor * self.shape.velocity(inside)

    def displacement(self, t: np.ndarray | float) -> np.ndarray:
        """Displacement [m], exact integral of the velocity."""
        inside, after, _ = self._times(t)
        coasting = self.shape.velocity(np.asarray(self.shape.duration)) * after
        return self.factor * (self.shape.displacement(inside) + coasting)

    def scaled(self, factor: float) -> Motion:
        """Scale the motion by a factor on its strength."""
        return replace(self, factor=self.factor * factor)

    def times(self, most: int = 1_000_000) -> np.ndarray:
        """Even times from the start to the end, those of an even record, otherwise close enough to show it [s], (n,).

        At most `most` steps.
        """
        steps = self.shape.duration / self.shape.step
        return self.start + np.linspace(0.0, self.shape.duration, max(1, int(min(most, np.ceil(steps - 1e-6)))) + 1)

    def samples(self) -> np.ndarray:
        """Times from 0 that the motion is made of: those of a record, otherwise even ones [s], (n,)."""
        own = getattr(self.shape, "times", None)
        times = self.times() if own is None else self.start + own
        return times if self.start == 0.0 else np.concatenate(([0.0], times))

    @property
    def end_velocity(self) -> float:
        """Velocity that stays after the end [m/s]."""
        return float(self.velocity(self.duration))

    def _times(self, t: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times within the shape, time since its end (≥ 0), and whether it has not begun."""
        since = np.asarray(t, float) - self.start
        inside = np.minimum(np.maximum(since, 0.0), self.shape.duration)
        after = np.maximum(since - self.shape.duration, 0.0)
        # start + duration, rounded, may lie a hair behind the end: that is the end, not after it
        after = np.where(after <= 4.0 * np.spacing(self.duration), 0.0, after)
        return inside, after, since < 0.0


def moving_at_the_end(motion: Motion) -> str:
    """Return the warning about a motion that leaves the base moving; empty where it ends at rest."""
    velocities = motion.velocity(motion.times(20_000))
    largest, last = float(np.abs(velocities).max()), motion.end_velocity
    if abs(last) <= ENDS_MOVING * largest:
        return ""
    return f"ends with a velocity of {last:.3g} m/s (largest {largest:.3g} m/s), which the base keeps"
