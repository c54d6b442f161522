"""Housner's rocking block: full nonlinear equations, event by event; independent of dem_cli.

A rigid rectangle on a rigid, rough base that moves with the acceleration (a, a_v). Turns are counter-clockwise; at
θ > 0 the block stands on its lower left corner, s = sgn θ, R half its diagonal, tan α = width / height:

    θ'' = −p² [s sin(α − |θ|) (1 + a_v/g) − (a/g) cos(α − |θ|)],   p² = 3 g / (4 R)

It starts from rest where |a| cos α > (g + a_v) sin α. Where it comes back to θ = 0 it goes on about the other corner
with ω⁺ = e ω⁻ (Housner 1963; e = 1 − 1.5 sin² α keeps the moment of momentum about the new corner).
Integrated by Runge–Kutta of order 4 between the breaks of the base motion; impacts and starts are found to round-off.
"""

from __future__ import annotations

from math import cos, floor, inf, pi, sin
from typing import NamedTuple

import numpy as np
from numba import njit

from oracle.base_motion import REST, Motion, Sine

STILL = 1e-9  # of p: slower than this after an impact is at rest
ENOUGH = 1e-12  # of g: by how much a push must exceed what the block resists
NO_VALUES = np.zeros(2)


class Block(NamedTuple):
    """A rectangle."""

    width: float  # [m]
    height: float  # [m]
    gravity: float = 9.81  # [m/s2]

    @property
    def alpha(self) -> float:
        return float(np.arctan2(self.width, self.height))

    @property
    def radius(self) -> float:
        return float(0.5 * np.hypot(self.width, self.height))

    @property
    def p(self) -> float:
        return float(np.sqrt(0.75 * self.gravity / self.radius))

    @property
    def restitution(self) -> float:
        return 1.0 - 1.5 * sin(self.alpha) ** 2

    @classmethod
    def of(cls, alpha: float, p: float, gravity: float = 9.81) -> Block:
        """The block with this slenderness angle [rad] and frequency parameter [rad/s]."""
        radius = 0.75 * gravity / p**2
        return cls(2.0 * radius * sin(alpha), 2.0 * radius * cos(alpha), gravity)


