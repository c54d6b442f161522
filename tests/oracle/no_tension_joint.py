"""Joints that press and do not pull: rotation of a joint under an eccentric force, panels that rock on one, columns.

Written from the pressure p = kn ⟨overlap⟩ alone, and used by tests as what the program did not write. All per metre of
depth where a depth is not named.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq, fsolve, minimize_scalar


def rotation(force: float, arm: float, width: float, kn: float) -> float:
    """Turn [rad] of a joint `width` [m] long under a force [N/m] that is `arm` [m] off its middle; sign of the arm."""
    e = abs(arm)
    if e <= width / 6.0:
        return math.copysign(12.0 * force * e / (kn * width**3), arm)
    pressed = 3.0 * (width / 2.0 - e)
    return math.copysign(2.0 * force / (kn * pressed**2), arm)


def arm_of(force: float, turn: float, width: float, kn: float) -> float:
    """How far off the middle of the joint its force is [m] at a turn [rad]: the inverse of `rotation`."""
    pressed = math.sqrt(2.0 * force / (kn * abs(turn))) if turn else math.inf
    e = kn * width**3 * abs(turn) / (12.0 * force) if pressed >= width else width / 2.0 - pressed / 3.0
    return math.copysign(e, turn)


def turns_of_a_rectangle(force: float, arms: tuple[float, float], sides: tuple[float, float], kn: float) -> np.ndarray:
    """Slopes (∂u/∂x, ∂u/∂y) of the closing of a rectangular face under a force at `arms` off its middle, by strips."""
    x, weights = np.polynomial.legendre.leggauss(400)
    x, weights = 0.5 * sides[0] * x, 0.5 * sides[0] * weights

    def of_strips(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and first moment along y of strips by the closing at both ends, where it is positive."""
        slope = (high - low) / sides[1]
        first = np.where(low > 0.0, 0.0, np.where(slope > 0.0, -low / np.where(slope == 0.0, 1.0, slope), sides[1]))
        last = np.where(high > 0.0, sides[1], np.where(slope < 0.0, -low / np.where(slope == 0.0, 1.0, slope), 0.0))
        last = np.maximum(first, last)
        force = low * (last - first) + slope * (last**2 - first**2) / 2.0
        moment = low * (last**2 - first**2) / 2.0 + slope * (last**3 - first**3) / 3.0
        return kn * force, kn * (moment - force * sides[1] / 2.0)

    def missing(closing: np.ndarray) -> np.ndarray:
        middle, along_x, along_y = closing * unit
        at = middle + along_x * x
        forces, moments = of_strips(at - along_y * sides[1] / 2.0, at + along_y * sides[1] / 2.0)
        total = weights @ forces
        return np.array(
            [total / force - 1.0, weights @ (x * forces) / force - arms[0], weights @ moments / force - arms[1]]
        )

    unit = force / (kn * sides[0] * sides[1]) * np.array([1.0, 1.0 / sides[0], 1.0 / sides[1]])
    found = fsolve(missing, np.array([1.0, 12.0 * arms[0] / sides[0], 12.0 * arms[1] / sides[1]]), xtol=1e-12)
    assert np.abs(missing(found)).max() < 1e-9
    return (found * unit)[1:]


class Panel:
    """A rigid block on a joint that does not pull, pushed at a height [m]; `top` [N]: a force on its top that stays."""

    def __init__(self, width: float, height: float, weight: float, kn: float, pushed_at: float, top: float = 0.0):
        self.width, self.height, self.weight, self.kn, self.pushed_at, self.top = (
            width,
            height,
            weight,
            kn,
            pushed_at,
            top,
        )

    def push(self, turn: float) -> float:
        """Horizontal force [N] that holds it at a turn [rad]: moments about the middle of its foot."""
        lean, total = (self.weight / 2.0 + self.top) * self.height, self.weight + self.top
        c, s, push = math.cos(turn), math.sin(turn), 0.0
        for _ in range(20):  # the push presses on the joint as well, since it is not quite level
            arm = arm_of(total * c - push * s, turn, self.width, self.kn)
            push = (total * arm * c - lean * s) / (self.pushed_at * c + arm * s)
        return push

    def moved(self, turn: float) -> float:
        """How far its centre goes [m]: it rolls on the place where its joint presses."""
        arm = arm_of(self.weight + self.top, turn, self.width, self.kn)
        return self.height / 2.0 * math.sin(turn) + arm * (1.0 - math.cos(turn))

    @property
    def strength(self) -> float:
        """The largest push on the way [N]."""
        least = 6.0 * (self.weight + self.top) / (self.kn * self.width**2)
        found = minimize_scalar(
            lambda t: -self.push(t), bounds=(0.1 * least, self.last), method="bounded", options={"xatol": 1e-12}
        )
        return float(-found.fun)

    @property
    def last(self) -> float:
        """The turn [rad] at which it stands without a push, on its way over."""
        return float(brentq(self.push, 0.2 * self.width / self.height, 3.0 * self.width / self.height))


def tip_of_column(n: int, side: float, weight: float, load: float, arm: float, kn: float) -> float:
    """How far the top of n square blocks on each other goes sideways [m] under a load `arm` off its middle.

    Blocks have `weight` [N/m], and the force goes along with its point. Each joint turns by its force and its arm.
    """

    def centres(turns: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Middles of the joints under all blocks, of the blocks, and the point of the load."""
        along = np.column_stack([np.sin(turns), np.cos(turns)])
        feet = np.vstack([np.zeros(2), np.cumsum(side * along, axis=0)])
        top = feet[-1] + arm * np.array([math.cos(turns[-1]), -math.sin(turns[-1])])
        return feet[:-1], feet[:-1] + 0.5 * side * along, top

    def missing(turns: np.ndarray) -> np.ndarray:
        feet, middles, top = centres(turns)
        found = np.zeros(n)
        for k in range(n):
            force = load + weight * (n - k)
            moment = load * (top[0] - feet[k, 0]) + weight * (middles[k:, 0] - feet[k, 0]).sum()
            below = turns[k - 1] if k else 0.0
            found[k] = turns[k] - below - rotation(force, moment / force, side, kn)
        return found / rotation(load, arm, side, kn)

    turns, step = np.zeros(n), 0.0
    for step in np.linspace(0.1, 1.0, 10):  # load by load: fsolve needs a start that is near
        full, load = load, step * load
        turns, _, state, words = fsolve(missing, turns, full_output=True, xtol=1e-12)
        load = full
        assert state == 1 or np.abs(missing(turns)).max() < 1e-6 or step < 1.0, words
    return float(side * np.sin(turns).sum())
