"""Pulses and harmonic motions by formula: harmonic with ramps, one cycle, half a cycle, Ricker's wavelet, rectangles.

Accelerations are integrated by hand; every shape starts at t = 0 from rest (the contract: motion.py, `Shape`).
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.arithmetic import functions

PER_CYCLE = 200  # time steps that show a cycle
RICKER_HALF = 1.5  # half length of the wavelet in periods: the acceleration is 1e-8 of its peak there


class SineWave:
    """Sine with ramps, amplitude · r(t) · sin(2π f t + phase).

    r rises from 0 to 1 over the first `ramp` seconds, and falls likewise.
    amplitude [m/s2], frequency [Hz], phase [rad], duration [s], ramp [s], at most half the duration.
    """

    def __init__(self, amplitude: float, frequency: float, duration: float, phase: float = 0.0, ramp: float = 0.0):
        self.amplitude, self.omega, self.phase = amplitude, 2.0 * math.pi * frequency, phase
        self.duration = duration
        self.step = 1.0 / (PER_CYCLE * frequency)
        # pieces between `knots`, in each of which r = level + slope · t
        if ramp > 0.0:
            self.knots = np.array([0.0, ramp, max(ramp, duration - ramp)])
            self.levels = np.array([0.0, 1.0, duration / ramp])
            self.slopes = np.array([1.0, 0.0, -1.0]) / ramp
        else:
            self.knots, self.levels, self.slopes = np.zeros(1), np.ones(1), np.zeros(1)
        self._join()
        self.peak = self._peak()

    def acceleration(self, t: np.ndarray) -> np.ndarray:
        """Acceleration [m/s2] at times t [s]."""
        k = self._piece(t)
        return self.amplitude * (self.levels[k] + self.slopes[k] * t) * np.sin(self.omega * t + self.phase)

    def velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] at times t [s]."""
        k = self._piece(t)
        return self._velocities[k] + self._first(t, k) - self._first(self.knots[k], k)

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """Displacement [m] at times t [s]."""
        k = self._piece(t)
        knot = self.knots[k]
        drift = (self._velocities[k] - self._first(knot, k)) * (t - knot)
        return self._displacements[k] + drift + self._second(t, k) - self._second(knot, k)

    def _piece(self, t: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.knots, t, side="right") - 1, 0, len(self.knots) - 1)

    def _first(self, t: np.ndarray, k: np.ndarray | int) -> np.ndarray:
        """∫ (c + s t) sin(ωt + φ) dt = −(c + s t) cos(ωt + φ)/ω + s sin(ωt + φ)/ω²"""
        w, angle = self.omega, self.omega * t + self.phase
        ramp = self.levels[k] + self.slopes[k] * t
        return self.amplitude * (-ramp * np.cos(angle) / w + self.slopes[k] * np.sin(angle) / w**2)

    def _second(self, t: np.ndarray, k: np.ndarray | int) -> np.ndarray:
        """∫∫ (c + s t) sin(ωt + φ) dt² = −(c + s t) sin(ωt + φ)/ω² − 2 s cos(ωt + φ)/ω³"""
        w, angle = self.omega, self.omega * t + self.phase
        ramp = self.levels[k] + self.slopes[k] * t
        return self.amplitude * (-ramp * np.sin(angle) / w**2 - 2.0 * self.slopes[k] * np.cos(angle) / w**3)

    def _join(self) -> None:
        """Velocity and displacement at the knots, so that the pieces fit together."""
        self._velocities, self._displacements = np.zeros(len(self.knots)), np.zeros(len(self.knots))
        for k in range(len(self.knots) - 1):
            here, there = self.knots[k], self.knots[k + 1]
            gained = self._first(there, k) - self._first(here, k)
            drift = (self._velocities[k] - self._first(here, k)) * (there - here)
            self._velocities[k + 1] = self._velocities[k] + gained
            self._displacements[k + 1] = self._displacements[k] + drift + self._second(there, k) - self._second(here, k)

    def _peak(self) -> float:
        """Largest absolute acceleration: at crests of the sine and close around them."""
        grid = np.linspace(0.0, self.duration, int(10 * PER_CYCLE * self.duration * self.omega / (2 * np.pi)) + 2)
        first = math.ceil((self.phase - math.pi / 2.0) / math.pi)
        last = math.floor((self.omega * self.duration + self.phase - math.pi / 2.0) / math.pi)
        crests = (math.pi / 2.0 + math.pi * np.arange(first, last + 1) - self.phase) / self.omega
        return float(np.abs(self.acceleration(np.clip(np.concatenate((grid, crests)), 0.0, self.duration))).max())


