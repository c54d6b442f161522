"""Joints in space that are not plane: a convex polyhedral cap of block b over the outline of the joint; a is flat.

The cap of thesis 7.2.3 carried to space: on the way from the centroid of the outline to each of its corners it rises as
half of the profile of a plane joint does, so that its rings are the outline, scaled about the centroid. Its height is
then a convex, growing function of the scale: the cap is convex whatever the outline, and its facets are plane.

Points over the area of a plane joint (contact/area_rules.py) go with block b in the same way, as a cap without height.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.area_rules import inner_points
from dem_cli.core.contact.joints import Faces, JointProperties, points_of
from dem_cli.core.contact.keys import face_names, same_rows
from dem_cli.core.contact.layout import SAMPLES, PointLayout, ProfileFault, draw
from dem_cli.core.contact.meetings import Meetings, meetings
from dem_cli.core.kernels.records import FACES
from dem_cli.core.kernels.spatial_geometry import AREA, CENTRE
from dem_cli.core.model.model import Model

STEEP = np.cos(np.pi / 4) - 1e-9  # a bed joint has its normal within 45° of the vertical


class JointCap(NamedTuple):
    """Contact points of one joint, ring by ring, the outline first; each ring starts at the first corner of it."""

    places: np.ndarray  # on b at the start [m], (n, 3)
    rises: np.ndarray  # above the plane of a, 0: in contact at the start [m], (n,)
    shares: np.ndarray  # of the area of the joint, (n,)


class Caps(NamedTuple):
    """Caps of the joints of the start, used again wherever the same two faces meet."""

    parts: np.ndarray  # the two parts of each, (n, 2)
    faces: np.ndarray  # and their faces, (n, 2)
    rises: np.ndarray  # of the outline [m], (n,)
    slopes: np.ndarray  # of the steepest side, (n,)
    corners: np.ndarray  # share of the area that corners of an outline have where points lie within a plane joint, else
    # 0, (n,)
    starts: np.ndarray  # each has the points starts[i]:starts[i + 1] within its outline, (n + 1,)
    arms: np.ndarray  # of these, from the centroid of block b as it stands at the start [m], (n_points, 3)
    areas: np.ndarray  # of the joint that belong to each [m²], (n_points,)


def made_caps(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> Caps | None:
    """Make caps of the joints of the start, and points over the area of plane ones, by the layout of their named joint.

    None: no joint may have any.
    """
    if not any(layout is not None and not layout.centred for layout in properties.layouts):
        return None
    found, named = meetings(model, faces, corners), properties.between(model, model.part_blocks[faces.parts])
    names = face_names(model)
    made, rows, inner = [], [], [np.zeros((0, 4))]
    plane, own = _plane_points(model, faces, corners, found, properties.along_sides[named])
    for i in np.flatnonzero(found.kinds == FACES):
        layout, normal = properties.layouts[named[i]], found.frames[i, :3]
        if len(plane[i]):
            made.append(i)
            rows.append((0.0, 0.0, own[i]))
            inner.append(plane[i])
        if layout is None or not has_cap(layout, normal):
            continue
        points = slice(found.starts[i], found.starts[i + 1])
        outline, area = found.places[points], found.weights[points].sum()
        key = (names[faces.faces[i, 1]], names[faces.faces[i, 0]])
        cap = cap_over(outline, found.weights[points] / area, normal, layout, key)
        steep = slopes(outline, *half_profile(layout, key, outline)).max(initial=0.0)
        arms = cap.places - _centroids(model, faces, corners)[i]
        made.append(i)
        rows.append((cap.rises[0], steep, 0.0))
        inner.append(np.column_stack([arms, area * cap.shares])[len(outline) :])
    starts = np.cumsum([len(each) for each in inner]).astype(np.int64)
    sizes, points_inside = np.array(rows).reshape(-1, 3), np.concatenate(inner)
    return Caps(
        faces.parts[made], faces.faces[made], sizes[:, 0].copy(), sizes[:, 1].copy(), sizes[:, 2].copy(), starts,
        points_inside[:, :3].copy(), points_inside[:, 3].copy(),
    )  # fmt: skip


def _centroids(model: Model, faces: Faces, corners: np.ndarray) -> np.ndarray:
    """Compute the centroids of the blocks b at the start [m], (n, 3)."""
    vertex = model.topology.face_corners[model.topology.face_starts[faces.faces[:, 1]]]
    return corners[vertex] - model.vertices[vertex]


def _plane_points(
    model: Model, faces: Faces, corners: np.ndarray, found: Meetings, sides: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Compute points within the outlines of plane joints, so many along each side (n,). Returns for each joint their
    arms on b [m] and areas [m²], (points, 4), and the share of its corners, (n,).
    """
    middles = found.measures[:, CENTRE : CENTRE + 3]
    rule = inner_points(found.places, found.starts, middles, np.where(found.kinds == FACES, sides, 0))
    of = np.repeat(np.arange(len(sides)), np.diff(rule.starts))
    arms = rule.places - _centroids(model, faces, corners)[of]
    return np.split(np.column_stack([arms, rule.shares * found.measures[of, AREA]]), rule.starts[1:-1]), rule.corners


