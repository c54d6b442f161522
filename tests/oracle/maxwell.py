"""Maxwell elements beside the springs of all joints, in closed form: damping and frequency of an elastic mode.

With elements of stiffness share r and rate a (dem: r = 4 ξ, a = 2π f) beside every spring, the stiffness matrix is
K (1 + Σ r s/(s + a)): modes keep their shapes, and each answers s² + ω² (1 + Σ r s/(s + a)) = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.polynomial import Polynomial

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
