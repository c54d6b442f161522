"""Kinks of bars at joints that slide: how far from a joint a bar leaves its line, and how stiffly stones hold it there.

A bar without bending stiffness, of the axial force H, lies on the stone as a string on an elastic bed, kd per length:
beside a joint that slid by s it is w = s/2 exp(−x/Λ) off its line, with Λ = √(H/kd). It crosses the joint with the
slope s/2Λ, and is longer by s²/8Λ in all while that is small. An element between two points Λ/2 on either side of the
joint, each held across the bar by 2 kd Λ, has the same slope, the same force along the joint and the same elongation. H
is the most that the bar can carry there, so that kinks hang on the bar alone, and not on the length of its elements.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.links.drawn_bar import BarNodes, DrawnBar

STRAINED = 0.002  # strain of a bar without a limit, whose force sets its kinks: steel yields there
WITHIN = 0.5  # of the length of bar in a block, that a kink reaches into it at most


class Kinks(NamedTuple):
    """Ends of the kink of a bar at each joint that it crosses."""

    arms: np.ndarray  # before and behind the joint, from the centroids [m], (n_joints, 2, d)
    stiffness: np.ndarray  # of the stone across the bar there [N/m], (n_joints, 2)


def kinks_of(bar: DrawnBar, nodes: BarNodes, right: np.ndarray) -> Kinks:
    """Find the kinks of one bar; right: the first of its nodes behind each joint, (n_joints,)."""
    profile, pairs = bar.profile, np.column_stack([right - 1, right])
    bed = profile.dowel_stiffness or profile.bond_stiffness
    spread = np.sqrt(largest_forces(bar, nodes, right) / bed)[:, None]
    ends = np.concatenate([[0], np.flatnonzero(nodes.blocks[1:] != nodes.blocks[:-1]) + 1, [len(nodes.blocks)]])
    runs = np.add.reduceat(nodes.reach, ends[:-1])  # length of bar from joint to joint
    into = np.minimum(0.5 * spread, WITHIN * np.column_stack([runs[:-1], runs[1:]]))
    from_nodes = np.array([1.0, -1.0]) * (0.5 * nodes.reach[pairs] - into)
    arms = nodes.arms[pairs] + from_nodes[:, :, None] * nodes.along[pairs]
    return Kinks(arms, np.repeat(2.0 * bed * spread, 2, axis=1))


def largest_forces(bar: DrawnBar, nodes: BarNodes, right: np.ndarray) -> np.ndarray:
    """Compute the most that one bar can carry at joints, by yield, bond and anchors [N], (n_joints,), always finite."""
    profile = bar.profile
    strength = np.inf if profile.bond_strength is None else profile.bond_strength
    upto = np.concatenate([[0.0], np.cumsum(nodes.reach)])
    before = np.full(len(right), np.inf) if bar.anchored[0] else strength * upto[right]
    behind = np.full(len(right), np.inf) if bar.anchored[1] else strength * (upto[-1] - upto[right])
    most = min(profile.largest, STRAINED * profile.young * profile.area)
    return np.minimum(np.minimum(before, behind), most)