class Rocking(NamedTuple):
    """What the block did, at the ends of all steps."""

    times: np.ndarray  # [s], (n,)
    angles: np.ndarray  # θ [rad], (n,)
    speeds: np.ndarray  # ω [rad/s], (n,)
    impacts: np.ndarray  # times of impacts [s]
    overturned: float  # time at which |θ| passed the bound [s]; inf: never

    @property
    def peak(self) -> float:
        """Largest |θ| at the end of a step [rad]."""
        return float(np.abs(self.angles).max())

    def extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and angles at which the block turns back between two steps, by the parabola through θ, ω and ω."""
        turn = np.flatnonzero((self.speeds[:-1] * self.speeds[1:] < 0.0) & (self.angles[:-1] * self.speeds[:-1] > 0.0))
        w0, w1, h = self.speeds[turn], self.speeds[turn + 1], self.times[turn + 1] - self.times[turn]
        part = w0 / (w0 - w1)
        return self.times[turn] + part * h, self.angles[turn] + 0.5 * w0 * part * h


def rock(
    block: Block,
    motion: Motion = REST,
    duration: float = 10.0,
    *,
    vertical: Motion = REST,
    angle: float = 0.0,
    speed: float = 0.0,
    restitution: float | None = None,
    bound: float = 0.5 * pi,
    step: float = 1e-3,
) -> Rocking:
    """From θ = `angle`, ω = `speed` at t = 0. Steps end at the breaks of both motions and are no longer than `step`."""
    e = block.restitution if restitution is None else restitution
    ends = np.concatenate([[0.0, duration], motion.breaks, vertical.breaks])
    ends = np.unique(ends[(ends >= 0.0) & (ends <= duration)])
    ends = ends[np.concatenate([np.diff(ends) > 1e-12, [True]])]
    times = [np.linspace(a, b, int(np.ceil((b - a) / step)) + 1)[:-1] for a, b in zip(ends[:-1], ends[1:])]
    grid = np.concatenate([*times, [duration]])
    angles, speeds, impacts = np.zeros(len(grid)), np.zeros(len(grid)), np.zeros(100_000)
    angles[0], speeds[0] = angle, speed
    done, hits, over = _integrate(
        grid, angles, speeds, impacts, block.alpha, block.p, block.gravity, e, bound, _code(motion), _code(vertical)
    )
    assert hits < len(impacts), "more impacts than there is room for"
    return Rocking(grid[:done], angles[:done], speeds[:done], impacts[:hits].copy(), over)


def overturns(block: Block, motion: Motion, duration: float, **how) -> bool:
    """Whether |θ| passes the bound within the duration."""
    return bool(np.isfinite(rock(block, motion, duration, **how).overturned))


def _code(motion: Motion):
    """A motion as numbers that compiled code takes."""
    if isinstance(motion, Sine):
        sine = (motion.amplitude, 2.0 * pi * motion.frequency, motion.phase, motion.duration)
        return (0, *map(float, sine), NO_VALUES)
    return (1, 1.0 / motion.dt, 0.0, 0.0, float(motion.duration), motion.values)


@njit(cache=True)
def _acceleration(t, middle, m):
    """Of the motion `m` at t, of the piece that `middle` lies in."""
    if middle > m[4]:
        return 0.0
    if m[0] == 0:
        return m[1] * sin(m[2] * t + m[3])
    k = min(floor(middle * m[1]), len(m[5]) - 2)
    return m[5][k] + (t * m[1] - k) * (m[5][k + 1] - m[5][k])


@njit(cache=True)
def _pull(t, middle, angle, s, alpha, p, g, m, mv):
    """θ'' on the side s."""
    phi = alpha - s * angle
    weight = g + _acceleration(t, middle, mv)
    return -p * p / g * (s * sin(phi) * weight - cos(phi) * _acceleration(t, middle, m))


@njit(cache=True)
def _advance(t, h, angle, speed, s, middle, alpha, p, g, m, mv):
    """θ and ω after h, by the classical method of order 4 (Nyström's form)."""
    k1 = _pull(t, middle, angle, s, alpha, p, g, m, mv)
    k2 = _pull(t + h / 2, middle, angle + h / 2 * speed, s, alpha, p, g, m, mv)
    k3 = _pull(t + h / 2, middle, angle + h / 2 * speed + h * h / 4 * k1, s, alpha, p, g, m, mv)
    k4 = _pull(t + h, middle, angle + h * speed + h * h / 2 * k2, s, alpha, p, g, m, mv)
    return angle + h * speed + h * h / 6 * (k1 + k2 + k3), speed + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


@njit(cache=True)
def _start(t, left, middle, alpha, g, m, mv):
    """How long the block still rests within `left`, and the side to which it then turns (0: it rests on)."""
    s = 0.0
    low, high = 0.0, left
    for k in range(2):
        later = t + k * left
        spare = abs(_acceleration(later, middle, m)) * cos(alpha) - (g + _acceleration(later, middle, mv)) * sin(alpha)
        if spare > ENOUGH * g:
            s = 1.0 if _acceleration(later, middle, m) > 0.0 else -1.0
            if k == 0:
                return 0.0, s
            break
    if s == 0.0:
        return left, s
    for _ in range(60):
        half = 0.5 * (low + high)
        a = s * _acceleration(t + half, middle, m)
        if a * cos(alpha) > (g + _acceleration(t + half, middle, mv)) * sin(alpha) + ENOUGH * g:
            high = half
        else:
            low = half
    return high, s


@njit(cache=True)
def _impact(t, h, angle, speed, s, middle, alpha, p, g, m, mv):
    """When, within h, the block is back at θ = 0 (it is past it after h), and its speed then."""
    low, high, at = 0.0, h, h
    for _ in range(60):
        now, w = _advance(t, at, angle, speed, s, middle, alpha, p, g, m, mv)
        if s * now <= 0.0:
            high = at
        else:
            low = at
        new = at - now / w if s * w < 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - at) <= 1e-16 * h:
            break
        at = new
    return at, w


@njit(cache=True)
def _integrate(grid, angles, speeds, impacts, alpha, p, g, e, bound, m, mv):
    """Fills `angles` and `speeds`; returns how many steps there are, the impacts, the time of overturning."""
    hits = 0
    angle, speed = angles[0], speeds[0]
    s = 0.0  # at rest
    if angle != 0.0:
        s = 1.0 if angle > 0.0 else -1.0
    elif speed != 0.0:
        s = 1.0 if speed > 0.0 else -1.0
    for n in range(len(grid) - 1):
        t, left = grid[n], grid[n + 1] - grid[n]
        middle = 0.5 * (grid[n] + grid[n + 1])
        while left > 0.0:
            if s == 0.0:
                wait, s = _start(t, left, middle, alpha, g, m, mv)
                t, left = t + wait, left - wait
                continue
            new, w = _advance(t, left, angle, speed, s, middle, alpha, p, g, m, mv)
            if s * new > 0.0 or hits == len(impacts):
                angle, speed, left = new, w, 0.0
                continue
            h, w = _impact(t, left, angle, speed, s, middle, alpha, p, g, m, mv)
            impacts[hits] = t + h
            hits += 1
            t, left, angle, speed = t + h, left - h, 0.0, e * w
            s = 1.0 if speed > 0.0 else -1.0
            if abs(speed) < STILL * p:
                s, speed = 0.0, 0.0
        angles[n + 1], speeds[n + 1] = angle, speed
        if abs(angle) > bound:
            return n + 2, hits, grid[n + 1]
    return len(grid), hits, inf
