"""Maxwell elements beside the springs of all joints, in closed form: an elastic mode, and a block that meets a joint.

With elements of stiffness share r and rate a (dem: r = 4 ξ, a = 2π f) beside every spring, the stiffness matrix is
K (1 + Σ r s/(s + a)): modes keep their shapes, and each answers s² + ω² (1 + Σ r s/(s + a)) = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from scipy.linalg import expm
from scipy.optimize import brentq

PUBLISHED = ((0.0385, 1.0), (0.0335, 7.1), (0.052, 50.0))  # ratio, frequency [Hz]


def stiffness(frequency: float, elements: Sequence[tuple[float, float]] = PUBLISHED) -> complex:
    """Of a joint at a frequency [Hz], over that of its spring."""
    return 1.0 + sum(4.0 * ratio * 1j * frequency / (1j * frequency + at) for ratio, at in elements)


def of_mode(frequency: float, elements: Sequence[tuple[float, float]] = PUBLISHED) -> tuple[float, float]:
    """Damping ratio and frequency [Hz] of a mode that has `frequency` [Hz] on the springs alone."""
    rates = [(4.0 * ratio, 2.0 * math.pi * at) for ratio, at in elements]
    s = Polynomial([0.0, 1.0])
    every = math.prod((s + a for _, a in rates), start=Polynomial([1.0]))
    held = every + sum(
        r * s * math.prod((s + b for j, (_, b) in enumerate(rates) if j != i), start=Polynomial([1.0]))
        for i, (r, _) in enumerate(rates)
    )
    roots = (s * s * every + (2.0 * math.pi * frequency) ** 2 * held).roots()
    swinging = roots[np.argmax(roots.imag)]
    return float(-swinging.real / abs(swinging)), float(abs(swinging) / (2.0 * math.pi))


class Joint(NamedTuple):
    """A mass on a joint with one Maxwell element beside its spring: m u'' = −k u − F, F' = r k u' − a F; no gravity."""

    stiffness: float  # k, of all contact points [N/m]
    mass: float  # [kg]
    share: float  # r, stiffness of the element over k
    rate: float  # a, of its relaxation [1/s]


def motion(joint: Joint, speed: float, times: np.ndarray) -> np.ndarray:
    """Overlap u [m], its rate [m/s] and F [N] after touching with `speed`, closed, with nothing held: (n, 3)."""
    k, m = joint.stiffness, joint.mass
    states = np.array([[0.0, 1.0, 0.0], [-k / m, 0.0, -1.0 / m], [0.0, joint.share * k, -joint.rate]])
    return np.array([expm(states * t) @ (0.0, speed, 0.0) for t in np.atleast_1d(times)])


def leaving(joint: Joint, speed: float) -> tuple[float, float, float]:
    """When a joint that does not pull carries nothing any more [s], the overlap then [m] and the speed of leaving."""

    def force(t: float) -> float:
        u, _, held = motion(joint, speed, t)[0]
        return float(joint.stiffness * u + held)

    half = math.pi / math.sqrt(joint.stiffness * (1.0 + joint.share) / joint.mass)
    end = brentq(force, 0.5 * half, 1.5 * half, xtol=1e-15)
    u, rate, _ = motion(joint, speed, end)[0]
    return end, float(u), float(-rate)
