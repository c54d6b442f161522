"""Joints in fixed geometry: all points of a joint in one plane with one frame, that of its closest point."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.rotation import frames
from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.records import Joints


def in_planes(joints: Joints, gaps: np.ndarray, positions: np.ndarray) -> FixedJoints:
    """Project the points of each joint into one plane, through the point with the smallest gap, across its normal.

    gaps: of the points [m], (n_points,); positions: centroids of the blocks [m], (n_blocks, d). Places are counted from
    the middle of the points. Where an end of a joint is open, this is not quite where its point was.
    """
    d, starts, owners = positions.shape[1], joints.starts, joints.owners
    closest = _closest(gaps, starts)
    axes = joints.frames[closest, : 2 if d == 2 else d * d]
    along = frames(axes, d)
    middle = _means(joints.points, starts)
    across = ((joints.points[closest] - middle) * along[:, 0]).sum(axis=1)
    anchors = middle + across[:, None] * along[:, 0]
    places = ((joints.points - anchors[owners])[:, None] * along[owners, 1:]).sum(axis=2)
    arms = anchors[:, None] - positions[joints.blocks]
    return FixedJoints(
        blocks=joints.blocks,
        starts=starts,
        axes=np.ascontiguousarray(axes),
        anchors=anchors,
        arms=np.ascontiguousarray(arms.reshape(-1, 2 * d)),
        places=np.ascontiguousarray(places),
        kn=joints.kn,
        ks=joints.ks,
        law=joints.law,
        integrated=joints.integrated,
        after=joints.after,
        fans=joints.fans,
        faint=joints.faint,
        back=joints.back,
        torsion=joints.torsion,
    )


def _closest(gaps: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Find the point with the smallest gap of each joint, the first of equals, (n_joints,)."""
    owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    return np.lexsort((np.arange(len(gaps)), gaps, owners))[starts[:-1]]


def _means(values: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Compute the mean over the points of each joint, (n_joints, d)."""
    if len(starts) == 1:
        return np.zeros((0, values.shape[1]))
    return np.add.reduceat(values, starts[:-1], axis=0) / np.diff(starts)[:, None]
