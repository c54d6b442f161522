"""Friction and slip of the contact points of an increment: the contract, and which cones belong to which dimension.

c is the reserve of friction of a point and a its slip in the increment, both in one self-dual cone and square to each
other: c ∘ a = 0 (Coulomb friction without dilation). In the plane the cone is two half-lines, c± = μN ± T and a± ≥ 0
(limit/slip_pairs.py); in space it is round, c = (μN, T) and a = (|γ|, γ), γ the slip (limit/slip_cones.py). Reserves,
slips and shear forces are kept component by component: all points' first, then all points' second.

The vector of an increment is x = (N, c, p, a), p: opening of the joint. On its central path N p = τ, c ∘ a = τ e.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np


class SlipStiffness(Protocol):
    """The condition c ∘ a = τ e made linear at one iterate, with the elastic shear of the joint; all points."""

    @property
    def stiffness(self) -> list[np.ndarray]:
        """Factors of the products of rows that are its part of the matrix, in the order of Slips.products_of_rows."""

    def towards(self, tau: float, off: np.ndarray) -> np.ndarray:
        """Change of the slips towards products of τ with the forces as they are; off: what c lacks, (d·n_points,)."""

    def along(self) -> np.ndarray:
        """The same for a change of τ by one."""

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Change of the shear forces while no block moves; forced: of slips, push: of normal forces."""

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """Change of the shear forces as blocks slide and close."""

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Change of the slips as the reserves change, (d·n_points,)."""


class Slips(Protocol):
    """Reserves and slips of so many points."""

    products_of_rows: tuple[tuple[int, int], ...]  # directions (0: normal) whose rows make the part in the matrix

    def elastic(self, ks: np.ndarray) -> list[np.ndarray]:
        """Factors of the products of rows where nothing slips."""

    def reserves(self, limit: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """c, from μN (n_points,) and T."""

    def slides(self, slip: np.ndarray) -> np.ndarray:
        """γ, from a."""

    def limited(self, shear: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """The shear forces as far as friction allows them."""

    def started(
        self, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray, tau: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """μN, T and a off the boundary, with products τ, near forces of the last increment and the slips expected."""

    def products(self, x: np.ndarray) -> np.ndarray:
        """All N p and the eigenvalues of c ∘ a: equal on the central path."""

    def relative(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """A change of x in units of x itself: over each number, or in the frame in which the cone's element is e."""

    def extremes(self, relative: np.ndarray) -> tuple[float, float]:
        """The fastest fall and growth of anything in x, relative to itself; below −1 x has left its cones."""

    def linear(
        self, reserve: np.ndarray, slip: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray
    ) -> SlipStiffness:
        """The condition made linear."""


def slips_of(dimension: int, n_points: int) -> Slips:
    """Reserves and slips in 2D or 3D."""
    from dem_cli.limit.slip_cones import SlipCones
    from dem_cli.limit.slip_pairs import SlipPairs

    return {2: SlipPairs, 3: SlipCones}[dimension](n_points)


def apart(difference: np.ndarray, tau: float) -> tuple[np.ndarray, np.ndarray]:
    """Two positive numbers with this difference and the product τ."""
    root = np.sqrt(difference**2 + 4.0 * tau)
    larger = 0.5 * (np.abs(difference) + root)
    first = np.where(difference > 0.0, larger, tau / larger)
    return first, tau / first
