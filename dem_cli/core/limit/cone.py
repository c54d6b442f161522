"""Friction cones of contact points: forces (N, T) = first + Σ shares · amounts, by the cones that span them.

A joint law enters limit analysis through straight lines (laws/envelope.py): friction alone is the cone |T| ≤ μ N;
tension, cohesion and crushing move its tip and cut it off. In the plane the cone has two sides, and amounts g ≥ 0 of
two generators span it; in space it is round, and is held as it is: amounts (g₀, g₁, g₂) with |(g₁, g₂)| ≤ g₀, a
second-order cone, no pyramid. Shares have unit length, so that a large μ does no harm to the numbers; a cap is an upper
limit to the sum of a few of the g and g₀.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from dem_cli.core.contact.chains import STEEP
from dem_cli.core.kernels.records import Joints
from dem_cli.core.laws.envelope import Envelope, frictional
from dem_cli.core.laws.law import Law
from dem_cli.errors import UsageError


class Cone(NamedTuple):
    """Generators of the strength cones: first the round cones, of d amounts each, then single generators; the
    first amount leads."""

    points: np.ndarray  # point of each amount, (n_amounts,) int64
    shares: np.ndarray  # its normal and shear force [-], (n_amounts, d)
    first: np.ndarray  # N and T of every point without any amount [N], (n_points, d)
    n_round: int  # round cones
    cap: np.ndarray  # of each member, −1: none, (n_members,) int64
    share: np.ndarray  # of the leading amount of each member in its cap [-], (n_members,)
    most: np.ndarray  # largest sum of share · leading amount of each cap [N], (n_caps,)

    @property
    def dimension(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.shares.shape[1]

    @property
    def leading(self) -> np.ndarray:
        """Indices of the leading amount of every member, (n_members,)."""
        curved = self.dimension * self.n_round
        return np.concatenate([np.arange(0, curved, self.dimension), np.arange(curved, len(self.points))])

    def motion(self, compatibility: csr_matrix) -> csr_matrix:
        """Motion along every amount by the free degrees of freedom, (n_amounts, n_free): admissible inside the members.

        compatibility: B of limit.matrices.
        """
        n, d = self.shares.shape
        columns = (d * self.points[:, None] + np.arange(d)).ravel()
        starts = np.arange(0, d * n + 1, d)
        return csr_matrix((self.shares.ravel(), columns, starts), (n, compatibility.shape[0])) @ compatibility

    def forces(self, amounts: np.ndarray) -> np.ndarray:
        """N and T of every point [N], (n_points, d)."""
        n_points = len(self.first)
        sums = [np.bincount(self.points, amounts * share, n_points) for share in self.shares.T]
        return self.first + np.column_stack(sums)

    def outside(self, motion: np.ndarray) -> np.ndarray:
        """Compute by how much a motion (n_amounts,) is inadmissible at every member, (n_members,)."""
        around, along = self._split(motion)
        return np.maximum(np.concatenate([np.linalg.norm(around[:, 1:], axis=1) - around[:, 0], -along]), 0.0)

    def admissible(self, amounts: np.ndarray) -> np.ndarray:
        """Project amounts onto the members of the cone, and shorten them to their caps, (n_amounts,)."""
        around, along = self._split(amounts)
        found, capped = np.concatenate([_nearest(around).ravel(), np.maximum(along, 0.0)]), self.cap >= 0
        if capped.any():
            caps = self.cap[capped]
            sums = np.bincount(caps, (self.share * found[self.leading])[capped], len(self.most))
            shorter = np.ones(len(self.cap))
            shorter[capped] = np.minimum(1.0, self.most / np.maximum(sums, np.finfo(float).tiny))[caps]
            found *= self._of_members(shorter)
        return found

    def endless(self, amounts: np.ndarray) -> np.ndarray:
        """Project amounts onto the members without a cap; zero at the others, (n_amounts,)."""
        around, along = self._split(amounts)
        found = np.concatenate([_nearest(around).ravel(), np.maximum(along, 0.0)])
        return np.where(self._of_members(self.cap < 0), found, 0.0)

    def yielding(self, motion: np.ndarray) -> np.ndarray:
        """Least rate of each cap that makes a motion (n_amounts,) admissible, (n_caps,)."""
        rates = np.zeros(len(self.most))
        capped = self.cap >= 0
        np.maximum.at(rates, self.cap[capped], (self.outside(motion) / self.share)[capped])
        return rates

    def _split(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Split values into those of the round cones, (n_round, d), and those of the generators."""
        curved = self.dimension * self.n_round
        return values[:curved].reshape(self.n_round, self.dimension), values[curved:]

    def _of_members(self, values: np.ndarray) -> np.ndarray:
        """Repeat the value of each member for all its amounts, (n_amounts,)."""
        return np.concatenate([np.repeat(values[: self.n_round], self.dimension), values[self.n_round :]])


