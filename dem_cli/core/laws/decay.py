"""Strength that decays exponentially with the slip: where the spring meets the curve."""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import inline

MOST_STEPS = 50  # of Newton's iteration; 3 to 6 are usual


@inline
def slip_on_decay(force, stiffness, floor, drop, rate):
    """Solve force − stiffness x = floor + drop exp(−rate x) for the slip x; force is above the curve at x = 0.

    The difference of the two sides is convex and changes sign once for x > 0, however steep the decay; Newton's
    iteration from beyond the root comes down to it without fail.
    """
    x = (force - floor) / stiffness
    for _ in range(MOST_STEPS):
        above = drop * math.exp(-rate * x)
        step = (stiffness * x + floor + above - force) / (stiffness - rate * above)
        x -= step
        if step <= 1e-15 * x:
            break
    return x
