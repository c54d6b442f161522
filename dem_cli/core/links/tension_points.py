"""Ties as contact points of the static problem (limit/elastic.py): they press as they grow longer, and may yield.

A tie carries t = k (e − e_p) + t₀ between nothing and its largest force; e: elongation, e_p: the part of it that is for
good. Its point has the normal force t, opens by −t/k, and knows no friction. One that yields in an increment is its
largest force instead, among the dead loads; which do is found by doing the increment again (return mapping of
elastic, perfectly plastic bars, backward Euler).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.links.link import LinkArrays
from dem_cli.core.links.matrices import elongations, free_columns, joined

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class TensionPoints(NamedTuple):
    """Ties of a structure as points that only pull; forces and lengths in the units of who made them."""

    stiffness: np.ndarray  # k, (n,)
    first: np.ndarray  # force before anything moved, t₀, (n,)
    most: np.ndarray  # largest force, (n,)
    elongation: csr_matrix  # e per free degree of freedom, (n, n_free)
    motion: np.ndarray  # e per motion of its two blocks, (n, 2, n_dof)
    columns: np.ndarray  # free degrees of freedom of these, −1: held, (n, 2, n_dof)

    def scaled(self, weight: float, unit: float, columns: np.ndarray) -> TensionPoints:
        """Scale ties: forces over a weight, lengths over a unit, degrees of freedom over `columns`, (n_free,)."""
        here = np.where(self.columns < 0, 0.0, np.append(columns, 0.0)[self.columns])
        return self._replace(
            stiffness=self.stiffness * unit / weight,
            first=self.first / weight,
            most=self.most / weight,
            elongation=self.elongation.multiply(columns[None, :]).tocsr(),
            motion=self.motion * here,
        )

    def gaps(self, plastic: np.ndarray) -> np.ndarray:
        """Compute the openings of the tie points without motion, (n,); plastic: e_p."""
        return plastic - self.first / self.stiffness

    def elastic_force(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Compute the force of each tie as if it were never slack and had no limit, (n,)."""
        return self.stiffness * (self.elongation @ displacements - plastic) + self.first

    def yielding(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Test which ties are stretched beyond their largest force, (n,) bool."""
        return self.elastic_force(displacements, plastic) > self.most

    def stretched(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Compute the plastic elongations after an increment to these displacements, (n,)."""
        beyond = self.elastic_force(displacements, plastic) - self.most
        return plastic + np.maximum(beyond, 0.0) / self.stiffness

    @property
    def longest_elastic(self) -> float:
        """Longest elastic elongation of any tie, from its first force to its largest, where that is finite."""
        ends = np.isfinite(self.most)
        return float(((self.most - self.first) / self.stiffness)[ends].max(initial=0.0))

    def dead(self, yielding: np.ndarray) -> np.ndarray:
        """Compute the forces of yielding ties on the free degrees of freedom, (n_free,)."""
        return -(self.elongation.T @ np.where(yielding, self.most, 0.0))


def tension_points(links: Iterable[LinkArrays], fixed: np.ndarray, held: np.ndarray) -> TensionPoints | None:
    """Convert links to tension points, in SI units; None where one of them is more than a tie that only pulls.

    fixed: blocks that cannot move, (n_blocks,) bool; held: motions that loads do not change, (n_blocks, n_dof) bool.
    """
    found = [link.only_pulling() for link in links]
    if not found or any(one is None for one in found):
        return None
    pulling = [one for one in found if one is not None]
    n_dof = held.shape[1]
    springs = joined((one.springs for one in pulling), n_dof)
    still = np.vstack([held, np.ones((1, n_dof), bool)])[springs.blocks]  # the last one: of a fixed point
    springs = springs._replace(motion=np.where(still, 0.0, springs.motion))
    columns = np.where(still, -1, free_columns(springs.blocks, fixed, n_dof))
    first, most = (np.concatenate(parts) for parts in zip(*(one[1:] for one in pulling), strict=True))
    return TensionPoints(
        springs.stiffness, first, most, elongations(springs, fixed), springs.motion, columns
    )  # fmt: skip
