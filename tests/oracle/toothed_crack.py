"""Toothed crack through a wall in running bond that is bent about a vertical axis: head joints open, beds are twisted.

Two rigid halves turn against each other about the vertical through the middle of every joint, and shift along the wall
until no force is left. Points are brittle, the worst cracks first; cracked head joints stay contacts. Heads do
not slide, nothing presses the beds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from oracle.brittle_plate import Rule


class Toothed(NamedTuple):
    """The crack: lengths [m], strengths [Pa], stiffness [Pa/m]."""

    overlap: float
    height: float
    thickness: float
    tension: float
    cohesion: float
    kn: float
    ks: float


def strength(crack: Toothed, rule: Rule, steps: int = 400) -> float:
    """Highest moment over h t²/6 while the halves turn, up to where no bed holds any more [Pa]."""
    a, h, t = crack.overlap, crack.height, crack.thickness
    across, along = 0.5 * t * rule.places[:, 1], 0.5 * a * rule.places[:, 0]
    head, bed = h * t * rule.shares, a * t * rule.shares
    heads, beds = np.ones(len(head), bool), np.ones(len(bed), bool)
    far, most = 6.0 * crack.cohesion / (crack.ks * min(a, t)), 0.0
    for turn in np.linspace(0.0, far, steps + 1)[1:]:
        while True:
            shift = _shift(crack, turn, across, head, bed, heads, beds)
            gap = shift - turn * across
            pulled = crack.kn * head * np.where(heads | (gap < 0.0), gap, 0.0)
            sheared = crack.ks * bed * np.hypot(gap, turn * along)
            over = np.concatenate([heads * pulled / (crack.tension * head), beds * sheared / (crack.cohesion * bed)])
            if over.max() <= 1.0:
                break
            fails = over >= over.max() * (1.0 - 1e-9)  # alike ones together
            heads &= ~fails[: len(head)]
            beds &= ~fails[len(head) :]
        twist = crack.ks * (bed * (turn * (across**2 + along**2) - shift * across))[beds].sum()
        most = max(most, (twist - (pulled * across).sum()) / (h * t**2 / 6.0))
    return float(most)


def beds_alone(crack: Toothed) -> float:
    """Closed form where beds are soft beside heads: turning about the pressed edge they fail at the far corner [Pa]."""
    a, h, t = crack.overlap, crack.height, crack.thickness
    return crack.cohesion * a * np.sqrt(a**2 + 4.0 * t**2) / (h * t)


def _shift(
    crack: Toothed,
    turn: float,
    across: np.ndarray,
    head: np.ndarray,
    bed: np.ndarray,
    heads: np.ndarray,
    beds: np.ndarray,
) -> float:
    """How far the halves part at the middle of the wall [m]; the force along the wall grows with it: bisection."""
    low, high = -turn * np.abs(across).max() * 1.001, turn * np.abs(across).max() * 1.001
    for _ in range(60):
        middle = 0.5 * (low + high)
        gap = middle - turn * across
        force = crack.kn * (head * gap)[heads | (gap < 0.0)].sum() + crack.ks * (bed * gap)[beds].sum()
        low, high = (middle, high) if force < 0.0 else (low, middle)
    return 0.5 * (low + high)
