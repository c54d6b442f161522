"""Piecewise polynomials of time and their integrals, as scipy's PPoly has them to the last digit.

A record is linear between its samples, and scipy.interpolate takes a quarter of a second to load.
"""

from __future__ import annotations

import math

import numpy as np

AT_ONCE = 8192  # times that are worked out together: their coefficients stay in the cache


class PiecewisePolynomial:
    """Piecewise polynomial in the time since the sample before.

    c (k, n − 1): coefficients of every piece, the highest power first; x (n,): increasing times of the samples [s].
    """

    def __init__(self, c: np.ndarray, x: np.ndarray) -> None:
        self.c, self.x = c, x

    def __call__(self, t: np.ndarray | float) -> np.ndarray:
        """Evaluate at times t [s], of any shape; before the first sample and behind the last by the nearest piece."""
        times = np.asarray(t, float)
        flat = times.ravel()
        parts = [self._values(flat[first : first + AT_ONCE]) for first in range(0, len(flat), AT_ONCE)]
        return np.concatenate(parts or [flat]).reshape(times.shape)

    def _values(self, times: np.ndarray) -> np.ndarray:
        piece = np.minimum(np.maximum(self.x.searchsorted(times, side="right") - 1, 0), len(self.x) - 2)
        since = times - self.x[piece]
        values, power = self.c[-1][piece], since.copy()
        for coefficients in self.c[-2::-1]:
            values += coefficients[piece] * power
            power *= since
        return values

    def antiderivative(self, order: int = 1) -> PiecewisePolynomial:
        """Integrate from the first sample on, once or twice."""
        k, pieces = self.c.shape
        raised = np.zeros((k + order, pieces))
        for power, coefficients in enumerate(self.c[::-1]):
            raised[k - 1 - power] = coefficients / math.perm(power + order, order)
        steps = np.diff(self.x[:-1])
        for derivative in reversed(range(order)):  # is continuous: a piece starts from what those before it gained
            gained, rise = [], np.ones(len(steps))
            for power in range(derivative + 1, k + order):
                rise = rise * steps
                gained.append(raised[-1 - power, :-1] * rise * math.perm(power, derivative))
            summed = np.cumsum(np.ravel(gained, order="F"))
            raised[-1 - derivative, 1:] = summed[len(gained) - 1 :: len(gained)]
        return PiecewisePolynomial(raised, self.x)
