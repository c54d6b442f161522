"""A rigid block on an elastic bed without tension: motion in the plane by its differential equation, without dem.

The bed is level and presses upwards, p = kn (d + τ ḋ) where the face is d deep, never less than nothing; a spring and a
dashpot along it hold the face at the centre of pressure. Sums over strips of the face stand for integrals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

LETS_GO = 1e-4  # s in which a block in the air loses the force along the bed


@dataclass(frozen=True)
class WinklerBlock:
    """A block of `width` × `height` [m], a metre thick; kn, ks [Pa/m]: the bed; delay: damping over stiffness [s]."""

    width: float
    height: float
    density: float
    kn: float
    ks: float
    delay: float = 0.0
    strips: int = 400
    gravity: float = 9.81

    @property
    def mass(self) -> float:
        return self.density * self.width * self.height

    @property
    def inertia(self) -> float:
        return self.mass * (self.width**2 + self.height**2) / 12.0

    @property
    def sunk(self) -> float:
        """How deep the block stands [m]."""
        return self.mass * self.gravity / (self.kn * self.width)

    def rates(self, _: float, state: np.ndarray) -> list[float]:
        """d/dt of (x, y, θ, their rates, shear force); x, y: of the centroid."""
        _, y, turn, vx, vy, spin, shear = state
        s, c = math.sin(turn), math.cos(turn)
        along = ((np.arange(self.strips) + 0.5) / self.strips - 0.5) * self.width
        arm_x, arm_y = c * along + 0.5 * self.height * s, s * along - 0.5 * self.height * c
        deep, sinks = -(y + arm_y), -(vy + spin * arm_x)
        closed = np.clip(0.5 + deep / (abs(s) * self.width / self.strips + 1e-300), 0.0, 1.0)  # share of a strip
        pressure = closed * np.maximum(self.kn * (np.maximum(deep, 0.0) + self.delay * sinks), 0.0)
        force = pressure.mean() * self.width
        moment = (pressure * arm_x).mean() * self.width
        at_x = moment / force if force > 0.0 else 0.0
        at_y = float(np.interp(at_x, arm_x, arm_y))
        slides = vx - spin * at_y
        held, touches = self.ks * self.width, force > 0.0
        push = shear - held * self.delay * closed.mean() * slides if touches else 0.0
        change = -held * slides if touches else -shear / LETS_GO
        turning = (moment - at_y * push) / self.inertia
        return [vx, vy, spin, push / self.mass, force / self.mass - self.gravity, turning, change]

    def motion(self, velocity: tuple[float, float, float], times: np.ndarray) -> np.ndarray:
        """Motion (x, y, θ) from where it is drawn, (n_times, 3); it rests but for this velocity and spin."""
        start = [0.0, 0.5 * self.height - self.sunk, 0.0, *velocity, 0.0]
        period = 2.0 * math.pi * math.sqrt(self.mass / (max(self.kn, self.ks) * self.width))
        found = solve_ivp(
            self.rates, (0.0, times[-1]), start, t_eval=times, rtol=1e-8, atol=1e-11, max_step=period / 20.0
        )
        return found.y[:3].T - [0.0, 0.5 * self.height, 0.0]