def _nearest(amounts: np.ndarray) -> np.ndarray:
    """Project amounts onto round cones, (n, d)."""
    lead, length = amounts[:, 0], np.linalg.norm(amounts[:, 1:], axis=1)
    inside, opposite = length <= lead, length <= -lead
    middle = 0.5 * (lead + length)
    turned = amounts * (middle / np.where(length > 0.0, length, 1.0))[:, None]
    turned[:, 0] = middle
    return np.where(inside[:, None], amounts, np.where(opposite[:, None], 0.0, turned))


class _Tips(NamedTuple):
    """Geometry of the cones of all points, and the points with friction, a blunt tip or no limit."""

    cosine: np.ndarray  # of the angle of friction [-], (n_points,)
    sine: np.ndarray
    tip: np.ndarray  # tension that the tip holds [N], (n_points,)
    width: np.ndarray  # of the tip, half [N]; infinite: no limit to the shear force, (n_points,)
    rough: np.ndarray  # points with friction
    blunt: np.ndarray  # with a tip of some width
    tied: np.ndarray  # that cannot be pulled apart
    stuck: np.ndarray  # that cannot slide
    crushing: np.ndarray  # cap of each point that can be crushed, −1: cannot, (n_points,)


class _Members(NamedTuple):
    """Members of one kind, as in `Cone`: their points, shares, caps and shares in these."""

    points: np.ndarray
    shares: np.ndarray
    cap: np.ndarray
    share: np.ndarray


def cone_of(strength: Envelope, dimension: int) -> Cone:
    """Build the strength cones of all points from their envelope."""
    friction = strength.friction
    cosine = 1.0 / np.sqrt(1.0 + friction**2)
    tip = np.where(np.isfinite(strength.tension), strength.tension, 0.0)
    width = np.where(np.isfinite(strength.cohesion), strength.cohesion - friction * tip, np.inf)
    crushed = np.flatnonzero(np.isfinite(strength.compression))
    crushing = np.full(len(friction), -1)
    crushing[crushed] = np.arange(len(crushed))
    tips = _Tips(
        cosine, cosine * friction, tip, width,
        rough=np.flatnonzero(friction > 0.0),
        blunt=np.flatnonzero((width > 0.0) & np.isfinite(width)),
        tied=np.flatnonzero(np.isinf(strength.tension)),
        stuck=np.flatnonzero(np.isinf(width)),
        crushing=crushing,
    )  # fmt: skip
    first = np.zeros((len(friction), dimension))
    first[:, 0] -= tip
    return SPANNED[dimension](tips, first, (strength.compression + tip)[crushed])


def _by_two_sides(tips: _Tips, first: np.ndarray, most: np.ndarray) -> Cone:
    """Build the cones in the plane: a generator along either side, and one along a tip of some width."""
    every, blunt = np.arange(len(first)), tips.blunt
    first[blunt, 1] = -tips.width[blunt]
    members = [
        _generators(every, (tips.cosine, tips.sine), tips.crushing, tips.cosine),
        _generators(tips.rough, (tips.cosine[tips.rough], -tips.sine[tips.rough]),
                    tips.crushing[tips.rough], tips.cosine[tips.rough]),
        _generators(blunt, (0.0, 1.0), len(most) + np.arange(len(blunt))),
        *_without_limit(tips, 2),
    ]  # fmt: skip
    return _joined(members, first, 0, np.concatenate([most, 2.0 * tips.width[blunt]]))


def _as_round_cones(tips: _Tips, first: np.ndarray, most: np.ndarray) -> Cone:
    """Build the cones in space: round cones of rough points, round tips (no N, |T| up to their cap), generators of
    smooth points."""
    rough, blunt, smooth = tips.rough, tips.blunt, np.flatnonzero(tips.sine == 0.0)
    round_ones = [
        _round(rough, tips.cosine[rough], tips.sine[rough], tips.crushing[rough]),
        _round(blunt, np.zeros(len(blunt)), np.ones(len(blunt)), len(most) + np.arange(len(blunt))),
    ]
    generators = [_generators(smooth, (1.0, 0.0, 0.0), tips.crushing[smooth]), *_without_limit(tips, 3)]
    return _joined(
        [*round_ones, *generators], first, len(rough) + len(blunt), np.concatenate([most, tips.width[blunt]])
    )


