"""An arch of rigid blocks whose right support moves: hinges by least potential energy, then exact finite motion.

The chain support, blocks, support touches along joints, each a segment with two ends. Without sliding it can follow a
moving support as two rigid pieces on three hinges, each an end of a joint: the left piece turns about a point of the
left support, the right one about a point of the right support, and they share the middle one. Of all triples whose
joints open and do not overlap, the one with the lowest potential energy is taken (Heyman 1995, Ochsendorf 2006).
Hinges stay where they form. Nothing of dem_cli is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from oracle.limit_lp import area_and_centroid, interfaces

TINY = 1e-9


class Motion(NamedTuple):
    """How the chain follows."""

    hinges: tuple[tuple[int, int], ...]  # joint and end of each, from the left
    energy: float  # potential energy gained [J]
    displacements: np.ndarray  # of the centroids of the blocks [m], (n, 2)
    rotations: np.ndarray  # of the blocks [rad], (n,)


class Rigid(NamedTuple):
    """A motion of a rigid piece: turned by an angle about a point, which itself moves."""

    about: np.ndarray
    angle: float
    shift: np.ndarray

    def of(self, point: np.ndarray) -> np.ndarray:
        c, s = np.cos(self.angle), np.sin(self.angle)
        arm = point - self.about
        return self.about + self.shift + np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])


STILL = Rigid(np.zeros(2), 0.0, np.zeros(2))


def follow(polygons: Sequence[np.ndarray], weights: np.ndarray, shift: np.ndarray) -> Motion:
    """Supports and blocks from left to right, weights of the blocks between [N], shift of the right support [m].

    Raises ValueError where the chain cannot follow.
    """
    touching = interfaces(polygons)
    assert [(one.a, one.b) for one in touching] == [(i, i + 1) for i in range(len(polygons) - 1)], "no chain"
    joints, normals = np.array([one.ends for one in touching]), np.array([one.normal for one in touching])
    centroids = np.array([area_and_centroid(polygon)[1] for polygon in polygons[1:-1]])
    support = Rigid(np.zeros(2), 0.0, np.asarray(shift, float))
    found = []
    for chosen in combinations(range(len(joints)), 3):
        for ends in product((0, 1), repeat=3):
            pieces = _pieces([joints[j, e] for j, e in zip(chosen, ends)], support)
            if pieces is not None and _opens(joints, normals, chosen, ends, (STILL, *pieces, support)):
                found.append(_motion(chosen, ends, pieces, support, centroids, weights))
    if not found:
        raise ValueError("no mechanism of three hinges follows the support")
    return min(found, key=lambda motion: motion.energy)


def _pieces(hinges: list[np.ndarray], support: Rigid) -> tuple[Rigid, Rigid] | None:
    """Motions of both pieces: the middle hinge lies on circles about the outer ones, nearest to where it was."""
    left, middle, right = hinges
    moved = support.of(right)
    r1, r2, apart = np.hypot(*(middle - left)), np.hypot(*(middle - right)), np.hypot(*(moved - left))
    if apart < TINY or apart > r1 + r2 or apart < abs(r1 - r2):
        return None
    along = (r1**2 - r2**2 + apart**2) / (2.0 * apart)
    across = np.sqrt(max(r1**2 - along**2, 0.0))
    e = (moved - left) / apart
    places = [left + along * e + side * across * np.array([-e[1], e[0]]) for side in (1.0, -1.0)]
    new = min(places, key=lambda place: np.hypot(*(place - middle)))
    return (
        Rigid(left, _turn(middle - left, new - left), np.zeros(2)),
        Rigid(right, _turn(middle - right, new - moved), moved - right),
    )


def _turn(before: np.ndarray, after: np.ndarray) -> float:
    angle = np.arctan2(after[1], after[0]) - np.arctan2(before[1], before[0])
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _opens(
    joints: np.ndarray, normals: np.ndarray, chosen: tuple[int, ...], ends: tuple[int, ...], motions: tuple[Rigid, ...]
) -> bool:
    """Whether the other end of every hinged joint opens: there its right side moves away from its left one."""
    for number, (joint, end) in enumerate(zip(chosen, ends)):
        other = joints[joint, 1 - end]
        if (motions[number + 1].of(other) - motions[number].of(other)) @ normals[joint] < -TINY:
            return False
    return True


def _motion(
    chosen: tuple[int, ...], ends: tuple[int, ...], pieces: tuple[Rigid, Rigid], support: Rigid,
    centroids: np.ndarray, weights: np.ndarray,
) -> Motion:  # fmt: skip
    motions = []
    for block in range(len(centroids)):  # block i lies between joints i and i + 1
        motions.append((STILL, *pieces, support)[sum(block >= joint for joint in chosen)])
    moved = np.array([motion.of(point) - point for motion, point in zip(motions, centroids)])
    turned = np.array([motion.angle for motion in motions])
    return Motion(tuple(zip(chosen, ends)), float(weights @ moved[:, 1]), moved, turned)
