"""Friction and slip in space: c = (μN, T) and a = (|γ|, γ) in the Lorentz cone, c ∘ a = 0 (contract: limit/slips.py).

c ∘ a = τ e where T and γ are opposite, T = r d and γ = −g d with one unit vector d, and the eigenvalues of both cones,
c₁, c₂ = c₀ ∓ r and a₁, a₂ = a₀ ± g, make two pairs

    c₁ a₁ = c₂ a₂ = τ

as in the plane, where d cannot turn. So d is an unknown of its own. Along d the equations are those of the plane;
across it both turn by one angle, dT = r dθ and dγ = −g dθ, that is dγ = −(a₀/c₀) dT. Straight steps, as with the
scaling of Nesterov and Todd, leave the cone after angles of √(c₁/c₂) where a point slides. Here c₁ and a₂, which are
small there, change along d alone, and T and γ turn as far as Newton's step has it; what μN then lacks to c₀, and T and
γ to the common d, is left to the next step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.limit.slips import apart

# Of x₀: from this |x̄| on the smaller eigenvalue changes along d while x̄ turns; below it x₀ and x̄ move straight.
TURNS = 0.5


class Polar(NamedTuple):
    """Reserves and slips of each point in polar form; all (n_points,) or (2, n_points)."""

    normal: np.ndarray  # N
    opening: np.ndarray  # p
    c: np.ndarray  # c₁ and c₂
    a: np.ndarray  # a₁ and a₂
    d: np.ndarray

    @property
    def reserve(self) -> np.ndarray:
        """Reserves c as vectors, (3, n_points)."""
        return _element(self.c, self.d)

    @property
    def slip(self) -> np.ndarray:
        """Slips a as vectors, (3, n_points)."""
        return _element(self.a, self.d)

    def moved(self, by: Change) -> Polar:
        """Apply a change: T and γ as they are afterwards, without their part across the common direction."""
        reserve, slip = self.reserve + by.reserve, self.slip + by.slip
        d = _unit(reserve[1:] - slip[1:], self.d)
        shear = np.maximum((reserve[1:] * d).sum(axis=0), 0.0)
        slide = np.maximum(-(slip[1:] * d).sum(axis=0), 0.0)
        c = np.where(_turns(self.c), self.c[0] + _eigenvalues(by.reserve, self.d)[0], reserve[0] - shear)
        a = np.where(_turns(self.a), self.a[1] + _eigenvalues(by.slip, self.d)[1], slip[0] - slide)
        ends = np.stack([c, c + 2.0 * shear]), np.stack([a + 2.0 * slide, a])
        return Polar(self.normal + by.normal, self.opening + by.opening, *ends, d)


class Change(NamedTuple):
    """Change of normal forces, openings, reserves and slips."""

    normal: np.ndarray
    reserve: np.ndarray  # of c, (3, n_points)
    opening: np.ndarray
    slip: np.ndarray  # of a, (3, n_points)


def polar(x: np.ndarray) -> Polar:
    """Unpack the variables of an increment into polar form."""
    rows = x.reshape(8, -1)
    return Polar(rows[0], rows[1], rows[2:4], rows[4:6], rows[6:])


def change_of(x: np.ndarray) -> Change:
    """Unpack the change of the variables of an increment: N, c, p, a."""
    rows = x.reshape(8, -1)
    return Change(rows[0], rows[1:4], rows[4], rows[5:])


def _element(eigenvalues: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Build the element (x₀, x̄) with eigenvalues x₀ ∓ x̄·d, (3, n_points)."""
    first, second = eigenvalues
    return np.concatenate([0.5 * (first + second)[None], 0.5 * (second - first) * d])


