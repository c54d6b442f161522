"""Joints and forces of a rendered scene: stripes by joint state, and joint forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import across
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, ContactRecord, Frame
from dem_cli.results.post import frame_measures
from dem_cli.results.post.scene import joint_strokes
from dem_cli.results.render.solids import lifted

_HAIRLINE = 0.02  # joints open by less than this share of the largest displacement are faint
_UNSEEN = 1e-3  # or by less than this share of the size of the structure
_THIN = 0.45  # of the width: their stripes
_NECK = 0.62  # of the length of an arrow: where its head begins
_HEAD = 2.6  # radius of the head over that of the shaft
_THICKEST = 0.085  # of the longest arrow: radius of the thickest bar
_LEAST, _FINEST = 0.01, 0.06  # of the largest force: what is drawn at all; what is drawn thinner than it is
_ROD, _SLACK = 0.05, 0.3  # of the longest arrow: radius of the tie of the largest force; of that: one without force
_STOUTEST = 0.3  # radius of the thickest bar over half its length
_LONGEST_BAR = 0.85  # of the smaller side of the smaller block, to either side of the joint


class JointStripes(NamedTuple):
    """Joint stripes: flat boxes slightly proud of the stones; each contact point has its half of the joint."""

    points: np.ndarray  # corners [m], (8 n, 3)
    faces: np.ndarray  # as VTK has them
    states: np.ndarray  # index into STATES of each face, (6 n,)
    faint: np.ndarray  # a hairline, of each face, (6 n,) bool


class ForceStrokes(NamedTuple):
    """Forces as tubes along lines."""

    points: np.ndarray  # [m], (n, 3)
    radii: np.ndarray  # [m], (n,)
    lines: np.ndarray  # as VTK has them: number of points, then the points, line after line
    largest: float  # force of the thickest one [N]


_BOX = np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])


def stripes(model: Model, frame: Frame, scale: float, width: float) -> JointStripes:
    """Create the joint stripes of a frame drawn at `scale`; stripes are `width` wide [m]."""
    contacts = frame.contacts
    hairline = (
        max(_HAIRLINE * frame_measures.largest_displacement(model, frame), _UNSEEN * frame_measures.size(model)) / scale
    )
    faint = (contacts.state == STATES.index("open")) & (contacts.gap < hairline)
    widths = np.where(faint, _THIN * width, width)
    boxes, owners = _BOXES[model.dimension](model, contacts, width, widths)
    n = len(boxes)
    corners = _BOX[np.newaxis] + 8 * np.arange(n)[:, np.newaxis, np.newaxis]
    faces = np.concatenate((np.full((n, 6, 1), 4), corners), axis=2)
    states = contacts.state[owners]
    return JointStripes(boxes.reshape(-1, 3), faces.ravel(), np.repeat(states, 6), np.repeat(faint[owners], 6))


def _through(model: Model, contacts: ContactRecord, width: float, widths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Create stripes of plane joints through the thickness; corners of boxes (n, 8, 3), point of each (n,)."""
    ends = contacts.points
    centres = joint_strokes.middles(contacts)
    along = centres - ends
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    single = lengths[:, 0] < 0.25 * width  # one point, or points that are one: a short stripe
    tangents = np.stack((contacts.normals[:, 1], -contacts.normals[:, 0]), axis=1)
    along = np.where(single[:, np.newaxis], tangents, along / np.where(lengths > 0.0, lengths, 1.0))
    starts = np.where(single[:, np.newaxis], ends - width * along, ends)
    stops = np.where(single[:, np.newaxis], ends + width * along, centres)
    aside = 0.5 * widths[:, np.newaxis] * across(along)
    outline = np.stack((starts - aside, stops - aside, stops + aside, starts + aside), axis=1)
    depth = 0.5 * model.thickness[contacts.blocks].max(axis=1) + 0.5 * width
    n = len(ends)
    points = np.zeros((n, 8, 3))
    points[:, :4, :2] = points[:, 4:, :2] = outline
    points[:, :4, 2], points[:, 4:, 2] = -depth[:, np.newaxis], depth[:, np.newaxis]
    return points, np.arange(n)


