"""Chains of contact points along joints with a profile or more than two points; 2D.

They are made once, for the joints of the start, and come back wherever the same two faces meet again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.contact.edges import edges_of, lengths_of, overlap_ends
from dem_cli.core.contact.joints import Faces, JointProperties, points_of
from dem_cli.core.contact.keys import face_names, same_rows
from dem_cli.core.contact.layout import PointLayout, draw
from dem_cli.core.geometry import profile
from dem_cli.core.model.model import Model

STEEP = np.cos(np.pi / 4) - 1e-9  # a head joint has its normal within 45° of the horizontal
END_TO_END = 1e-3  # of the edge of b: a shorter overlap at the start is no joint


class Chains(NamedTuple):
    """Contact points of the joints of the start, used again wherever the same two faces meet."""

    faces: np.ndarray  # as PlanarGeometry.faces, (n_joints, 2)
    starts: np.ndarray  # as Joints.starts, (n_joints + 1,)
    profile: np.ndarray  # as PlanarGeometry.profile, (n_points, 2)
    shares: np.ndarray  # of the area of the joint that belong to each point, (n_points,)


def made_chains(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> Chains:
    """Make contact points of the joints of the start, by the layout of their named joint."""
    n, edges = len(faces.parts), edges_of(model, faces)
    named = properties.between(model, model.part_blocks[faces.parts])
    low, high = overlap_ends(edges, corners)
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = (a1 - a0) / np.sqrt(((a1 - a0) ** 2).sum(axis=1))[:, None]
    from_b1 = ((b1 - a0) * along).sum(axis=1)  # where the edge of b starts, along that of a
    whole = np.sqrt(((b1 - b0) ** 2).sum(axis=1))
    rows, shares = [np.zeros((0, 2))], [np.zeros(0)]
    faces_named = face_names(model)
    for i in range(n):
        layout = properties.layouts[named[i]]
        row, share = np.array([[0.0, 0.0], [whole[i], 0.0]]), np.full(2, 0.5)
        if layout is not None and _has(layout, high[i] - low[i], whole[i], along[i]):
            key = (faces_named[faces.faces[i, 1]], faces_named[faces.faces[i, 0]])
            row, share = _chain(layout, key, low[i] - from_b1[i], high[i] - from_b1[i], whole[i])
        rows.append(row)
        shares.append(share)
    starts = np.cumsum([len(row) for row in rows]).astype(np.int64)
    return Chains(faces.faces, starts, np.ascontiguousarray(np.concatenate(rows)), np.concatenate(shares))


def come_back(
    chains: Chains, faces: Faces, edges: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Select first point of each joint, profile and shares of all points: joints of the start keep theirs, others are
    plane.
    """
    known = same_rows(chains.faces, faces.faces)
    stay = np.flatnonzero(known >= 0)
    counts = np.full(len(known), 2)
    counts[stay] = np.diff(chains.starts)[known[stay]]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    profile, shares = np.zeros((starts[-1], 2)), np.full(starts[-1], 0.5)
    profile[starts[1:] - 1, 0] = lengths_of(edges, corners)[:, 1]
    here, there = points_of(starts, stay), points_of(chains.starts, known[stay])
    profile[here] = chains.profile[there]
    shares[here] = chains.shares[there]
    return starts, profile, shares


def _chain(
    layout: PointLayout, key: tuple[int, int], low: float, high: float, whole: float
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the profile (n, 2) of one joint, as PlanarGeometry.profile, and the share of its area of each point,
    (n,).

    key: of the edges of b and of a; low, high: its ends along the edge of b, from near a0 on; whole: its length.
    """
    # Polygons are listed from left to right, or from the top down: that is from a1 to a0.
    if layout.sides is None or layout.over == "joint":
        places, rises, share = draw(layout, key, high - low)
        return np.column_stack([high - places, rises])[::-1], share[::-1]
    places, rises, share = draw(layout, key[:1], whole)
    places, rises = profile.cut((whole - places)[::-1], rises[::-1], low, high)
    return np.column_stack([places, rises]), np.full(len(places), share[0])


def _has(layout: PointLayout, overlap: float, whole: float, along: np.ndarray) -> bool:
    """Test whether a joint with this overlap, along a unit vector, has the layout; joints end to end have none."""
    kind = "bed" if abs(along[0]) >= STEEP else "head"
    return overlap > END_TO_END * whole and layout.only in ("all", kind)
