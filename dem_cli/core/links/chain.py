"""Elastic chains: a bar on springs along blocks, its nodes condensed out of the stiffness between the blocks.

An opening of a joint stretches the element of the bar that crosses it. Nodes have no load of their own, so that
forces there are K times the openings, K = k − C H⁻¹ Cᵀ; H: stiffness of the nodes, tridiagonal, C: of nodes and
openings.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.small_matrices import solved_tridiagonal


class Chain(NamedTuple):
    """Elastic model of one bar as a chain of springs. Element e lies before node e, the last one behind the last
    node.
    """

    bonds: np.ndarray  # stiffness of the springs between nodes and blocks [N/m], (n,)
    elements: np.ndarray  # axial stiffness; 0 at an end that is free [N/m], (n + 1,)
    crossing: np.ndarray  # elements that cross joints, (n_joints,)

    def slips(self, openings: np.ndarray) -> np.ndarray:
        """Slips of the nodes against their blocks [m], (n, ...), from openings of the joints, (n_joints, ...)."""
        pull = np.zeros((len(self.bonds), *openings.shape[1:]))
        stiffness = self.elements[self.crossing].reshape(-1, *[1] * (openings.ndim - 1))
        np.add.at(pull, self.crossing - 1, stiffness * openings)
        np.add.at(pull, self.crossing, -stiffness * openings)
        return solved_tridiagonal(self.bonds + self.elements[:-1] + self.elements[1:], -self.elements[1:-1], pull)

    def stretches(self, openings: np.ndarray, slips: np.ndarray) -> np.ndarray:
        """Compute elongations of the elements [m], (n + 1, ...)."""
        found = np.zeros((len(slips) + 1, *slips.shape[1:]))
        found[:-1] += slips
        found[1:] -= slips
        found[self.crossing] += openings
        return found

    def condensed(self) -> np.ndarray:
        """Condensed stiffness K: forces across the joints from their openings [N/m], (n_joints, n_joints)."""
        units = np.eye(len(self.crossing))
        across = self.stretches(units, self.slips(units))[self.crossing]
        found = self.elements[self.crossing][:, None] * across
        return 0.5 * (found + found.T)
