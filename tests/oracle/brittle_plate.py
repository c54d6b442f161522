"""Brittle plate of rigid blocks bent out of its plane, load by load from one cracked point to the next, without time.

Blocks are prisms across the plate. Joints have points with springs along three axes, linear until a point cracks
(Mohr-Coulomb with a tension cut-off); a cracked point is a contact without friction. Loads are proportional, so that
all forces are: the load at which the next point cracks follows from one linear solution, and the highest of them all is
the strength (sequentially linear analysis, Rots 2001, of points that lose everything at once). Nothing is shared with
the package: outlines, joints, stiffness and equilibrium are worked out here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import Legendre

NEAR = 1e-7  # m


class Rule(NamedTuple):
    """Points of a square with corners (±1, ±1): places (n, 2), shares of its area (n,)."""

    places: np.ndarray
    shares: np.ndarray


def lobatto(n: int) -> Rule:
    """n x n Gauss-Lobatto points (Abramowitz and Stegun 25.4.32)."""
    last = Legendre.basis(n - 1)
    x = np.concatenate([[-1.0], np.sort(last.deriv().roots().real), [1.0]])
    w = 1.0 / (n * (n - 1) * last(x) ** 2)
    return Rule(np.array([(a, b) for a in x for b in x]), np.outer(w, w).ravel())


def nine() -> Rule:
    """Corners, centre, and points at 0.4 of the half diagonals, with 4/15, 19/60 and 5/12 of the area."""
    corners = np.array([(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
    places = np.concatenate([corners, 0.4 * corners, [[0.0, 0.0]]])
    return Rule(places, np.array(4 * [1 / 15] + 4 * [5 / 48] + [19 / 60]))


class Mortar(NamedTuple):
    """Strengths [Pa], stiffness [Pa/m]."""

    tension: float
    cohesion: float
    friction: float
    kn: float
    ks: float


class Points(NamedTuple):
    """Contact points: blocks on either side, places [m], unit normals in the plane of the plate, areas [m2]."""

    blocks: np.ndarray  # (n, 2)
    places: np.ndarray  # (n, 3)
    normals: np.ndarray  # (n, 2)
    areas: np.ndarray  # (n,)


def points_of(outlines: Sequence[np.ndarray], thickness: float, rule: Rule) -> Points:
    """Points of all joints between polygons (k, 2) that share parts of their sides, of a plate in the x–z plane."""
    blocks, places, normals, areas = [], [], [], []
    for i, one in enumerate(outlines):
        for j, other in enumerate(outlines[:i]):
            for p, q in zip(one, np.roll(one, -1, axis=0), strict=True):
                along = (q - p) / np.hypot(*(q - p))
                normal = np.array([along[1], -along[0]])
                for r, s in zip(other, np.roll(other, -1, axis=0), strict=True):
                    if max(abs((r - p) @ normal), abs((s - p) @ normal)) > NEAR:
                        continue
                    ends = sorted([(r - p) @ along, (s - p) @ along])
                    low, high = max(0.0, ends[0]), min(float(np.hypot(*(q - p))), ends[1])
                    if high - low < 1e3 * NEAR:
                        continue
                    at = p + np.outer(0.5 * (low + high) + 0.5 * (high - low) * rule.places[:, 0], along)
                    across = 0.5 * thickness * (1.0 + rule.places[:, 1])
                    places.append(np.column_stack([at[:, 0], across, at[:, 1]]))
                    areas.append(rule.shares * thickness * (high - low))
                    blocks += len(rule.shares) * [(i, j)]
                    normals += len(rule.shares) * [normal]
    return Points(np.array(blocks), np.concatenate(places), np.array(normals), np.concatenate(areas))


def _motions(points: Points, centres: np.ndarray) -> np.ndarray:
    """Opening, slip along the joint, slip across the plate, per unit of each motion of the blocks, (n, 3, 6 blocks)."""
    n = len(points.areas)
    normal = np.column_stack([points.normals[:, 0], np.zeros(n), points.normals[:, 1]])
    axes = np.stack([normal, np.cross(normal, [0.0, 1.0, 0.0]), np.tile([0.0, 1.0, 0.0], (n, 1))], axis=1)
    found = np.zeros((n, 3, 6 * len(centres)))
    for side, sign in ((0, -1.0), (1, 1.0)):  # the normal looks out of the first block
        arms = points.places - centres[points.blocks[:, side]]
        turns = np.cross(arms[:, None, :], axes)
        for k in range(3):
            for c in range(3):
                found[np.arange(n), k, 6 * points.blocks[:, side] + c] = sign * axes[:, k, c]
                found[np.arange(n), k, 6 * points.blocks[:, side] + 3 + c] = sign * turns[:, k, c]
    return found


class History(NamedTuple):
    """Loads at which one point after the other cracks, in order."""

    loads: np.ndarray

    @property
    def first(self) -> float:
        """Load of the first crack."""
        return float(self.loads[0])

    @property
    def strength(self) -> float:
        """The highest load of all."""
        return float(self.loads.max())


def cracks(
    outlines: Sequence[np.ndarray],
    thickness: float,
    held: int,
    loads: Sequence[tuple[int, np.ndarray, np.ndarray]],
    mortar: Mortar,
    rule: Rule,
    least: float = 0.3,
) -> History:
    """Cracks of a plate until it carries less than a share of the highest load, or falls apart.

    loads: block, place (3,), force (3,) at a load of 1.
    """
    points = points_of(outlines, thickness, rule)
    middles = np.array([_centroid(outline) for outline in outlines])
    centres = np.column_stack([middles[:, 0], np.full(len(middles), thickness / 2.0), middles[:, 1]])
    motions = _motions(points, centres)
    free = np.setdiff1d(np.arange(6 * len(outlines)), 6 * held + np.arange(6))
    motions = motions[:, :, free]
    forces = np.zeros(6 * len(outlines))
    for block, place, force in loads:
        forces[6 * block : 6 * block + 3] += force
        forces[6 * block + 3 : 6 * block + 6] += np.cross(place - centres[block], force)
    forces = forces[free]
    springs = np.array([mortar.kn, mortar.ks, mortar.ks]) * points.areas[:, None]
    whole, found = np.ones(len(points.areas), bool), list[float]()
    pressed = np.zeros(len(points.areas), bool)
    while True:
        for _ in range(50):  # which of the cracked points are pressed
            acting = springs * np.where(whole[:, None], 1.0, np.array([1.0, 0.0, 0.0]) * pressed[:, None])
            stiffness = np.einsum("pki,pk,pkj->ij", motions, acting, motions, optimize=True)
            if np.linalg.cond(stiffness) > 1e13:
                return History(np.array(found))
            motion = np.einsum("pki,i->pk", motions, np.linalg.solve(stiffness, forces))
            now = ~whole & (motion[:, 0] < 0.0)
            if (now == pressed).all():
                break
            pressed = now
        normal = -springs[:, 0] * motion[:, 0] / points.areas
        shear = np.hypot(springs[:, 1] * motion[:, 1], springs[:, 2] * motion[:, 2]) / points.areas
        # at a load λ a whole point holds while −λ N <= ft and λ (S − μ N) <= c
        over = np.maximum(-normal / mortar.tension, (shear - mortar.friction * normal) / mortar.cohesion)
        over[~whole] = 0.0
        worst = over.max()
        if worst <= 0.0:
            return History(np.array(found))
        found.append(1.0 / worst)
        if found[-1] < least * max(found):
            return History(np.array(found))
        whole &= over < worst * (1.0 - 1e-6)  # alike ones together


def _centroid(outline: np.ndarray) -> np.ndarray:
    after = np.roll(outline, -1, axis=0)
    areas = outline[:, 0] * after[:, 1] - outline[:, 1] * after[:, 0]
    return ((outline + after) * areas[:, None]).sum(axis=0) / (3.0 * areas.sum())
