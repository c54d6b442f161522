"""Strokes that show joints: in the plane along each half of a joint, in space around the shared face.

A stroke belongs to a contact point, whose state colours it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.polygon import following
from dem_cli.core.geometry.rotation import tangents_of
from dem_cli.core.records.frames import STATES, ContactRecord

_INNER = 1e-3  # of the reach of its joint: a point closer to the middle is no corner


class JointStrokes(NamedTuple):
    """Joint strokes: straight pieces of joints."""

    starts: np.ndarray  # [m], (n, d)
    ends: np.ndarray  # [m], (n, d)
    points: np.ndarray  # contact point that each belongs to, (n,)


def strokes(contacts: ContactRecord) -> JointStrokes:
    """Return the strokes of all joints with an extent; single points have none."""
    return _STROKES[contacts.points.shape[1]](contacts)


def visible_strokes(contacts: ContactRecord) -> JointStrokes:
    """Return the strokes without closed joints in space, where the edges of the stones show them."""
    found = strokes(contacts)
    if contacts.points.shape[1] == 2:
        return found
    kept = contacts.state[found.points] != STATES.index("sticking")
    return JointStrokes(*(values[kept] for values in found))


def middles(contacts: ContactRecord) -> np.ndarray:
    """Return the middle of all points of its joint, for each point [m], (n, d)."""
    _, owner, counts = np.unique(contacts.joint, return_inverse=True, return_counts=True)
    sums = [np.bincount(owner, column, len(counts)) for column in contacts.points.T]
    return (np.stack(sums, axis=1) / counts[:, np.newaxis])[owner] if len(counts) else contacts.points


def _halves(contacts: ContactRecord) -> JointStrokes:
    """Create strokes from each point to the middle of its joint."""
    return JointStrokes(contacts.points, middles(contacts), np.arange(len(contacts.joint)))


def _outlines(contacts: ContactRecord) -> JointStrokes:
    """Create strokes around each joint: half of the way to either neighbour belongs to a corner."""
    corners, starts = joint_rings(contacts)
    if not len(corners):
        return JointStrokes(contacts.points[:0], contacts.points[:0], corners)
    places, after = contacts.points[corners], following(starts)
    halfway = 0.5 * (places + places[after])
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    return JointStrokes(
        np.concatenate([halfway[before], places]), np.concatenate([places, halfway]), np.concatenate([corners, corners])
    )


def joint_rings(contacts: ContactRecord) -> tuple[np.ndarray, np.ndarray]:
    """Order contact points around each joint in space, counter-clockwise seen from block b; with their starts.

    Points inside of a joint are left out, and joints of a single point.
    """
    first, second = tangents_of(contacts.normals, contacts.tangents)
    _, leaders, owner = np.unique(contacts.joint, return_index=True, return_inverse=True)
    arms = contacts.points - middles(contacts)
    along, aside = (np.einsum("nk,nk->n", arms, vector[leaders][owner]) for vector in (first, second))
    distances, reach = np.hypot(along, aside), np.zeros(len(leaders))
    np.maximum.at(reach, owner, distances)
    kept = np.flatnonzero(distances > _INNER * reach[owner])
    order = kept[np.lexsort((np.arctan2(aside, along)[kept], owner[kept]))]
    counts = np.bincount(owner[kept], minlength=len(leaders))
    return order, np.concatenate([[0], np.cumsum(counts[counts > 0])]).astype(np.int64)


_STROKES = {2: _halves, 3: _outlines}
