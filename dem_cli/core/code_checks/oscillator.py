"""Equivalent single degree of freedom of a structure that moves in one shape: participation of its masses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Participation(NamedTuple):
    """Participation of masses m in a shape φ; φ is 1 on average by mass, as the displacement of a load by mass is."""

    mass: float  # of all blocks that count, Σ m [kg]
    factor: float  # Γ = Σ m φ / Σ m φ² [-]: displacement of the load over that of the oscillator
    effective_mass: float  # M* = (Σ m φ)² / Σ m φ² [kg]

    @property
    def share(self) -> float:
        """Participating share of the mass, e* = M* / Σ m [-]."""
        return self.effective_mass / self.mass


def participation(masses: np.ndarray, shape: np.ndarray, least: float = 0.0) -> Participation:
    """Compute the participation of masses [kg], (n,), from their displacements along the load, (n,), in any unit.

    least: blocks that move less than this share of the farthest do not count. Source: EN 1998-1:2004, B.2; circular
    617/2009 to the Italian code of 2008, C8A.4.2.2, in which weights stand for masses. Raises ValueError where the
    masses do not move along the load on average.
    """
    counts = np.abs(shape) >= least * np.abs(shape).max(initial=0.0)
    m, moved = masses[counts], shape[counts]
    first, second = float((m * moved).sum()), float((m * moved**2).sum())
    if first <= 0.0 or second <= 0.0:
        raise ValueError("the masses do not move along the load")
    mass = float(m.sum())
    # The mean of φ over all masses is 1, also of those that do not count: that is the displacement of the curve.
    scale = float((masses * shape).sum() / masses.sum())
    return Participation(mass, first / second * scale, first**2 / second)


def secant_period(displacement: float, acceleration: float) -> float:
    """Compute the secant period 2π √(d/a) [s] of a displacement [m] at a spectral acceleration [m/s2]."""
    return float(2.0 * np.pi * np.sqrt(displacement / acceleration))


def elastic_displacement(period: float, acceleration: float) -> float:
    """Compute the spectral displacement [m] at a period [s] from a spectral acceleration [m/s2]: a (T/2π)²."""
    return acceleration * (period / (2.0 * np.pi)) ** 2