def _around(model: Model, contacts: ContactRecord, width: float, widths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Create bars around the joint faces in space; corners of boxes (n, 8, 3), point of each (n,)."""
    found = joint_strokes.strokes(contacts)
    normals, along = contacts.normals[found.points], found.ends - found.starts
    outwards = np.cross(along, normals)
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), np.finfo(float).tiny)
    half = 0.5 * widths[found.points, np.newaxis]
    square = [sign * half * normals + side * half * outwards for sign, side in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.stack([end + corner for end in (found.starts, found.ends) for corner in square], axis=1), found.points


_BOXES = {2: _through, 3: _around}


def forces(model: Model, frame: Frame, look: str, reach: float) -> ForceStrokes | None:
    """Create strokes of the resultant of each joint, in the plane in front of the blocks; None without forces.

    look     "bars": along the force, as thick as it is large; where every block has at most two pressed joints the
             bars join to the thrust line. "arrows": on the lower of two blocks, as long as the force is large
    reach    length of the longest arrow [m]; bars are as thick as becomes a picture of that scale
    """
    found = frame_measures.resultants(frame.contacts)
    sizes = np.linalg.norm(found.forces, axis=1)
    if not len(sizes) or sizes.max() <= 0.0:
        return None
    kept = sizes > _LEAST * sizes.max()
    found, sizes = frame_measures.Resultants(*(column[kept] for column in vars(found).values())), sizes[kept]
    share = sizes / sizes.max()
    front = 0.5 * model.thickness[found.blocks].max(axis=1)
    if look == "arrows":
        return _arrows(found, share, front, reach, float(sizes.max()))
    radii = _THICKEST * reach * np.maximum(share, _FINEST)
    heights = front + _THICKEST * reach
    chains = frame_measures.chains(model, found)
    if chains:
        order = np.concatenate(chains)
        lines = _lines([len(chain) for chain in chains])
        return ForceStrokes(lifted(found.points[order], heights[order]), radii[order], lines, float(sizes.max()))
    lengths = _LONGEST_BAR * frame_measures.block_reach(model, found.blocks)
    radii = np.minimum(radii, _STOUTEST * np.median(lengths) * np.maximum(share, _FINEST))
    arms = (lengths / sizes)[:, np.newaxis] * found.forces
    ends = np.stack((found.points - arms, found.points + arms), axis=1).reshape(-1, found.points.shape[1])
    n = len(sizes)
    return ForceStrokes(lifted(ends, np.repeat(heights, 2)), np.repeat(radii, 2), _lines([2] * n), float(sizes.max()))


def links(model: Model, frame: Frame, reach: float) -> ForceStrokes | None:
    """Create strokes of ties and bars as thick as their force, in the plane in front of the blocks; None: no links."""
    if frame.links is None:
        return None
    sizes = np.abs(frame.links.forces)
    largest = float(sizes.max(initial=0.0))
    share = sizes / largest if largest > 0.0 else sizes
    points = np.concatenate(frame.links.lines(frame))
    radii = _ROD * reach * (_SLACK + (1.0 - _SLACK) * share)
    front = 0.5 * float(model.thickness.max()) + _ROD * reach
    return ForceStrokes(lifted(points, front), radii, _lines(np.diff(frame.links.places.starts).tolist()), largest)


def _arrows(
    found: frame_measures.Resultants, share: np.ndarray, front: np.ndarray, reach: float, largest: float
) -> ForceStrokes:
    """Create arrows with the tip at the joint, pointing downwards: the load from above."""
    downwards = np.where(found.forces[:, -1] > 0.0, -1.0, 1.0)[:, np.newaxis]
    units = downwards * found.forces / np.linalg.norm(found.forces, axis=1, keepdims=True)
    lengths = reach * share
    radius = 0.022 * reach
    kept = lengths > 1.5 * radius
    units, lengths, tips, front = units[kept], lengths[kept], found.points[kept], front[kept]
    heads = np.minimum(1.0, (1.0 - _NECK) * reach * 0.4 / lengths)  # of the length: heads are alike
    at = np.stack((np.ones_like(heads), heads + 1e-3, heads, np.zeros_like(heads)), axis=1)
    points = tips[:, np.newaxis] - (lengths[:, np.newaxis] * at)[:, :, np.newaxis] * units[:, np.newaxis]
    radii = np.tile((radius, radius, _HEAD * radius, 0.02 * radius), len(lengths))
    heights = np.repeat(front + _HEAD * radius, 4)
    corners = points.reshape(-1, points.shape[2])
    return ForceStrokes(lifted(corners, heights), radii, _lines([4] * len(lengths)), largest)


def _lines(counts: list[int]) -> np.ndarray:
    """Create polylines through consecutive points."""
    starts = np.concatenate(([0], np.cumsum(counts)))
    return np.concatenate([np.concatenate(([n], np.arange(a, a + n))) for a, n in zip(starts, counts)])