def caps_of(caps: Caps | None, faces: Faces) -> Caps:
    """Select the caps of these pairs of faces, row by row: none except where the same faces meet.

    Two parts that meet by other faces keep the rise alone: the outline of their cap is higher than the faces drawn.
    """
    n = len(faces.parts)
    if caps is None:
        none = np.zeros(n)
        return Caps(
            faces.parts, faces.faces, none, none, none, np.zeros(n + 1, np.int64), np.zeros((0, 3)), np.zeros(0)
        )  # fmt: skip
    by_parts, by_faces = same_rows(caps.parts, faces.parts), same_rows(caps.faces, faces.faces)
    rises = np.where(by_parts >= 0, caps.rises[by_parts], 0.0) if len(caps.rises) else np.zeros(n)
    slope, own = (
        np.where(by_faces >= 0, each[by_faces], 0.0) if len(each) else np.zeros(n)
        for each in (caps.slopes, caps.corners)
    )
    here = by_faces[by_faces >= 0]
    counts = np.zeros(n, np.int64)
    counts[by_faces >= 0] = np.diff(caps.starts)[here]
    points = points_of(caps.starts, here)
    starts = np.concatenate([[0], np.cumsum(counts)])
    return Caps(faces.parts, faces.faces, rises, slope, own, starts, caps.arms[points], caps.areas[points])


def cap_over(
    outline: np.ndarray, weights: np.ndarray, normal: np.ndarray, layout: PointLayout, key: tuple[int, ...]
) -> JointCap:
    """Build the cap over a joint.

    outline: corners in order, (k, 3) [m]; weights: share of the area of each in a plane joint, (k,); normal: unit, from
    a to b; key: what tells this joint from others of its kind, as `draw` takes it. Each point has the share of its
    corner: pressed on one side, or rolling over one ring, a rectangle is as stiff as its profile in the plane.
    """
    ways, rises = half_profile(layout, key, outline)
    middle, rising = centroid(outline), np.repeat(rises, len(outline))
    rings = middle + ways[:, None, None] * (outline - middle)
    return JointCap(rings.reshape(-1, 3) + rising[:, None] * normal, rising, np.tile(weights, len(ways)))


def half_profile(layout: PointLayout, key: tuple[int, ...], outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute scale of each ring (1: the outline) and rise above the plane of a [m], from outside in, each (m,).

    The joint is as long as twice the way from its centroid to the corner that is furthest away.
    """
    length = 2.0 * float(np.linalg.norm(outline - centroid(outline), axis=1).max())
    places, rises, _ = draw(layout, key, length, mirrored=True)
    outer = slice(None, len(places) // 2 - 1, -1)
    return 2.0 * places[outer] / length - 1.0, rises[outer]


def slopes(outline: np.ndarray, ways: np.ndarray, rises: np.ndarray) -> np.ndarray:
    """Compute slopes of the sides of a cap, each from a ring to the next one inside, over a side of the outline, (m −
    1, k).

    It is the rotation by which the block comes to rest there from the innermost ring.
    """
    return np.divide.outer(np.diff(rises) / np.diff(ways), apothems(outline))


def apothems(outline: np.ndarray) -> np.ndarray:
    """Compute the distance of each side of an outline (k, 3) from its centroid [m], (k,)."""
    along = np.roll(outline, -1, axis=0) - outline
    return np.linalg.norm(np.cross(along, outline - centroid(outline)), axis=1) / np.linalg.norm(along, axis=1)


def steepest(layout: PointLayout, outline: np.ndarray) -> float:
    """Compute the largest slope of a side of the cap over a joint [-]; for ranges the largest of many drawn ones."""
    drawn = (slopes(outline, *half_profile(layout, (i,), outline)) for i in range(SAMPLES))
    return max(float(each.max(initial=0.0)) for each in drawn)


def highest(layout: PointLayout, outline: np.ndarray) -> float:
    """Compute the rise of the outline of the cap over a joint [m]; for ranges the largest of many drawn ones."""
    return max(float(half_profile(layout, (i,), outline)[1].max()) for i in range(SAMPLES))


def odd_or_uneven(layout: PointLayout) -> ProfileFault | None:
    """Check that a profile can be a cap, which is the same on both sides of its middle; returns the fault or None."""
    low, high = layout.sides or (1, 1)
    if layout.over == "face":
        return ProfileFault("over", "'face' is not allowed in 3D; must be 'joint': each joint has a cap of its own")
    if low % 2 == 0 or high % 2 == 0:
        even = low if low % 2 == 0 else high
        return ProfileFault("sides", f"{even} is not allowed in 3D; must be odd: a block does not rest on an apex")
    if len(layout.lengths) > 1 and layout.lengths != layout.lengths[::-1]:
        return ProfileFault("lengths", "not the same from both ends; in 3D a cap rises alike on all sides")
    return None


def has_cap(layout: PointLayout | None, normal: np.ndarray) -> bool:
    """Test whether a joint of two faces with this unit normal has a cap, by `only` of its layout."""
    kind = "bed" if abs(normal[2]) >= STEEP else "head"
    return layout is not None and layout.sides is not None and layout.only in ("all", kind)


def centroid(outline: np.ndarray) -> np.ndarray:
    """Compute the centroid of the area of a plane polygon (k, 3) [m], (3,)."""
    near = outline - outline[0]
    doubled = np.cross(near[1:-1], near[2:])
    whole = doubled.sum(axis=0)
    parts = product(doubled, whole) / product(whole, whole)
    return outline[0] + product(parts, near[1:-1] + near[2:]) / 3.0
