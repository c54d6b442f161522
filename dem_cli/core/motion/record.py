"""Accelerogram as a piecewise polynomial of time: its integrals are exact."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.small_matrices import least_squares
from dem_cli.core.motion.piecewise_polynomial import PiecewisePolynomial
from dem_cli.core.motion.record_text import RecordError

MOTION_QUANTITIES = ("acceleration", "velocity", "displacement")


class Accelerogram:
    """Accelerogram as piecewise polynomial of time from 0 (the contract: motion.py, `Waveform`).

    times (n,) are the samples [s], the first one 0; first is what that was where the samples come from [s].
    """

    def __init__(self, acceleration: PiecewisePolynomial, first: float = 0.0):
        self.first = first
        self.times = acceleration.x
        self.duration = float(self.times[-1])
        self.step = float(np.diff(self.times).min())
        self.polynomials = [acceleration, acceleration.antiderivative(1), acceleration.antiderivative(2)]
        self.peak = largest(acceleration)

    def acceleration(self, t: np.ndarray) -> np.ndarray:
        """Acceleration [m/s2] at times t [s]."""
        return self.polynomials[0](t)

    def velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] at times t [s]."""
        return self.polynomials[1](t)

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """Displacement [m] at times t [s]."""
        return self.polynomials[2](t)


def record(
    times: np.ndarray, values: np.ndarray, quantity: str = "acceleration", baseline: int | None = None
) -> Accelerogram:
    """Build an accelerogram from samples at increasing times, even or not; the first time becomes 0.

    acceleration  linear between the samples
    velocity      a cubic spline (not-a-knot) through the samples, less the first of them: acceleration is quadratic
    displacement  a cubic spline through the samples, less the first, that starts with velocity 0: acceleration linear
    baseline      order of a polynomial taken from the acceleration, see `corrected`; None for none

    times [s], values [m/s2, m/s or m], both (n,), n ≥ 2. Raises RecordError as `corrected` does.
    """
    first = float(times[0])
    times, values = np.asarray(times, float) - first, np.asarray(values, float)
    if quantity == "acceleration":
        acceleration = PiecewisePolynomial(np.stack((np.diff(values) / np.diff(times), values[:-1])), times)
    else:
        acceleration = _through(times, values - values[0], quantity)
    return Accelerogram(acceleration if baseline is None else corrected(acceleration, baseline), first)


def _through(times: np.ndarray, values: np.ndarray, quantity: str) -> PiecewisePolynomial:
    """Compute the acceleration of a spline through velocities or displacements."""
    from scipy.interpolate import CubicSpline  # 0.25 s

    if quantity == "velocity":
        spline = CubicSpline(times, values).derivative(1)
    else:
        spline = CubicSpline(times, values, bc_type=((1, 0.0), "not-a-knot")).derivative(2)
    return PiecewisePolynomial(spline.c, spline.x)


def corrected(acceleration: PiecewisePolynomial, order: int) -> PiecewisePolynomial:
    """Correct the baseline: `acceleration` less the polynomial of this order whose integral comes closest to the
    velocity.

    Closest in the sense of least squares over the samples, each with the time around it as its weight. The integral
    is 0 at the start, so that the corrected velocity starts at 0 too; it ends near 0, not at it. Where it would end
    faster than it was, the closest of those polynomials is taken whose integral is the velocity at the end.
    Raises RecordError where there are fewer samples than it needs.
    """
    from numpy.polynomial import Polynomial

    times = acceleration.x
    if len(times) < order + 2:
        raise RecordError(f"a baseline of order {order} needs at least {order + 2} samples; there are {len(times)}")
    end = times[-1]
    powers = np.arange(1, order + 2)
    weights = np.sqrt(np.gradient(times))
    basis = functions.power(times[:, None] / end, powers)
    velocity = acceleration.antiderivative()(times)
    fitted = least_squares(weights[:, None] * basis, weights * velocity)
    if abs(velocity[-1] - fitted.sum()) > abs(velocity[-1]):  # the last coefficient makes the sum that at the end
        others, last = basis[:, :-1] - basis[:, -1:], basis[:, -1]
        free = least_squares(weights[:, None] * others, weights * (velocity - velocity[-1] * last))
        fitted = np.append(free, velocity[-1] - free.sum())
    drift = Polynomial([0.0, *(fitted / functions.power(end, powers))]).deriv()  # of the acceleration
    taylor, factorial = [], 1.0  # about the start of each piece, lowest power first
    for k in range(order + 1):
        factorial *= max(k, 1)
        taylor.append((drift.deriv(k) if k else drift)(times[:-1]) / factorial)
    rows = max(order + 1, acceleration.c.shape[0])
    pieces = np.zeros((rows, len(times) - 1))
    pieces[rows - acceleration.c.shape[0] :] = acceleration.c
    pieces[rows - order - 1 :] -= np.array(taylor[::-1])
    return PiecewisePolynomial(pieces, times)


def largest(polynomial: PiecewisePolynomial) -> float:
    """Find the largest absolute value of a piecewise polynomial."""
    values = [*polynomial.c[-1], float(polynomial(polynomial.x[-1]))]
    if polynomial.c.shape[0] > 2:  # higher than linear: crests between the samples
        from scipy.interpolate import PPoly

        slope = PPoly(polynomial.c, polynomial.x).derivative()
        crests = slope.roots(discontinuity=False, extrapolate=False)
        values += [*polynomial(crests[np.isfinite(crests)])]
    return float(np.abs(values).max())