class RickerWavelet:
    """Ricker wavelet, amplitude · (1 − 2x²) exp(−x²), x = π f (t − 1.5/f).

    The second derivative of a bell; f is where its spectrum peaks.
    Source: N. Ricker, The form and laws of propagation of seismic wavelets, Geophysics 18 (1953).
    """

    def __init__(self, amplitude: float, frequency: float):
        self.amplitude, self.rate = amplitude, math.pi * frequency
        self.middle = RICKER_HALF / frequency
        self.duration = 2.0 * self.middle
        self.step = 1.0 / (PER_CYCLE * frequency)
        self.peak = abs(amplitude)

    def acceleration(self, t: np.ndarray) -> np.ndarray:
        """Acceleration [m/s2] at times t [s]."""
        x = self.rate * (t - self.middle)
        return self.amplitude * (1.0 - 2.0 * x * x) * functions.exp(-x * x)

    def velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] at times t [s]."""
        return self._velocity(t) - self._velocity(0.0)

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """Displacement [m] at times t [s]."""
        return self._displacement(t) - self._displacement(0.0) - self._velocity(0.0) * t

    def _velocity(self, t: np.ndarray | float) -> np.ndarray:
        x = self.rate * (t - self.middle)
        return self.amplitude / self.rate * x * functions.exp(-x * x)

    def _displacement(self, t: np.ndarray | float) -> np.ndarray:
        x = self.rate * (t - self.middle)
        return -0.5 * self.amplitude / self.rate**2 * functions.exp(-x * x)


class RectangularPulses:
    """Rectangular pulses of acceleration: `values` [m/s2] for `durations` [s], one after the other."""

    def __init__(self, durations: list[float], values: list[float]):
        lengths, self.values = np.array(durations), np.array(values)
        self.knots = np.concatenate(([0.0], np.cumsum(lengths)[:-1]))
        self.duration = float(lengths.sum())
        self.step = float(lengths.min()) / PER_CYCLE
        self.peak = float(np.abs(self.values).max())
        self._velocities = np.concatenate(([0.0], np.cumsum(self.values * lengths)[:-1]))
        travelled = self._velocities * lengths + 0.5 * self.values * lengths**2
        self._displacements = np.concatenate(([0.0], np.cumsum(travelled)[:-1]))

    def acceleration(self, t: np.ndarray) -> np.ndarray:
        """Acceleration [m/s2] at times t [s]."""
        return self.values[self._piece(t)]

    def velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] at times t [s]."""
        k = self._piece(t)
        return self._velocities[k] + self.values[k] * (t - self.knots[k])

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """Displacement [m] at times t [s]."""
        k = self._piece(t)
        since = t - self.knots[k]
        return self._displacements[k] + since * (self._velocities[k] + 0.5 * self.values[k] * since)

    def _piece(self, t: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.knots, t, side="right") - 1, 0, len(self.knots) - 1)


def impulse(amplitude: float, duration: float, rebound: float = 0.0) -> RectangularPulses:
    """Build an impulse: `amplitude` for `duration`, then −rebound · amplitude until the base stands still again
    (rebound > 0).

    With rebound 0.5 the base impulse of Dimitri, De Lorenzis and Zavarise (2011): +a for t, −a/2 for 2 t.
    """
    if rebound == 0.0:
        return RectangularPulses([duration], [amplitude])
    return RectangularPulses([duration, duration / rebound], [amplitude, -rebound * amplitude])
