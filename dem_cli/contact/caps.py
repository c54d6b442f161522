"""Joints in space that are not plane: a convex polyhedral cap of block b over the outline of the joint; a is flat.

The cap of thesis 7.2.3 carried to space: on the way from the centroid of the outline to each of its corners it rises as
half of the profile of a plane joint does, so that its rings are the outline, scaled about the centroid. Its height is
then a convex, growing function of the scale: the cap is convex whatever the outline, and its facets are plane.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.layout import SAMPLES, PointLayout, draw

STEEP = np.cos(np.pi / 4) - 1e-9  # a bed joint has its normal within 45° of the vertical


class JointCap(NamedTuple):
    """Contact points of one joint, ring by ring, the outline first; each ring starts at the first corner of it."""

    places: np.ndarray  # on b at the start [m], (n, 3)
    rises: np.ndarray  # above the plane of a, 0: in contact at the start [m], (n,)
    shares: np.ndarray  # of the area of the joint, (n,)


def cap_over(
    outline: np.ndarray, weights: np.ndarray, normal: np.ndarray, layout: PointLayout, key: tuple[int, ...]
) -> JointCap:
    """The cap over a joint.

    outline: corners in order, (k, 3) [m]; weights: share of the area of each in a plane joint, (k,); normal: unit, from
    a to b; key: what tells this joint from others of its kind, as `draw` takes it. Each point has the share of its
    corner: pressed on one side, or rolling over one ring, a rectangle is as stiff as its profile in the plane.
    """
    ways, rises = half_profile(layout, key, outline)
    middle, rising = centroid(outline), np.repeat(rises, len(outline))
    rings = middle + ways[:, None, None] * (outline - middle)
    return JointCap(rings.reshape(-1, 3) + rising[:, None] * normal, rising, np.tile(weights, len(ways)))


def half_profile(layout: PointLayout, key: tuple[int, ...], outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Scale of each ring (1: the outline) and its rise above the plane of a [m], from outside in, each (m,).

    The joint is as long as twice the way from its centroid to the corner that is furthest away.
    """
    length = 2.0 * float(np.linalg.norm(outline - centroid(outline), axis=1).max())
    places, rises, _ = draw(layout, key, length, mirrored=True)
    outer = slice(None, len(places) // 2 - 1, -1)
    return 2.0 * places[outer] / length - 1.0, rises[outer]


def slopes(outline: np.ndarray, ways: np.ndarray, rises: np.ndarray) -> np.ndarray:
    """Slope of each side of the cap: from each ring to the next one inside, over each side of the outline, (m − 1, k).

    It is the rotation by which the block comes to rest there from the innermost ring.
    """
    middle, along = centroid(outline), np.roll(outline, -1, axis=0) - outline
    apothems = np.linalg.norm(np.cross(along, outline - middle), axis=1) / np.linalg.norm(along, axis=1)
    return np.divide.outer(np.diff(rises) / np.diff(ways), apothems)


def steepest(layout: PointLayout, outline: np.ndarray) -> float:
    """Largest slope of a side of the cap over a joint [-]; of layouts with ranges: the largest of many drawn ones."""
    drawn = (slopes(outline, *half_profile(layout, (i,), outline)) for i in range(SAMPLES))
    return max(float(each.max(initial=0.0)) for each in drawn)


def has_cap(layout: PointLayout | None, normal: np.ndarray) -> bool:
    """Whether a joint of two faces with this unit normal has a cap: `only` of its layout says which."""
    kind = "bed" if abs(normal[2]) >= STEEP else "head"
    return layout is not None and layout.sides is not None and layout.only in ("all", kind)


def centroid(outline: np.ndarray) -> np.ndarray:
    """Centroid of the area of a plane polygon (k, 3) [m], (3,)."""
    near = outline - outline[0]
    doubled = np.cross(near[1:-1], near[2:])
    whole = doubled.sum(axis=0)
    parts = doubled @ whole / (whole @ whole)
    return outline[0] + parts @ (near[1:-1] + near[2:]) / 3.0
