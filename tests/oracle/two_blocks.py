"""Two rigid blocks on each other that rock freely, on a rigid base without sliding, until a joint closes.

Modes of Psycharis (1990) and Spanos, Roussis and Politis (2001): both blocks rock, or the upper alone. Each turns about
a corner: the lower about one of its own on the base, the upper about one of its own on the top of the lower. Angles θ₁,
θ₂ are absolute, counter-clockwise: a positive angle, and a positive θ₂ − θ₁, is a turn about the left corner. With
J = turn by 90°, D from corner to corner, d₁ and d₂ from corner to centroid (turned with the blocks)

    r₁'' = θ₁'' J d₁ − θ₁'² d₁,   r₂'' = θ₁'' J D − θ₁'² D + θ₂'' J d₂ − θ₂'² d₂
    m₁ (r₁'' − g)·J d₁ + m₂ (r₂'' − g)·J D + I₁ θ₁'' = 0,   m₂ (r₂'' − g)·J d₂ + I₂ θ₂'' = 0
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.81  # [m/s2]


class Rectangle(NamedTuple):
    """A block; mass per thickness is its area times a density that cancels unless two blocks differ."""

    width: float  # [m]
    height: float  # [m]
    density: float = 1.0

    @property
    def mass(self) -> float:
        return self.width * self.height * self.density

    @property
    def inertia(self) -> float:
        return self.mass * (self.width**2 + self.height**2) / 12.0


class Motion(NamedTuple):
    """The motion up to the first closure."""

    times: np.ndarray  # [s], (n,)
    angles: np.ndarray  # θ₁, θ₂ [rad], (n, 2)
    speeds: np.ndarray  # [rad/s], (n, 2)
    closed: str | None  # "base" or "joint": which closed at the last time; None: none did in time
    forces: np.ndarray  # on the upper block from below, on the stack from the base: (n, 2, 2) [N]


def rock(lower: Rectangle, upper: Rectangle, angles, speeds=(0.0, 0.0), duration=5.0, samples=2001) -> Motion:
    """From absolute angles θ₁, θ₂, which say the corners; θ₁ = 0 and at rest: the upper block alone rocks."""
    alone = angles[0] == 0.0 and speeds[0] == 0.0
    stack = _Stack(lower, upper, np.sign(angles[0]), np.sign(angles[1] - angles[0]), alone)

    def rates(t, y):
        return np.concatenate([y[2:], stack.accelerations(y)])

    def base(t, y):
        return 1.0 if alone else stack.side1 * y[0]

    def joint(t, y):
        return stack.side2 * (y[1] - y[0])

    for event in (base, joint):
        event.terminal, event.direction = True, -1.0
    start = np.concatenate([angles, speeds]).astype(float)
    done = solve_ivp(
        rates, (0.0, duration), start, "DOP853", rtol=1e-12, atol=1e-14, events=(base, joint), dense_output=True
    )
    times = np.linspace(0.0, done.t[-1], samples)
    states = done.sol(times).T
    closed = None if done.status == 0 else ("base" if len(done.t_events[0]) else "joint")
    forces = np.array([stack.forces(y) for y in states])
    return Motion(times, states[:, :2], states[:, 2:], closed, forces)


class _Stack:
    def __init__(self, lower: Rectangle, upper: Rectangle, side1: float, side2: float, alone: bool) -> None:
        self.lower, self.upper, self.side1, self.side2, self.alone = lower, upper, side1, side2, alone
        left1 = -side1 * lower.width / 2  # of the corner on the base from the middle
        self.d1 = np.array([-left1, lower.height / 2])
        self.across = np.array([-side2 * upper.width / 2 - left1, lower.height])
        self.d2 = np.array([side2 * upper.width / 2, upper.height / 2])

    def accelerations(self, y) -> np.ndarray:
        """θ₁'', θ₂''."""
        m1, m2 = self.lower.mass, self.upper.mass
        d1, across, d2 = _turned(self.d1, y[0]), _turned(self.across, y[0]), _turned(self.d2, y[1])
        j1, ja, j2 = _quarter(d1), _quarter(across), _quarter(d2)
        up = np.array([0.0, GRAVITY])  # −g
        known1, known2 = up - y[2] ** 2 * d1, up - y[2] ** 2 * across - y[3] ** 2 * d2
        inertia2 = self.upper.inertia + m2 * d2 @ d2
        right2 = -m2 * known2 @ j2
        if self.alone:
            return np.array([0.0, right2 / inertia2])
        inertia1 = self.lower.inertia + m1 * d1 @ d1 + m2 * across @ across
        coupling = m2 * ja @ j2
        right1 = -m1 * known1 @ j1 - m2 * known2 @ ja
        return np.linalg.solve([[inertia1, coupling], [coupling, inertia2]], [right1, right2])

    def forces(self, y) -> np.ndarray:
        """On the upper block from the lower, on the lower from the base [N], (2, 2)."""
        turn1, turn2 = self.accelerations(y)
        d1, across, d2 = _turned(self.d1, y[0]), _turned(self.across, y[0]), _turned(self.d2, y[1])
        up = np.array([0.0, GRAVITY])
        a1 = turn1 * _quarter(d1) - y[2] ** 2 * d1
        a2 = turn1 * _quarter(across) - y[2] ** 2 * across + turn2 * _quarter(d2) - y[3] ** 2 * d2
        on_upper = self.upper.mass * (a2 + up)
        return np.array([on_upper, self.lower.mass * (a1 + up) + on_upper])

    def energy(self, y) -> float:
        """Kinetic and potential, zero level at the base [J]."""
        d1, across, d2 = _turned(self.d1, y[0]), _turned(self.across, y[0]), _turned(self.d2, y[1])
        v1, v2 = y[2] * _quarter(d1), y[2] * _quarter(across) + y[3] * _quarter(d2)
        kinetic = self.lower.mass * v1 @ v1 + self.upper.mass * v2 @ v2
        kinetic += self.lower.inertia * y[2] ** 2 + self.upper.inertia * y[3] ** 2
        potential = self.lower.mass * d1[1] + self.upper.mass * (across + d2)[1]
        return 0.5 * kinetic + GRAVITY * potential


def energies(lower: Rectangle, upper: Rectangle, motion: Motion) -> np.ndarray:
    """Total energy along a motion [J], (n,)."""
    side1, side2 = np.sign(motion.angles[0, 0]), np.sign(motion.angles[0, 1] - motion.angles[0, 0])
    stack = _Stack(lower, upper, side1, side2, side1 == 0.0)
    return np.array([stack.energy(np.concatenate(pair)) for pair in zip(motion.angles, motion.speeds)])


def _turned(arm: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])


def _quarter(arm: np.ndarray) -> np.ndarray:
    return np.array([-arm[1], arm[0]])
