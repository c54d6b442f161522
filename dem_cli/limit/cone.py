"""The forces of every contact point, by the vectors that span them: (N, T) = first + Σ g · generator, g ≥ 0; 2D.

A joint law enters limit analysis through straight lines (laws/envelope.py): friction alone is the cone |T| ≤ μ N;
tension, cohesion and crushing move its tip and cut it off. Generators have unit length, so that a large μ does no harm
to the numbers; a cap is an upper limit to the sum of a few of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from dem_cli.contact.chains import STEEP
from dem_cli.errors import UsageError
from dem_cli.kernels.records import Joints
from dem_cli.laws.envelope import Envelope
from dem_cli.laws.law import Law


class Cone(NamedTuple):
    """Generators: two of each frictional point, one of the others, one more along a joint with cohesion at its tip."""

    points: np.ndarray  # point of each generator, (n_generators,) int64
    normal: np.ndarray  # its share of normal force, cos φ [-], (n_generators,)
    shear: np.ndarray  # its share of shear force along the tangent, ±sin φ [-], (n_generators,)
    first: np.ndarray  # N and T of every point without any generator [N], (n_points, 2)
    cap: np.ndarray  # of each generator, −1: none, (n_generators,) int64
    share: np.ndarray  # of each generator in its cap [-], (n_generators,)
    most: np.ndarray  # largest sum of share · g of each cap [N], (n_caps,)

    def motion(self, compatibility: csr_matrix) -> csr_matrix:
        """Motion of every generator by the free degrees of freedom, (n_generators, n_free): ≥ 0 is admissible.

        compatibility: B of limit.matrices.
        """
        n = len(self.points)
        columns = np.column_stack([2 * self.points, 2 * self.points + 1]).ravel()
        shares = np.column_stack([self.normal, self.shear]).ravel()
        return csr_matrix((shares, columns, np.arange(0, 2 * n + 1, 2)), (n, compatibility.shape[0])) @ compatibility

    def forces(self, amounts: np.ndarray) -> np.ndarray:
        """N and T of every point from the amounts of all generators [N], (n_points·2,)."""
        n_points = len(self.first)
        normal = np.bincount(self.points, amounts * self.normal, n_points)
        shear = np.bincount(self.points, amounts * self.shear, n_points)
        return (self.first + np.column_stack([normal, shear])).ravel()

    def admissible(self, amounts: np.ndarray) -> np.ndarray:
        """The nearest amounts that are not negative and within the caps, (n_generators,)."""
        found = np.maximum(amounts, 0.0)
        capped = self.cap >= 0
        if capped.any():
            caps = self.cap[capped]
            sums = np.bincount(caps, (self.share * found)[capped], len(self.most))
            found[capped] *= np.minimum(1.0, self.most / np.maximum(sums, np.finfo(float).tiny))[caps]
        return found

    def yielding(self, motion: np.ndarray) -> np.ndarray:
        """Least rate of each cap that makes the motion of its generators admissible, (n_caps,).

        motion: of all generators, (n_generators,).
        """
        rates = np.zeros(len(self.most))
        capped = self.cap >= 0
        np.maximum.at(rates, self.cap[capped], -motion[capped] / self.share[capped])
        return rates


def cone_of(strength: Envelope) -> Cone:
    """The generators of all points."""
    friction = strength.friction
    cosine = 1.0 / np.sqrt(1.0 + friction**2)
    tip = np.where(np.isfinite(strength.tension), strength.tension, 0.0)
    width = np.where(np.isfinite(strength.cohesion), strength.cohesion - friction * tip, np.inf)  # of the tip, half
    every, rough = np.arange(len(friction)), np.flatnonzero(friction > 0.0)
    blunt = np.flatnonzero((width > 0.0) & np.isfinite(width))
    tied, stuck = np.flatnonzero(np.isinf(strength.tension)), np.flatnonzero(np.isinf(width))
    points = np.concatenate([every, rough, blunt, tied, stuck, stuck])
    parts = [len(every), len(rough), len(blunt), len(tied), 2 * len(stuck)]
    normal = np.concatenate([cosine, cosine[rough], np.zeros(len(blunt)), -np.ones(len(tied)), np.zeros(parts[4])])
    shear = np.concatenate(
        [cosine * friction, -(cosine * friction)[rough], np.ones(len(blunt)), np.zeros(len(tied)),
         np.ones(len(stuck)), -np.ones(len(stuck))]
    )  # fmt: skip
    first = np.zeros((len(friction), 2))
    first[:, 0] -= tip
    first[blunt, 1] = -width[blunt]
    crushed = np.flatnonzero(np.isfinite(strength.compression))
    of_point = np.full(len(friction), -1)
    of_point[crushed] = np.arange(len(crushed))
    cap = np.concatenate([of_point, of_point[rough], len(crushed) + np.arange(len(blunt)), np.full(sum(parts[3:]), -1)])
    share = np.concatenate([cosine, cosine[rough], np.ones(sum(parts[2:]))])
    most = np.concatenate([(strength.compression + tip)[crushed], 2.0 * width[blunt]])
    return Cone(points, normal, shear, first, cap, share, most)


def envelope_of(joints: Joints, law: Law, heads_frictionless: bool = False, residual: bool = False) -> Envelope:
    """The largest forces of every point; residual: what is left of them after sliding and opening for long.

    heads_frictionless: joints steeper than 45° to the horizontal carry no shear force (thesis Table 5-3); 2D.
    Raises UsageError where the strength of the law is not held by straight lines.
    """
    if law.envelope is None:
        raise UsageError(
            f"limit analysis needs joints whose shear strength grows in proportion to the normal force (cohesion + "
            f"friction × normal force); that of law '{law.name}' is curved"
        )
    strength = (residual and law.residual) or law.envelope
    found = strength(joints.law[joints.owners], joints.kn)
    if not heads_frictionless:
        return found
    heads = np.abs(joints.frames[:, 1]) < STEEP
    smooth = {name: np.where(heads, 0.0, getattr(found, name)) for name in ("friction", "cohesion", "dilation")}
    return found._replace(**smooth)


def friction_of(joints: Joints, law: Law, heads_frictionless: bool = False) -> np.ndarray:
    """Friction coefficient of every point of joints with friction and nothing else [-], (n_points,).

    heads_frictionless: joints steeper than 45° to the horizontal carry no friction (thesis Table 5-3); 2D.
    Raises UsageError where the law remembers anything, or has more than |T| ≤ μ N.
    """
    if law.envelope is None or law.bonded or law.n_memory(2):
        raise UsageError(
            f"limit analysis needs joints whose largest shear force is friction × normal force; "
            f"law '{law.name}' is not of that kind"
        )
    return envelope_of(joints, law, heads_frictionless).friction
