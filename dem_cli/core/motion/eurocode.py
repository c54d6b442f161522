"""Eurocode 8 elastic response spectra (EN 1998-1:2004, 3.2.2.2) and target spectra through points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

SOILS = {  # type -> ground type -> S, TB, TC, TD [s]: EN 1998-1, tables 3.2 and 3.3
    "EC8-1": {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.20, 0.6, 2.0),
        "D": (1.35, 0.20, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    "EC8-2": {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.10, 0.25, 1.2),
        "D": (1.8, 0.10, 0.30, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}
LONGEST_PERIOD = 4.0  # s: up to here EN 1998-1 3.2.2.2 gives the spectrum; beyond, its last branch goes on


@dataclass(frozen=True)
class TargetSpectrum:
    """Response spectrum to meet: pseudo-acceleration [m/s2] by period [s], for a damping ratio."""

    acceleration: Callable[[np.ndarray], np.ndarray]
    ground: float  # acceleration at period 0 [m/s2]
    damping: float
    title: str

    def __call__(self, periods: np.ndarray | float) -> np.ndarray:
        """Pseudo-acceleration [m/s2] at periods [s]."""
        return self.acceleration(np.asarray(periods, float))

    def scaled(self, factor: float) -> TargetSpectrum:
        """Scale the spectrum by a factor."""
        if factor == 1.0:
            return self
        title = f"{factor:g} × {self.title}"
        return TargetSpectrum(
            lambda periods: factor * self.acceleration(periods), factor * self.ground, self.damping, title
        )


def damping_correction(damping: float) -> float:
    """Compute the damping correction η = √(10/(5 + ξ)) ≥ 0.55, ξ in per cent (EN 1998-1, equation 3.6); `damping`
    is a ratio."""
    return max(float(np.sqrt(10.0 / (5.0 + 100.0 * damping))), 0.55)


def eurocode(kind: str, soil: str, ag: float, damping: float = 0.05) -> TargetSpectrum:
    """Build the elastic spectrum of Eurocode 8, equations 3.2 to 3.5; kind "EC8-1" or "EC8-2", ag on rock [m/s2]."""
    s, tb, tc, td = SOILS[kind][soil]
    eta = damping_correction(damping)

    def acceleration(periods: np.ndarray) -> np.ndarray:
        longer = np.maximum(periods, tb)  # keeps the falling branches from dividing by 0
        rising = 1.0 + np.minimum(periods, tb) / tb * (2.5 * eta - 1.0)
        falling = 2.5 * eta * np.minimum(1.0, tc / longer) * np.minimum(1.0, td / longer)
        return ag * s * np.where(periods <= tb, rising, falling)

    return TargetSpectrum(acceleration, ag * s, damping, f"Eurocode 8 type {kind[-1]}, ground {soil}, ag = {ag:g} m/s²")


def listed(points: Sequence[tuple[float, float]], damping: float = 0.05) -> TargetSpectrum:
    """Build a spectrum through points (period [s], acceleration [m/s2]), linear between them, constant beyond.

    The ground acceleration is what the list says at period 0, or at the shortest one.
    """
    periods, values = np.array(points, float).T

    def acceleration(at: np.ndarray) -> np.ndarray:
        return np.interp(at, periods, values)

    return TargetSpectrum(acceleration, float(values[0]), damping, "given spectrum")
