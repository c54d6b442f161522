"""Friction and slip in the plane: reserves c± = μN ± T, slips a± either way, c± a± = 0 (contract: limit/slips.py)."""

from __future__ import annotations

import numpy as np

from dem_cli.core.limit.slips import apart


class SlipPairs:
    """Reserves (c₊, c₋) and slips (a₊, a₋), (2·n_points,) each; x is N, c₊, c₋, p, a₊, a₋."""

    products_of_rows: tuple[tuple[int, int], ...] = ((1, 1), (1, 0))

    def __init__(self, n_points: int) -> None:
        self.n_points = n_points

    def elastic(self, ks: np.ndarray) -> list[np.ndarray]:
        """Return the stiffness factors where nothing slips."""
        return [ks, np.zeros(self.n_points)]

    def changes(self, limit: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Return the change of the reserves c± = μN ± T."""
        return np.concatenate([limit + shear, limit - shear])

    def normals(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return N, p."""
        n = self.n_points
        return x[:n], x[3 * n : 4 * n]

    def slip(self, x: np.ndarray) -> np.ndarray:
        """Return the slips a₊, a₋."""
        return x[4 * self.n_points :]

    def slides(self, x: np.ndarray) -> np.ndarray:
        """Return the slides a₊ − a₋."""
        n = self.n_points
        return x[4 * n : 5 * n] - x[5 * n :]

    def lacks(self, limit: np.ndarray, shear: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the residual (μN ± T) − c±."""
        n = self.n_points
        return self.changes(limit, shear) - x[n : 3 * n]

    def limited(self, shear: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Shorten shear forces to |T| ≤ limit."""
        return np.clip(shear, -limit, limit)

    def straight(self, linear: float, turning: float) -> float:
        """Return the whole residual: in the plane every part is linear."""
        return max(linear, turning)

    def started(
        self, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray, tau: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Separate each reserve from its slip."""
        reserve, slip = apart(np.maximum(self.changes(limit, shear), 0.0) - slip, tau)
        one, two = _pair(reserve)
        return 0.5 * (one + two), 0.5 * (one - two), slip

    def joined(
        self, normal: np.ndarray, opening: np.ndarray, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray
    ) -> np.ndarray:
        """Pack the variables N, c±, p, a±."""
        return np.concatenate([normal, self.changes(limit, shear), opening, slip])

    def products(self, x: np.ndarray) -> np.ndarray:
        """Return the products N p, c± a±."""
        half = len(x) // 2
        return x[:half] * x[half:]

    def relative(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Divide a change by the variables, number by number."""
        return change / x

    def extremes(self, relative: np.ndarray) -> tuple[float, float]:
        """Find the least and the largest relative change."""
        return float(relative.min(initial=0.0)), float(relative.max(initial=0.0))

    def fastest(self, x: np.ndarray, change: np.ndarray) -> tuple[float, float]:
        """Find the fastest relative fall and growth under a change."""
        return self.extremes(self.relative(x, change))

    def moved(self, x: np.ndarray, change: np.ndarray, length: float = 1.0) -> np.ndarray:
        """Add a change to the variables, number by number."""
        return x + length * change

    def linear(self, x: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray) -> PairStiffness:
        """Linearise the complementarity of reserves and slips."""
        n = self.n_points
        return PairStiffness(x[n : 3 * n], x[4 * n :], friction, ks, stiff_n)


class PairStiffness:
    """Linearised complementarity c± a± = τ of points in the plane."""

    def __init__(
        self, reserve: np.ndarray, slip: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray
    ) -> None:
        self.reserve, self.slip, self.ratios = reserve, slip, slip / reserve
        one, two = _pair(self.ratios)
        self.soft_t = 1.0 / ks + one + two
        self.stiff_t = 1.0 / self.soft_t
        self.drag = friction * (one - two) / self.soft_t
        self.coupling = self.drag * stiff_n

    @property
    def stiffness(self) -> list[np.ndarray]:
        """Return the stiffness of the tangent, and its coupling to the normal."""
        return [self.stiff_t, -self.coupling]

    def towards(self, tau: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Return (τ − c a − a · off) / c."""
        return (tau - self.reserve * self.slip - self.slip * off) / self.reserve

    def along(self) -> np.ndarray:
        """Return 1 / c."""
        return 1.0 / self.reserve

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Convert slips and normal forces into shear force by the soft joint."""
        one, two = _pair(forced)
        return (one - two + off_slide) / self.soft_t - self.drag * push

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """Compute the shear force, which falls with the slide, and with the friction of joints that open."""
        return rubbed - self.stiff_t * slide + self.coupling * closing

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Compute slips, which fall where their reserve grows."""
        return forced - self.ratios * change


def _pair(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split values into those of + and those of −."""
    half = len(values) // 2
    return values[:half], values[half:]
