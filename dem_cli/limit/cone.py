"""The friction cone of every contact point, by the vectors that span it: (N, T) = Σ g · generator, g ≥ 0; 2D.

A joint law enters limit analysis through its largest shear force alone, which must grow in proportion to
the normal force: |T| ≤ μ N. Generators have unit length, so that a large μ does no harm to the numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from dem_cli.contact.chains import STEEP
from dem_cli.errors import UsageError
from dem_cli.kernels.records import Joints
from dem_cli.laws.law import Law

SAME = 1e-9  # relative; larger differences from proportion are the law's


class Cone(NamedTuple):
    """Generators: two of each frictional point, one of the others."""

    points: np.ndarray  # point of each generator, (n_generators,) int64
    normal: np.ndarray  # its share of normal force, cos φ [-], (n_generators,)
    shear: np.ndarray  # its share of shear force along the tangent, ±sin φ [-], (n_generators,)

    def motion(self, compatibility: csr_matrix) -> csr_matrix:
        """Motion of every generator by the free degrees of freedom, (n_generators, n_free): ≥ 0 is admissible.

        compatibility: B of limit.matrices.
        """
        n = len(self.points)
        columns = np.column_stack([2 * self.points, 2 * self.points + 1]).ravel()
        shares = np.column_stack([self.normal, self.shear]).ravel()
        return csr_matrix((shares, columns, np.arange(0, 2 * n + 1, 2)), (n, compatibility.shape[0])) @ compatibility

    def forces(self, amounts: np.ndarray, n_points: int) -> np.ndarray:
        """N and T of every point from the amounts of all generators [N], (n_points·2,)."""
        normal = np.bincount(self.points, amounts * self.normal, n_points)
        shear = np.bincount(self.points, amounts * self.shear, n_points)
        return np.column_stack([normal, shear]).ravel()


def cone_of(friction: np.ndarray) -> Cone:
    """The cone |T| ≤ μ N of every point, from its μ, (n_points,)."""
    cosine = 1.0 / np.sqrt(1.0 + friction**2)
    rough = np.flatnonzero(friction > 0.0)
    points = np.concatenate([np.arange(len(friction)), rough])
    shear = np.concatenate([cosine * friction, -(cosine * friction)[rough]])
    return Cone(points, cosine[points], shear)


def friction_of(joints: Joints, law: Law, heads_frictionless: bool = False) -> np.ndarray:
    """Friction coefficient of every point [-], (n_points,).

    heads_frictionless: joints steeper than 45° to the horizontal carry no friction (thesis Table 5-3); 2D.
    Raises UsageError where the largest shear force of the law does not grow in proportion to the normal force.
    """
    owner, n_points = joints.owners, len(joints.kn)
    linear = not (law.bonded or law.n_memory(2))
    if linear:
        memory = np.zeros((n_points, 0))
        one, two, none = (
            law.shear_limit(joints.law[owner], np.full(n_points, n), memory, joints.kn) for n in (1.0, 2.0, 0.0)
        )
        linear = (np.abs(two - 2.0 * one) <= SAME * np.abs(one)).all() and (none == 0.0).all()
    if not linear:
        raise UsageError(
            f"limit analysis needs joints whose largest shear force is friction × normal force; "
            f"law '{law.name}' is not of that kind"
        )
    friction = one.copy()
    if heads_frictionless:
        friction[np.abs(joints.frames[:, 1]) < STEEP] = 0.0
    return friction