SPANNED: dict[int, Callable[[_Tips, np.ndarray, np.ndarray], Cone]] = {2: _by_two_sides, 3: _as_round_cones}


def _without_limit(tips: _Tips, dimension: int) -> list[_Members]:
    """Build generators against tension and along every tangent, of points that have no limit there."""
    along = np.eye(dimension)
    sides = [sign * tangent for tangent in along[1:] for sign in (1.0, -1.0)]
    return [_generators(tips.tied, -along[0]), *(_generators(tips.stuck, side) for side in sides)]


def _generators(points, direction, cap=-1, share=1.0) -> _Members:
    """Build one generator for each point; direction: of d numbers or arrays (n,)."""
    n = len(points)
    shares = np.column_stack([np.broadcast_to(part, n) for part in direction])
    return _Members(points, shares, np.broadcast_to(cap, n), np.broadcast_to(share, n))


def _round(points, cosine, sine, cap) -> _Members:
    """Build one round cone for each point; its cap counts the pressing part of its leading amount, a tip without
    any as a whole."""
    n = len(points)
    shares = np.zeros((n, 3, 3))
    shares[:, 0, 0], shares[:, 1, 1], shares[:, 2, 2] = cosine, sine, sine
    return _Members(np.repeat(points, 3), shares.reshape(3 * n, 3), cap, np.where(cosine > 0.0, cosine, 1.0))


def _joined(members: list[_Members], first: np.ndarray, n_round: int, most: np.ndarray) -> Cone:
    points, shares, cap, share = (np.concatenate(parts) for parts in zip(*members, strict=True))
    return Cone(points, shares, first, n_round, cap, share, most)


def envelope_of(
    joints: Joints,
    law: Law,
    heads_frictionless: bool = False,
    residual: bool = False,
    bonds: np.ndarray | None = None,
) -> Envelope:
    """Return the strength of every point; residual: the strength left after sliding and opening for long.

    bonds: points that cohesion and tension hold, (n_points,) bool; None: all. heads_frictionless: joints steeper than
    45° to the horizontal carry no shear force (thesis Table 5-3).
    Raises UsageError where the strength of the law is not held by straight lines.
    """
    if law.envelope is None:
        raise UsageError(
            f"limit analysis needs joints whose shear strength grows in proportion to the normal force (cohesion + "
            f"friction × normal force); that of law '{law.name}' is curved"
        )
    strength = (residual and law.residual) or law.envelope
    found = strength(joints.law[joints.owners], joints.kn)
    if bonds is not None and not bonds.all():
        loose = {name: np.where(bonds, getattr(found, name), 0.0) for name in ("cohesion", "tension")}
        found = found._replace(**loose)
    if not heads_frictionless:
        return found
    smooth = {name: np.where(steep(joints), 0.0, getattr(found, name)) for name in ("friction", "cohesion", "dilation")}
    return found._replace(**smooth)


def steep(joints: Joints) -> np.ndarray:
    """Find points of head joints, steeper than 45° to the horizontal, (n_points,) bool."""
    up = joints.points.shape[1] - 1  # the vertical part of the normals, which come first in the frames
    return np.abs(joints.frames[:, up]) < STEEP


def friction_of(joints: Joints, law: Law, heads_frictionless: bool = False) -> np.ndarray:
    """Return the friction coefficient of every point of joints with friction alone [-], (n_points,).

    heads_frictionless: joints steeper than 45° to the horizontal carry no friction (thesis Table 5-3).
    Raises UsageError where the law remembers anything, or has more than |T| ≤ μ N.
    """
    if law.envelope is not None and not law.bonded and not law.n_memory(2):
        found = envelope_of(joints, law, heads_frictionless)
        if all(np.array_equal(*pair) for pair in zip(found, frictional(found.friction), strict=True)):
            return found.friction
    raise UsageError(
        f"limit analysis needs joints whose largest shear force is friction × normal force; "
        f"law '{law.name}' is not of that kind"
    )
