"""A box that slides and spins on four corners with Coulomb friction: ordinary differential equations.

Its corners carry the weight as four equal springs do: N_i = W/4 plus a plane over the foot that balances the moment of
friction at half the height. Each corner slides: friction μ N_i against its velocity. The foot stays level.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

STILL = 1e-6  # of the first speed: slower corners have stopped


class Rest(NamedTuple):
    """Where and when it stops."""

    time: float  # [s]
    place: np.ndarray  # [m], (2,)
    angle: float  # [rad]


class SlidingPad(NamedTuple):
    """A box of length along x, width along y; its mass does not matter."""

    length: float  # [m]
    width: float  # [m]
    height: float  # [m]
    friction: float
    gravity: float = 9.81  # [m/s2]

    def stops(self, velocity: tuple[float, float], spin: float) -> Rest:
        """From the origin, unturned, with a velocity [m/s] and a spin [rad/s] about the vertical."""
        radius = 0.5 * np.hypot(self.length, self.width)
        first = float(np.hypot(*velocity) + abs(spin) * radius)

        def slow(_, state):
            return float(np.hypot(state[3], state[4]) + abs(state[5]) * radius - STILL * first)

        slow.terminal, slow.direction = True, -1.0
        start = [0.0, 0.0, 0.0, *velocity, spin]
        end = 4.0 * first / (self.friction * self.gravity)
        found = solve_ivp(self._rates, (0.0, end), start, events=slow, rtol=1e-10, atol=1e-13, max_step=end / 400.0)
        if not len(found.t_events[0]):
            raise RuntimeError("the pad did not stop")
        state = found.y_events[0][0]
        return Rest(float(found.t_events[0][0]), state[:2], float(state[2]))

    def _rates(self, _, state) -> list[float]:
        c, s = np.cos(state[2]), np.sin(state[2])
        turn = np.array([[c, -s], [s, c]])
        signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        arms = 0.5 * signs * [self.length, self.width] @ turn.T
        rates = state[3:5] + state[5] * np.column_stack([-arms[:, 1], arms[:, 0]])
        ways = rates / np.maximum(np.hypot(*rates.T), 1e-300)[:, None]
        shares = self._shares(arms, ways)
        pulls = -self.friction * self.gravity * shares[:, None] * ways  # of the mass
        moment = (arms[:, 0] * pulls[:, 1] - arms[:, 1] * pulls[:, 0]).sum()
        inertia = (self.length**2 + self.width**2) / 12.0
        return [*state[3:6], *pulls.sum(axis=0), moment / inertia]

    def _shares(self, arms: np.ndarray, ways: np.ndarray) -> np.ndarray:
        """N_i / W = 1/4 + g·r_i with Σ N_i r_i = ½ height · total friction, which depends on N_i: a fixed point."""
        second, gradient = arms.T @ arms, np.zeros(2)
        shares = np.full(4, 0.25)
        for _ in range(30):
            friction = -self.friction * (shares[:, None] * ways).sum(axis=0)
            # Friction at the foot, half the height below the centroid, moves the pressure against itself.
            gradient = np.linalg.solve(second, -0.5 * self.height * friction)
            shares = 0.25 + arms @ gradient
        return shares
