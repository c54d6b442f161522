"""Equilibrium of rigid blocks with one shear force per joint, as linear programs for HiGHS; 2D.

Unknowns: the normal force of every contact point, the shear force of every joint (the points of a plane joint lie on
one line, so that only the sum of theirs counts), then the multiplier of the live loads:

    −ft A ≤ N ≤ fc A at every point,   |T| ≤ C + μ ΣN of every joint,   Bᵀ (N, T) + dead + λ live = 0

in mean weights of a block; live loads are scaled to be as large as the dead ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags, hstack, identity, vstack

from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.program import units
from dem_cli.interrupts import look

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult


SOLVED = 0  # status of SciPy's linprog


class JointStrength(NamedTuple):
    """Strength in mean weights, of points (n_points,) and of joints (n_joints,)."""

    tension: np.ndarray  # of points
    compression: np.ndarray  # of points
    cohesion: np.ndarray  # of joints: without any normal force
    lost: np.ndarray  # of points: their share of it, where it goes as they open: without tension nothing holds it
    friction: np.ndarray  # of joints [-]
    dilation: np.ndarray  # of joints, tan ψ [-]


class JointForces:
    """Linear programs over the forces of a structure; `joint` is the joint of each point, (n_points,)."""

    def __init__(self, structure: LimitStructure, strength: Envelope) -> None:
        self.structure, (self.weight, self.load) = structure, units(structure)
        kept, self.joint = np.unique(structure.joints.owners, return_inverse=True)
        self.n_points, self.n_joints = len(self.joint), len(kept)
        self.strength = self.of(strength)
        points, ones = np.arange(self.n_points), np.ones(self.n_points)
        self.sums = csr_matrix((ones, (self.joint, points)), (self.n_joints, self.n_points))  # over points of a joint
        scales, counts = structure.scales / self.weight, np.bincount(self.joint)
        self.opening = structure.compatibility[0::2].tocsr()
        self.sliding = (diags(1.0 / counts) @ self.sums @ structure.compatibility[1::2]).tocsr()
        self.live = structure.live * self.load / self.weight
        self.dead = structure.dead / self.weight
        forces = hstack([self.opening.T, self.sliding.T, csr_matrix(self.live[:, None])])
        self.balance = (diags(1.0 / scales) @ forces).tocsr()
        self.right = -self.dead / scales
        self.programs = 0

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return self.n_points + self.n_joints + 1

    def of(self, strength: Envelope) -> JointStrength:
        """Strength of the joints, from that of their points."""
        first = np.unique(self.joint, return_index=True)[1]
        return JointStrength(
            strength.tension / self.weight,
            strength.compression / self.weight,
            np.bincount(self.joint, strength.cohesion / self.weight, self.n_joints),
            np.where(strength.tension > 0.0, 0.0, strength.cohesion / self.weight),
            strength.friction[first],
            strength.dilation[first],
        )

    def sure_cohesion(self, least: np.ndarray) -> np.ndarray:
        """Cohesion of every joint that no opening takes away, (n_joints,): where it presses one point at least is shut.

        least: normal forces of the joints, (n_joints,).
        """
        smallest = np.full(self.n_joints, np.inf)
        np.minimum.at(smallest, self.joint, self.strength.lost)
        lost = np.bincount(self.joint, self.strength.lost, self.n_joints)
        return np.where(
            lost > 0.0, self.strength.cohesion - lost + np.where(least > 0.0, smallest, 0.0), self.strength.cohesion
        )

    def bounds(self, low: float, high: float, shear: np.ndarray | None = None) -> np.ndarray:
        """Build the bounds of all unknowns, (n, 2), at multipliers between two; shear: largest of each joint,
        (n_joints,)."""
        reach = np.full(self.n_joints, np.inf) if shear is None else shear
        below = np.concatenate([-self.strength.tension, -reach, [low / self.load]])
        above = np.concatenate([self.strength.compression, reach, [high / self.load]])
        return np.column_stack([below, above])

    def cone_rows(
        self, slope: np.ndarray | None = None, fixed: np.ndarray | None = None
    ) -> tuple[csr_matrix, np.ndarray]:
        """±T − slope ΣN ≤ fixed as rows · unknowns ≤ tops; both (n_joints,), by default friction and cohesion."""
        slope = self.strength.friction if slope is None else slope
        fixed = self.strength.cohesion if fixed is None else fixed
        kept = np.flatnonzero(np.isfinite(fixed))
        normal, shear = -(diags(slope) @ self.sums), identity(self.n_joints)
        none = csr_matrix((self.n_joints, 1))
        sides = [hstack([normal, sign * shear, none]).tocsr()[kept] for sign in (1.0, -1.0)]
        return vstack(sides).tocsr(), np.tile(fixed[kept], 2)

    def solve(
        self, cost: np.ndarray, bounds: np.ndarray, rows: csr_matrix | None = None, tops: np.ndarray | None = None
    ) -> OptimizeResult:
        """Least cost of forces in equilibrium, with rows · unknowns ≤ tops."""
        from scipy.optimize import linprog

        look()
        self.programs += 1
        return linprog(
            cost, A_ub=rows, b_ub=tops, A_eq=self.balance, b_eq=self.right, bounds=bounds, method="highs"
        )  # fmt: skip
