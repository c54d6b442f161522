"""Gaps of the undeformed structure: which close like joints and which stay open; one rule for all of the package.

A gap of at most CLOSING_GAP of the smaller part is a joint that has yet to close: what lies over it is held up, and on
the way to failure geometry moves. A wider one is meant to be there: nothing rests on it, and where the geometry of the
start is kept it stays open. Up to NOTICED_GAP a run says so, with the blocks and the width. Blocks that are diagonal
neighbours have no gap, however near their edges or corners are: closed, they would carry no force.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from dem_cli.core.contact.detect import find_joints
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.joints import Faces, JointProperties, Joints
from dem_cli.core.contact.start import TOUCHING_GAP, bodies_at_rest, joints_of_start
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import inside_blocks, undeformed
from dem_cli.core.model.scales import smallest_edge

CLOSING_GAP = 1e-3  # of the size of the smaller part
NOTICED_GAP = 0.05  # of the same: wider ones are no joints that anybody forgot to close
SAMPLED = (0.0, 0.3, 0.6, 0.9)  # of the way from the middle of such a gap to its ends: are other blocks there?
STEEPEST = 0.1  # sine of the angle between faces that look at each other
SLIVER = 1e-3  # of the size of the smaller part: faces that look at each other over less are beside each other


class StartGaps(NamedTuple):
    """Pairs of blocks across a gap, the narrowest first: faces that look at each other, or a corner over a face."""

    blocks: np.ndarray  # (n, 2)
    widths: np.ndarray  # where they are nearest [m], negative: overlap, (n,)
    close: np.ndarray  # whether the gap closes like a joint, (n,) bool

    def where(self, kept: np.ndarray) -> Self:
        """Select the gaps of a mask (n,) bool."""
        return type(self)(*(field[kept] for field in self))


def joined(separation: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Test whether parts touch, or have a gap that closes like a joint, (n,) bool.

    separation: of two parts [m], (n,); sizes: of the smaller one [m], (n,).
    """
    return separation <= CLOSING_GAP * sizes


def joint_reach(model: Model) -> float:
    """Compute the largest gap that may close like a joint in this model [m]."""
    free = ~model.fixed[model.part_blocks]
    return CLOSING_GAP * float((model.parts.sizes[free] if free.any() else model.parts.sizes).max())


def notice_reach(model: Model) -> float:
    """Compute the largest gap that closes like a joint or is reported in a warning [m]."""
    free = ~model.fixed[model.part_blocks]
    return max(joint_reach(model), NOTICED_GAP * median(model.parts.sizes[free]) if free.any() else 0.0)


def gaps_of_start(model: Model) -> StartGaps:
    """Find the gaps of the undeformed structure that close, and those that are narrow enough to be named."""
    sizes, corners = model.parts.sizes, undeformed(model)
    faces = find_joints(model, corners, notice_reach(model))
    scale, narrow = sizes[faces.parts].min(axis=1), geometry_of(model.dimension)
    apart = np.abs(faces.separation) > TOUCHING_GAP * smallest_edge(model)
    close, least = joined(faces.separation, scale), SLIVER * scale
    facing = narrow.facing(model, faces, corners, STEEPEST, least)
    noticed = apart & ~close & facing & (faces.separation <= NOTICED_GAP * scale)
    noticed[noticed] = ~_filled(model, faces.where(noticed), corners)
    closing = apart & close
    closing[closing] = facing[closing] | narrow.touching(model, faces.where(closing), corners, least[closing])
    kept = closing | noticed
    blocks, widths, close = model.part_blocks[faces.parts[kept]], faces.separation[kept], close[kept]
    order = np.argsort(widths, kind="stable")
    _, first = np.unique(np.sort(blocks[order], axis=1), axis=0, return_index=True)
    nearest = order[np.sort(first)]  # one for each two blocks
    return StartGaps(blocks[nearest], widths[nearest], close[nearest])


def _filled(model: Model, faces: Faces, corners: np.ndarray) -> np.ndarray:
    """Test whether other blocks fill the whole gap between two faces, a thin tip or a sliver, (n,).

    All places are looked up at once: there may be as many such pairs as there are stones.
    """
    n, narrow, places = len(faces.parts), geometry_of(model.dimension), []
    for pair in range(n):
        found = narrow.drawn(model, faces.where(np.array([pair])), corners, 0.0)
        between = 0.5 * (found.on_first + found.on_second)
        middle = between.mean(axis=0) if len(between) else between
        places.append(np.concatenate([middle + share * (between - middle) for share in SAMPLED]))
    counts = np.array([len(own) for own in places], np.int64)
    outside = ~inside_blocks(model, np.concatenate(places)) if n else np.zeros(0, bool)
    return (counts > 0) & (np.bincount(np.repeat(np.arange(n), counts), outside, minlength=n) == 0)


def wedges_of_start(model: Model, properties: JointProperties) -> StartGaps:
    """Find wedge-shaped joints, touching at one end and open at the other by a small angle, with their widest gaps.

    An end that is open by more than STEEPEST of the way to where it touches is far from anything: a corner on a face.
    """
    smallest = smallest_edge(model)
    built = joints_of_start(model, bodies_at_rest(model), properties, smallest)
    joints, gaps = built.joints, built.contacts.gaps
    if not len(joints.blocks):
        return StartGaps(joints.blocks, gaps, gaps > 0.0)
    first = joints.starts[:-1]
    nearest, widest = np.minimum.reduceat(gaps, first), np.maximum.reduceat(gaps, first)
    wedge = (nearest <= 0.0) & (widest > TOUCHING_GAP * smallest)
    wedge[wedge] = [widest[k] <= STEEPEST * _across(joints, gaps, k) for k in np.flatnonzero(wedge)]
    order = np.flatnonzero(wedge)[np.argsort(widest[wedge], kind="stable")]
    return StartGaps(joints.blocks[order], widest[order], np.ones(len(order), bool))


def _across(joints: Joints, gaps: np.ndarray, joint: np.integer) -> float:
    """Compute the distance from where a joint is widest to where it touches [m], along the slope."""
    of = slice(joints.starts[joint], joints.starts[joint + 1])
    points, own = joints.points[of], gaps[of]
    return float(np.linalg.norm(points[own <= 0.0] - points[own.argmax()], axis=1).min())


def gap_words(model: Model, gaps: StartGaps) -> str:
    """Describe the number of gaps, and the narrowest with its blocks: "a gap of 0.002 m between 'post' and 'beam'"."""
    a, b = (model.block_ids[i] for i in gaps.blocks[0])
    between = f"{gaps.widths[0]:.3g} m between '{a}' and '{b}'"
    return f"a gap of {between}" if len(gaps.widths) == 1 else f"{len(gaps.widths)} gaps, the narrowest {between}"
