"""Friction and slip in space: reserve c = (μN, T) and slip a = (|γ|, γ) in the Lorentz cone, c ∘ a = 0 (limit/slips.py).

x₀ ≥ |x̄| is the cone, c ∘ a = (c·a, c₀ ā + a₀ c̄), e = (1, 0, 0), det x = x₀² − |x̄|², x⁻¹ = (x₀, −x̄) / det x. The
condition c ∘ a = τ e is made linear after Nesterov and Todd: with the scaling P, P c = a,

    da + P dc = τ c⁻¹ − a,     P = η (2 w wᵀ − J),   J = diag(1, −1, −1)

so that dγ = (τ c⁻¹ − a)_t − P_t0 μ dN − P_tt dT, as in the plane with numbers for matrices. P_tt + 1/ks has the
eigenvectors w̄ and the one across it.
"""

from __future__ import annotations

import numpy as np

from dem_cli.limit.slips import apart


class SlipCones:
    """Reserves (μN, T₁, T₂) and slips (|γ|, γ₁, γ₂), (3·n_points,) each."""

    products_of_rows = ((1, 1), (2, 2), (1, 2), (1, 0), (2, 0))

    def __init__(self, n_points: int) -> None:
        self.n_points = n_points

    def elastic(self, ks: np.ndarray) -> list[np.ndarray]:
        """Nothing slips."""
        none = np.zeros(self.n_points)
        return [ks, ks, none, none, none]

    def reserves(self, limit: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """(μN, T)."""
        return np.concatenate([limit, shear])

    def slides(self, slip: np.ndarray) -> np.ndarray:
        """γ."""
        return slip[self.n_points :]

    def limited(self, shear: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """|T| ≤ limit, the direction kept."""
        force = shear.reshape(2, -1)
        return (force * np.minimum(1.0, limit / np.maximum(_length(force), np.finfo(float).tiny))).ravel()

    def started(
        self, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray, tau: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Reserve less slip, eigenvalue by eigenvalue apart."""
        difference = (self.reserves(limit, self.limited(shear, limit)) - slip).reshape(3, -1)
        length = _length(difference[1:])
        along = difference[1:] / np.where(length > 0.0, length, 1.0)
        (high, slip_high), (low, slip_low) = (apart(difference[0] + sign * length, tau) for sign in (1.0, -1.0))
        slips = np.concatenate([[0.5 * (slip_high + slip_low)], 0.5 * (slip_high - slip_low) * along])
        return 0.5 * (high + low), (0.5 * (high - low) * along).ravel(), slips.ravel()

    def products(self, x: np.ndarray) -> np.ndarray:
        """N p, and both eigenvalues of c ∘ a as its determinant has them."""
        normal, reserve, opening, slip = self._parts(x)
        half = (reserve * slip).sum(axis=0)
        product = det(reserve) * det(slip)
        high = half + np.sqrt(np.maximum(half**2 - product, 0.0))
        return np.concatenate([normal * opening, high, product / high])

    def relative(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Boosted into the frame in which each element is a multiple of e; of unit length as two eigenvalues are."""
        normal, reserve, opening, slip = self._parts(x)
        by_normal, by_reserve, by_opening, by_slip = self._parts(change)
        of_reserve, of_slip = _boosted(reserve, by_reserve), _boosted(slip, by_slip)
        return np.concatenate([by_normal / normal, of_reserve, by_opening / opening, of_slip])

    def extremes(self, relative: np.ndarray) -> tuple[float, float]:
        """Of the eigenvalues of all cones, and the numbers beside them."""
        normal, reserve, opening, slip = self._parts(relative)
        values = [normal, opening]
        for element in (reserve, slip):
            lead, length = np.sqrt(0.5) * element[0], np.sqrt(0.5) * _length(element[1:])
            values += [lead - length, lead + length]
        return min(float(v.min(initial=0.0)) for v in values), max(float(v.max(initial=0.0)) for v in values)

    def linear(
        self, reserve: np.ndarray, slip: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray
    ) -> ConeStiffness:
        """The products made linear."""
        return ConeStiffness(reserve.reshape(3, -1), slip.reshape(3, -1), friction, ks, stiff_n)

    def _parts(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """N, c, p, a; c and a as (3, n_points)."""
        rows = x.reshape(8, -1)
        return rows[0], rows[1:4], rows[4], rows[5:]


class ConeStiffness:
    """c ∘ a = τ e made linear; elements are (3, n_points)."""

    def __init__(
        self, reserve: np.ndarray, slip: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray
    ) -> None:
        self.reserve, self.slip, self.det = reserve, slip, det(reserve)
        of_slip = det(slip)
        self.eta = np.sqrt(of_slip / self.det)
        one, two = slip / np.sqrt(of_slip), reserve / np.sqrt(self.det)
        self.w = np.concatenate([one[:1] + two[:1], one[1:] - two[1:]])
        self.w /= np.sqrt(2.0 * (1.0 + (one * two).sum(axis=0)))
        length = _length(self.w[1:])
        self.way = np.where(length > 0.0, self.w[1:] / np.where(length > 0.0, length, 1.0), [[1.0], [0.0]])
        self.across = np.stack([-self.way[1], self.way[0]])
        soft = self.eta + 1.0 / ks
        self.stiff_across, self.stiff_along = 1.0 / soft, 1.0 / (soft + 2.0 * self.eta * length**2)
        self.drag = friction * 2.0 * self.eta * self.w[0] * length * self.stiff_along * self.way
        self.coupling = self.drag * stiff_n

    @property
    def stiffness(self) -> list[np.ndarray]:
        """Of the tangents by themselves and by each other, and by the normal."""
        (a1, a2), (c1, c2) = self.way, self.across
        along, across = self.stiff_along, self.stiff_across
        return [
            along * a1 * a1 + across * c1 * c1, along * a2 * a2 + across * c2 * c2, along * a1 * a2 + across * c1 * c2,
            *-self.coupling,
        ]  # fmt: skip

    def towards(self, tau: float, off: np.ndarray) -> np.ndarray:
        """τ c⁻¹ − a − P off."""
        return (tau * self._inverse() - self.slip - self._scaled(off.reshape(3, -1))).ravel()

    def along(self) -> np.ndarray:
        """c⁻¹."""
        return self._inverse().ravel()

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Slips and normal forces turned into shear force by the soft joint."""
        slide = forced.reshape(3, -1)[1:] + off_slide.reshape(2, -1)
        return (self._stiff(slide) - self.drag * push).ravel()

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """T falls with the slide, and with the friction of joints that open."""
        return rubbed + (self.coupling * closing - self._stiff(slide.reshape(2, -1))).ravel()

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Where a reserve grows its slip falls."""
        return forced - self._scaled(change.reshape(3, -1)).ravel()

    def _inverse(self) -> np.ndarray:
        return np.concatenate([self.reserve[:1], -self.reserve[1:]]) / self.det

    def _scaled(self, element: np.ndarray) -> np.ndarray:
        """P · element."""
        mirrored = np.concatenate([element[:1], -element[1:]])
        return self.eta * (2.0 * (self.w * element).sum(axis=0) * self.w - mirrored)

    def _stiff(self, slide: np.ndarray) -> np.ndarray:
        """(P_tt + 1/ks)⁻¹ · slide."""
        along, across = (self.way * slide).sum(axis=0), (self.across * slide).sum(axis=0)
        return self.stiff_along * along * self.way + self.stiff_across * across * self.across


def det(element: np.ndarray) -> np.ndarray:
    """x₀² − |x̄|², (n_points,)."""
    length = _length(element[1:])
    return (element[0] - length) * (element[0] + length)


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.sqrt((vectors * vectors).sum(axis=0))


def _boosted(element: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Change in the frame in which the element is e, times √2, (3·n_points,)."""
    root = np.sqrt(det(element))
    unit = element / root
    along = (unit[1:] * change[1:]).sum(axis=0)
    lead = unit[0] * change[0] - along
    rest = change[1:] + unit[1:] * (along / (1.0 + unit[0]) - change[0])
    return (np.sqrt(2.0) * np.concatenate([lead[None], rest]) / root).ravel()