def _eigenvalues(element: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Compute the eigenvalues x₀ ∓ x̄·d, (2, n_points)."""
    along = (d * element[1:]).sum(axis=0)
    return np.stack([element[0] - along, element[0] + along])


def _turns(eigenvalues: np.ndarray) -> np.ndarray:
    """Test whether the direction of elements x̄ turns as they move, (n_points,) bool."""
    first, second = eigenvalues
    return np.abs(second - first) > TURNS * (first + second)


def _across(element: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Compute the component of x̄ across d, (n_points,)."""
    return d[0] * element[2] - d[1] * element[1]


def _unit(vectors: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """Directions of vectors, (2, n_points); otherwise: of those without length."""
    length = np.sqrt((vectors * vectors).sum(axis=0))
    some = length > 0.0
    return np.where(some, vectors / np.where(some, length, 1.0), otherwise)


class SlipCones:
    """Reserves (μN, T₁, T₂) and slips (|γ|, γ₁, γ₂); x is N, p, c₁, c₂, a₁, a₂, d."""

    products_of_rows: tuple[tuple[int, int], ...] = ((1, 1), (2, 2), (1, 2), (1, 0), (2, 0))

    def __init__(self, n_points: int) -> None:
        self.n_points = n_points

    def elastic(self, ks: np.ndarray) -> list[np.ndarray]:
        """Return the stiffness factors where nothing slips."""
        none = np.zeros(self.n_points)
        return [ks, ks, none, none, none]

    def normals(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return N, p."""
        return x[: self.n_points], x[self.n_points : 2 * self.n_points]

    def slip(self, x: np.ndarray) -> np.ndarray:
        """Return the slips a."""
        return polar(x).slip.ravel()

    def slides(self, x: np.ndarray) -> np.ndarray:
        """Return the slides γ."""
        return polar(x).slip[1:].ravel()

    def lacks(self, limit: np.ndarray, shear: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the residual (μN, T) − c."""
        return self.changes(limit, shear) - polar(x).reserve.ravel()

    def changes(self, limit: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Return the change of (μN, T)."""
        return np.concatenate([limit, shear])

    def limited(self, shear: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Shorten shear forces to |T| ≤ limit and keep their direction."""
        force = shear.reshape(2, -1)
        length = np.sqrt((force * force).sum(axis=0))
        beyond = length > limit
        return (force * np.where(beyond, limit / np.where(beyond, length, 1.0), 1.0)).ravel()

    def straight(self, linear: float, turning: float) -> float:
        """Return the linear residual alone: turning makes that of reserves and slides anew in every step."""
        return linear

    def started(
        self, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray, tau: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Separate reserves from slips, eigenvalue by eigenvalue."""
        difference = (self.changes(limit, self.limited(shear, limit)) - slip).reshape(3, -1)
        d = _unit(difference[1:], np.array([[1.0], [0.0]]))
        c, a = apart(_eigenvalues(difference, d), tau)
        return 0.5 * (c[0] + c[1]), (0.5 * (c[1] - c[0]) * d).ravel(), np.concatenate([a, d]).ravel()

    def joined(
        self, normal: np.ndarray, opening: np.ndarray, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray
    ) -> np.ndarray:
        """Pack the variables of an increment, with reserves of these forces along d."""
        rows = slip.reshape(4, -1)
        c = _eigenvalues(self.changes(limit, shear).reshape(3, -1), rows[2:])
        return np.concatenate([normal, opening, c.ravel(), slip])

    def products(self, x: np.ndarray) -> np.ndarray:
        """Return the products N p, c₁ a₁, c₂ a₂."""
        n = self.n_points
        found = np.empty(3 * n)
        np.multiply(x[:n], x[n : 2 * n], out=found[:n])
        np.multiply(x[2 * n : 4 * n], x[4 * n : 6 * n], out=found[n:])
        return found

    def relative(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Scale a change: eigenvalues over themselves, the part across d over c₀ and a₀ (an angle where the
        element turns)."""
        at, by = polar(x), change_of(change)
        found = [(by.normal / at.normal)[None], (by.opening / at.opening)[None]]
        for kept, element in ((at.c, by.reserve), (at.a, by.slip)):
            scale = np.where(_turns(kept), 0.5 * (kept[0] + kept[1]), np.sqrt(kept[0] * kept[1]))
            found += [_eigenvalues(element, at.d) / kept, (np.sqrt(2.0) * _across(element, at.d) / scale)[None]]
        return np.concatenate(found).ravel()

    def extremes(self, relative: np.ndarray) -> tuple[float, float]:
        """Find the extremes of a relative change, over numbers and over eigenvalues of changes along and across."""
        rows = relative.reshape(8, -1)
        low, high = float(rows[:2].min(initial=0.0)), float(rows[:2].max(initial=0.0))
        for first, second, across in (rows[2:5], rows[5:]):
            middle, radius = 0.5 * (first + second), np.sqrt(0.25 * (first - second) ** 2 + 0.5 * across**2)
            low = min(low, float((middle - radius).min(initial=0.0)))
            high = max(high, float((middle + radius).max(initial=0.0)))
        return low, high

    def fastest(self, x: np.ndarray, change: np.ndarray) -> tuple[float, float]:
        """Find the fastest relative fall and growth, along and across."""
        return self.extremes(self.relative(x, change))

    def moved(self, x: np.ndarray, change: np.ndarray, length: float = 1.0) -> np.ndarray:
        """Move the variables: numbers are added, reserves and slips turned."""
        return np.concatenate([np.atleast_2d(part) for part in polar(x).moved(change_of(length * change))]).ravel()

    def linear(self, x: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray) -> ConeStiffness:
        """Linearise the complementarity of reserves and slips."""
        return ConeStiffness(polar(x), friction, ks, stiff_n)


class ConeStiffness:
    """Linearised complementarity c ∘ a = τ e of points in space."""

    def __init__(self, at: Polar, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray) -> None:
        self.at, self.d, self.ratios = at, at.d, at.a / at.c
        self.turning = (at.a[0] + at.a[1]) / (at.c[0] + at.c[1])
        one, two = self.ratios
        self.stiff_along = 1.0 / (1.0 / ks + 0.5 * (one + two))
        self.stiff_across = 1.0 / (1.0 / ks + self.turning)
        self.drag = friction * 0.5 * (two - one) * self.stiff_along * self.d
        self.coupling = self.drag * stiff_n

    @property
    def stiffness(self) -> list[np.ndarray]:
        """Return the stiffness of the tangents, their coupling, and the coupling to the normal."""
        (d1, d2), along, across = self.d, self.stiff_along, self.stiff_across
        return [
            along * d1 * d1 + across * d2 * d2, along * d2 * d2 + across * d1 * d1, (along - across) * d1 * d2,
            *-self.coupling,
        ]  # fmt: skip

    def towards(self, tau: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Return (τ − c a) / c of each pair, less the residual of the reserves."""
        forced = _element((tau.reshape(2, -1) - self.at.c * self.at.a) / self.at.c, self.d)
        return forced.ravel() - self._yielding(off.reshape(3, -1))

    def along(self) -> np.ndarray:
        """Return 1 / c of each pair."""
        return _element(1.0 / self.at.c, self.d).ravel()

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Convert slips and normal forces into shear force by the soft joint."""
        slide = forced.reshape(3, -1)[1:] + off_slide.reshape(2, -1)
        return (self._stiff(slide) - self.drag * push).ravel()

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """Compute the shear force, which falls with the slide, and with the friction of joints that open."""
        return rubbed + (self.coupling * closing - self._stiff(slide.reshape(2, -1))).ravel()

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Compute slips, which fall where their reserve grows; across d both turn."""
        return forced - self._yielding(change.reshape(3, -1))

    def _yielding(self, element: np.ndarray) -> np.ndarray:
        """Compute the slips that a change of the reserves takes back, (3·n_points,)."""
        found = _element(self.ratios * _eigenvalues(element, self.d), self.d)
        across = self.turning * _across(element, self.d)
        found[1] -= across * self.d[1]
        found[2] += across * self.d[0]
        return found.ravel()

    def _stiff(self, slide: np.ndarray) -> np.ndarray:
        """Compute the shear forces of a slide."""
        along = self.stiff_along * (self.d * slide).sum(axis=0)
        across = self.stiff_across * (self.d[0] * slide[1] - self.d[1] * slide[0])
        return np.stack([along * self.d[0] - across * self.d[1], along * self.d[1] + across * self.d[0]])
