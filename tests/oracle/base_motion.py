"""Accelerations of a base in closed form, with their exact integrals: what the dynamic oracles are shaken by."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Sine:
    """A sin(2π f t + φ) from t = 0 to `duration`, nothing before and after; at rest before.

    f = 0 with φ = π/2 is a rectangular pulse.
    """

    amplitude: float  # [m/s2]
    frequency: float  # [Hz]
    phase: float = 0.0  # [rad]
    duration: float = np.inf  # [s]

    @property
    def breaks(self) -> np.ndarray:
        """Times at which the acceleration or its slope jumps [s]."""
        return np.array([0.0, self.duration] if np.isfinite(self.duration) else [0.0])

    def acceleration(self, t):
        t = np.asarray(t, float)
        inside = (t >= 0.0) & (t <= self.duration)
        return np.where(inside, self.amplitude * np.sin(2.0 * np.pi * self.frequency * t + self.phase), 0.0)

    def velocity(self, t):
        """Exact integral from 0 [m/s]."""
        t = np.clip(np.asarray(t, float), 0.0, self.duration)
        w = 2.0 * np.pi * self.frequency
        if w == 0.0:
            return self.amplitude * np.sin(self.phase) * t
        return self.amplitude / w * (np.cos(self.phase) - np.cos(w * t + self.phase))

    def displacement(self, t):
        """Exact integral of the velocity from 0 [m]."""
        t = np.asarray(t, float)
        inside, after = np.clip(t, 0.0, self.duration), np.maximum(t - self.duration, 0.0)
        w = 2.0 * np.pi * self.frequency
        if w == 0.0:
            moved = 0.5 * self.amplitude * np.sin(self.phase) * inside**2
        else:
            turned = (np.sin(w * inside + self.phase) - np.sin(self.phase)) / w
            moved = self.amplitude / w * (np.cos(self.phase) * inside - turned)
        left = self.velocity(self.duration) * after if np.isfinite(self.duration) else 0.0
        return moved + left


@dataclass(frozen=True)
class Record:
    """Accelerations at 0, dt, 2 dt, …, straight lines between them, nothing after the last."""

    dt: float  # [s]
    values: np.ndarray  # [m/s2], (n,)
    _sums: tuple[np.ndarray, np.ndarray] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        a, dt = np.asarray(self.values, float), self.dt
        velocity = np.concatenate([[0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1]))])
        steps = velocity[:-1] * dt + dt**2 * (2.0 * a[:-1] + a[1:]) / 6.0
        object.__setattr__(self, "values", a)
        object.__setattr__(self, "_sums", (velocity, np.concatenate([[0.0], np.cumsum(steps)])))

    @property
    def duration(self) -> float:
        return self.dt * (len(self.values) - 1)

    @property
    def breaks(self) -> np.ndarray:
        return self.dt * np.arange(len(self.values))

    def acceleration(self, t):
        return np.interp(t, self.breaks, self.values, left=0.0, right=0.0)

    def velocity(self, t):
        place, s = self._place(t)
        a, slope = self.values[place], (self.values[place + 1] - self.values[place]) / self.dt
        return self._sums[0][place] + a * s + 0.5 * slope * s**2

    def displacement(self, t):
        place, s = self._place(t)
        a, slope = self.values[place], (self.values[place + 1] - self.values[place]) / self.dt
        moved = self._sums[1][place] + self._sums[0][place] * s + 0.5 * a * s**2 + slope * s**3 / 6.0
        return moved + self._sums[0][-1] * np.maximum(np.asarray(t, float) - self.duration, 0.0)

    def _place(self, t):
        t = np.clip(np.asarray(t, float), 0.0, self.duration)
        place = np.minimum((t / self.dt).astype(int), len(self.values) - 2)
        return place, t - place * self.dt


Motion = Sine | Record
REST = Sine(0.0, 0.0)


def pulse(amplitude: float, frequency: float, cycles: float = 1.0, phase: float = 0.0) -> Sine:
    """`cycles` of a sine; 0.5 is a half-sine pulse."""
    return Sine(amplitude, frequency, phase, cycles / frequency)


def rectangle(amplitude: float, duration: float) -> Sine:
    return Sine(amplitude, 0.0, 0.5 * np.pi, duration)
