"""Clearances: how far blocks can move until gaps of the start have closed, which is neither elastic nor failure.

Gaps are those of a profile (microrotations), or of blocks that do not fit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.geometry import geometry_of, motion_of
from dem_cli.core.contact.start import TOUCHING_GAP
from dem_cli.core.engine.settings import DEFAULT, ClearanceSettings
from dem_cli.core.engine.tracking import JointTracking
from dem_cli.core.kernels.records import Bodies, Joints
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.model import Model


class Play(NamedTuple):
    """Largest motion that closes gaps, from the place of the start; zero where all joints are plane and closed."""

    moved: np.ndarray  # of the centroid [m], (n_blocks,)
    turned: np.ndarray  # [rad], (n_blocks,)


def play_of_start(tracking: JointTracking, bodies: Bodies, clearance: ClearanceSettings = DEFAULT.clearance) -> Play:
    """Compute the motion of blocks until profiles and gaps of the start have closed; zero in fixed geometry."""
    model, smallest = tracking.model, tracking.smallest
    if not tracking.moves:
        return Play(np.zeros(model.n_blocks), np.zeros(model.n_blocks))
    angles = motion_of(model.dimension).microrotations(tracking.joints, tracking.geometry)
    found = play(model, tracking.joints, angles, bodies.positions, clearance)
    faces = tracking.faces_within(bodies, clearance.widest * smallest)
    gaps = geometry_of(model.dimension).open_gaps(model, faces, bodies.corners, clearance.steepest, clearance.bare)
    gaps = gaps[(gaps > TOUCHING_GAP * smallest) & (gaps <= clearance.widest * smallest)]
    if not len(gaps):
        return found
    free = np.flatnonzero(~model.fixed)
    width = median(model.shapes.widths[free]) if len(free) else smallest
    more = gap_play(gaps, width, model.n_blocks, clearance)
    return Play(found.moved + more.moved, found.turned + more.turned)


def gap_play(gaps: np.ndarray, width: float, n_blocks: int, clearance: ClearanceSettings = DEFAULT.clearance) -> Play:
    """Compute the motion of blocks while joints close that are open at the start.

    gaps: between faces near each other [m], (n,); width: of a typical block [m]. A block that turns into a gap takes
    along what stands on it, so that its motion is many times the gap.
    """
    widest = float(gaps.max(initial=0.0))
    moved = min(clearance.amplified * widest, clearance.farthest * width)
    turned = min(clearance.amplified * widest / width, clearance.steepest)
    return Play(np.full(n_blocks, moved), np.full(n_blocks, turned))


def play(
    model: Model,
    joints: Joints,
    angles: np.ndarray,
    positions: np.ndarray,
    clearance: ClearanceSettings = DEFAULT.clearance,
) -> Play:
    """Compute the play of every block, on the way from the supports on which it can move least; joints: those of
    the start.

    A block that turns by θ against its neighbour takes along what stands on it. angles: microrotations of the joints
    [rad], (n_joints,); positions: centroids [m].
    """
    found = Play(np.where(model.fixed, 0.0, np.inf), np.where(model.fixed, 0.0, np.inf))
    if not angles.any():
        return Play(np.zeros(model.n_blocks), np.zeros(model.n_blocks))
    owner, used = joints.owners, joints.kn > 0.0
    reach = np.zeros(joints.blocks.shape)  # from the centroids of both blocks to the farthest point of the joint
    for side in (0, 1):
        arms = joints.points - positions[joints.blocks[owner, side]]
        np.maximum.at(reach[:, side], owner[used], np.sqrt((arms**2).sum(axis=1))[used])
    near = model.fixed.copy()
    while True:
        reached = near[joints.blocks]
        new = near.copy()
        for i in np.flatnonzero(reached[:, 0] != reached[:, 1]):
            side = 1 if reached[i, 0] else 0
            a, b = joints.blocks[i, 1 - side], joints.blocks[i, side]
            far = np.hypot.reduce(positions[b] - positions[a])
            moved = found.moved[a] + found.turned[a] * far + clearance.margin * angles[i] * reach[i, side]
            if moved < found.moved[b]:
                found.moved[b], found.turned[b] = moved, found.turned[a] + clearance.margin * angles[i]
            new[b] = True
        if (new == near).all():
            break
        near = new
    loose = ~near  # touches nothing: nothing holds it, and nothing is known
    found.moved[loose], found.turned[loose] = 0.0, 0.0
    return found


def beyond(free: np.ndarray, since: np.ndarray, before: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Compute the motion of each block that microrotations cannot explain [m], (n_blocks,).

    free: what they can move it, Play.moved or Play.turned times its radius; since: motion since a moment; before, now:
    distance from the place of the start, then and now. Where a block was further away than microrotations take it, it
    had slid, and may rock from one extreme to the other.
    """
    return np.where(before > free, since - 2.0 * free, np.minimum(since, now - free))
