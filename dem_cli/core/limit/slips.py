"""Friction and slip of the contact points of an increment: the contract, and which cones belong to which dimension.

c is the reserve of friction of a point and a its slip in the increment, both in one self-dual cone and square to each
other: c ∘ a = 0 (Coulomb friction without dilation). In the plane the cone is two half-lines, c± = μN ± T and a± ≥ 0
(limit/slip_pairs.py); in space it is round, c = (μN, T) and a = (|γ|, γ), γ the slip (limit/slip_cones.py). Components
are kept one behind the other: all points' first, then all points' second; so are shear forces.

On the central path of an increment N p = τ, p the opening, and c ∘ a = τ e. How its vector x keeps N, c, p and a is the
business of each kind; a change of it is always (dN, dc, dp, da).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np


class SlipStiffness(Protocol):
    """Linearised complementarity c ∘ a = τ e at one iterate, with the elastic shear of the joint; all points."""

    @property
    def stiffness(self) -> list[np.ndarray]:
        """Return the tangential factors of the matrix, in the order of Slips.products_of_rows."""

    def towards(self, tau: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Compute the change of the slips while forces stay.

        tau: products to reach, (2·n_points,); off: what c lacks, (d·n_points,).
        """

    def along(self) -> np.ndarray:
        """Compute the change of the slips for a change of τ by one."""

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Compute the change of the shear forces while no block moves; forced: of slips, push: of normal forces."""

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """Compute the change of the shear forces as blocks slide and joints open."""

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Compute the change of the slips as the reserves change, (d·n_points,)."""


class Slips(Protocol):
    """Reserves and slips of so many points."""

    # Directions (0: normal) whose rows make the part of friction in the matrix; two tangents count either way round.
    products_of_rows: tuple[tuple[int, int], ...]

    def elastic(self, ks: np.ndarray) -> list[np.ndarray]:
        """Return the factors of the products of rows where nothing slips."""

    def started(
        self, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray, tau: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute μN, T and slips off the boundary, with products τ, near given forces and the slip that is
        expected."""

    def joined(
        self, normal: np.ndarray, opening: np.ndarray, limit: np.ndarray, shear: np.ndarray, slip: np.ndarray
    ) -> np.ndarray:
        """Pack the variables x of an increment; slip: as `started` gives it."""

    def normals(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return N and p."""

    def slip(self, x: np.ndarray) -> np.ndarray:
        """Return the slips a, (d·n_points,)."""

    def slides(self, x: np.ndarray) -> np.ndarray:
        """Return the slides γ, ((d − 1)·n_points,)."""

    def changes(self, limit: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Compute the change of c as μN and T change."""

    def lacks(self, limit: np.ndarray, shear: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the change that c lacks to agree with μN and T."""

    def limited(self, shear: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Shorten shear forces to the limit of friction."""

    def straight(self, linear: float, turning: float) -> float:
        """Select the residuals that shorter steps reduce; turning: that of reserves and slides."""

    def products(self, x: np.ndarray) -> np.ndarray:
        """Return all N p and the eigenvalues of c ∘ a: equal on the central path."""

    def relative(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Express a change in units of x itself."""

    def extremes(self, relative: np.ndarray) -> tuple[float, float]:
        """Find the fastest fall and growth of any variable, relative to itself; at −1 x leaves its cones."""

    def fastest(self, x: np.ndarray, change: np.ndarray) -> tuple[float, float]:
        """Find the extremes of a change in units of x."""

    def moved(self, x: np.ndarray, change: np.ndarray, length: float = 1.0) -> np.ndarray:
        """Move x by a share of a change, which leaves it inside its cones."""

    def linear(self, x: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray) -> SlipStiffness:
        """Linearise the complementarity condition; stiff_n: stiffness across the joint."""


def apart(difference: np.ndarray, tau: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute two positive numbers with this difference and the product τ."""
    root = np.sqrt(difference**2 + 4.0 * tau)
    larger = 0.5 * (np.abs(difference) + root)
    first = np.where(difference > 0.0, larger, tau / larger)
    return first, tau / first
