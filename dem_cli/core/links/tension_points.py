"""Ties and bars as contact points of the static problem (limit/elastic.py): pressed as they grow longer, may yield.

A tie carries t = k (e − e_p) + t₀ between nothing and its largest force; e: elongation, e_p: the part of it that is for
good. Its point has the normal force t, opens by −t/k, and knows no friction. One that yields in an increment is its
largest force instead, among the dead loads; which do is found by doing the increment again (return mapping of
elastic, perfectly plastic bars, backward Euler). What takes compression as well, rods and bars, is two such points, one
that presses as it grows longer and one that presses as it grows shorter, with one e_p: together they are a spring.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from dem_cli.core.links.link import LinkArrays
from dem_cli.core.links.matrices import elongations, free_columns, joined


class TensionPoints(NamedTuple):
    """Ties and bars of a structure as points that press; forces and lengths in the units of who made them."""

    stiffness: np.ndarray  # k, (n,)
    first: np.ndarray  # force before anything moved, in the sense of the point, t₀ or −t₀, (n,)
    most: np.ndarray  # largest force, (n,)
    elongation: csr_matrix  # e, or −e, per free degree of freedom, (n, n_free)
    motion: np.ndarray  # the same per motion of its two blocks, (n, 2, n_dof)
    columns: np.ndarray  # free degrees of freedom of these, −1: held, (n, 2, n_dof)
    links: np.ndarray  # tie, or joint crossed by a bar, that each point stands for, (n,) int64
    senses: np.ndarray  # 1 where it pulls, −1 where it pushes, (n,)

    @property
    def n_links(self) -> int:
        """Number of ties, and of joints that bars cross."""
        return int(self.links.max(initial=-1)) + 1

    def scaled(self, weight: float, unit: float, columns: np.ndarray) -> TensionPoints:
        """Scale points: forces over a weight, lengths over a unit, degrees of freedom over `columns`, (n_free,)."""
        here = np.where(self.columns < 0, 0.0, np.append(columns, 0.0)[self.columns])
        return self._replace(
            stiffness=self.stiffness * unit / weight,
            first=self.first / weight,
            most=self.most / weight,
            elongation=self.elongation.multiply(columns[None, :]).tocsr(),
            motion=self.motion * here,
        )

    def gaps(self, plastic: np.ndarray) -> np.ndarray:
        """Compute the openings of the points without motion, (n,); plastic: e_p, (n_links,)."""
        return self.senses * plastic[self.links] - self.first / self.stiffness

    def elastic_force(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Compute the force of each point as if it were never slack and had no limit, (n,)."""
        return self.stiffness * (self.elongation @ displacements - self.senses * plastic[self.links]) + self.first

    def yielding(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Test which points are pressed beyond their largest force, (n,) bool."""
        return self.elastic_force(displacements, plastic) > self.most

    def stretched(self, displacements: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Compute the plastic elongations after an increment to these displacements, (n_links,)."""
        beyond = self.elastic_force(displacements, plastic) - self.most
        more = self.senses * np.maximum(beyond, 0.0) / self.stiffness
        return plastic + np.bincount(self.links, more, self.n_links)

    @property
    def longest_elastic(self) -> float:
        """Longest elastic elongation of any link, from its first force to its largest, where that is finite."""
        ends = np.isfinite(self.most)
        return float(((self.most - self.first) / self.stiffness)[ends].max(initial=0.0))

    def dead(self, yielding: np.ndarray) -> np.ndarray:
        """Compute the forces of yielding points on the free degrees of freedom, (n_free,)."""
        return -(self.elongation.T @ np.where(yielding, self.most, 0.0))


def tension_points(links: Sequence[LinkArrays], fixed: np.ndarray, held: np.ndarray) -> TensionPoints | None:
    """Convert links to points, in SI units; None where there are none.

    fixed: blocks that cannot move, (n_blocks,) bool; held: motions that loads do not change, (n_blocks, n_dof) bool.
    """
    if not links:
        return None
    bounded = [link.bounded() for link in links]
    n_dof = held.shape[1]
    springs = joined((one for one, _ in bounded), n_dof)
    limits, first = np.concatenate([one for _, one in bounded]), np.concatenate([link.preload() for link in links])
    still = np.vstack([held, np.ones((1, n_dof), bool)])[springs.blocks]  # the last one: of a fixed point
    springs = springs._replace(motion=np.where(still, 0.0, springs.motion))
    columns = np.where(still, -1, free_columns(springs.blocks, fixed, n_dof))
    pushing = np.flatnonzero(limits[:, 0] < 0.0)
    of = np.concatenate([np.arange(len(limits)), pushing])
    senses = np.concatenate([np.ones(len(limits)), -np.ones(len(pushing))])
    return TensionPoints(
        springs.stiffness[of], senses * first[of], np.concatenate([limits[:, 1], -limits[pushing, 0]]),
        csr_matrix(diags(senses) @ elongations(springs, fixed)[of]), senses[:, None, None] * springs.motion[of],
        columns[of], of, senses,
    )  # fmt: skip
