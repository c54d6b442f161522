"""The column as one rigid block that rocks on its foot, exactly (tests/oracle/housner.py)."""

from __future__ import annotations

import math

import numpy as np

from oracle.base_motion import Record
from oracle.housner import Block, overturns

FOOT, TOP, HEIGHT = 1.11, 0.90, 5.95  # m
GRAVITY = 9.81
PIECES = 200  # samples per tp


def block() -> tuple[Block, float]:
    """The rectangle with its slenderness and frequency parameter, and its restitution 1 − 2 M R² sin² α / I."""
    taper = FOOT - TOP
    area = 0.5 * (FOOT + TOP) * HEIGHT
    y = np.polynomial.Polynomial([0.0, 1.0])
    width = FOOT - taper / HEIGHT * y

    def over_height(p) -> float:
        return float(p.integ()(HEIGHT))

    height = over_height(width * y) / area  # of the centroid
    corner = over_height(width * (y**2) + width**3 / 12.0) / area + (0.5 * FOOT) ** 2  # inertia about a corner / mass
    radius = math.hypot(0.5 * FOOT, height)
    alpha = math.atan2(0.5 * FOOT, height)
    p = math.sqrt(GRAVITY * radius / corner)
    return Block.of(alpha, p, GRAVITY), 1.0 - 2.0 * (radius * math.sin(alpha)) ** 2 / corner


def impulse(amplitude: float, tp: float) -> Record:
    """+a for tp, −a/2 for 2 tp [m/s2]; jumps are one sample wide and leave the velocities what they are."""
    values = np.concatenate([np.full(PIECES, 1.0), [0.25], np.full(2 * PIECES - 1, -0.5), [-0.25, 0.0]])
    return Record(tp / PIECES, amplitude * values)


def falls(amplitude: float, tp: float) -> bool:
    """amplitude in g."""
    made, restitution = block()
    return overturns(made, impulse(amplitude * GRAVITY, tp), 3.0 * tp + 8.0, restitution=restitution, bound=1.0)
