"""Corner meetings: parts that touch at the start with a corner or an edge each, and how far these have moved since.

Four stones whose corners meet in one place touch aslant. Such a pair carries nothing, to first order: either of them
can go past the other without another gap that closes. Geometry of the start has no joint there (contact/start.py), and
where geometry moves there is none either until one corner has passed the other (engine/tracking.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.geometry import AnyNarrowPhase
from dem_cli.contact.joints import Faces
from dem_cli.geometry.parts import shapes_of
from dem_cli.geometry.rotation import turning
from dem_cli.kernels.records import Bodies
from dem_cli.model.model import Model


class CornerMeetings(NamedTuple):
    """Pairs of parts that touch at corners or edges alone; a pair has the places starts[j]:starts[j + 1]."""

    parts: np.ndarray  # the two parts, (n, 2) int64
    blocks: np.ndarray  # whose they are, (n, 2) int64
    sizes: np.ndarray  # of the smaller part [m], (n,)
    starts: np.ndarray  # (n + 1,) int64
    first_arms: np.ndarray  # places from the centroid of the first block, unturned [m], (n_places, d)
    second_arms: np.ndarray  # the same places from that of the second one [m], (n_places, d)

    def shifts(self, bodies: Bodies) -> np.ndarray:
        """How far the two parts have moved against each other where they met [m], the largest of each pair, (n,)."""
        if not len(self.parts):
            return np.zeros(0)
        owners = np.repeat(np.arange(len(self.parts)), np.diff(self.starts))
        first, second = self.blocks[owners].T
        now = [
            bodies.positions[of] + turning(bodies.orientations[of])(arms)
            for of, arms in ((first, self.first_arms), (second, self.second_arms))
        ]
        return np.maximum.reduceat(np.linalg.norm(now[1] - now[0], axis=1), self.starts[:-1])


def corner_meetings(model: Model, narrow: AnyNarrowPhase, faces: Faces, bodies: Bodies, reach: float) -> CornerMeetings:
    """Of pairs of faces at the start: parts that touch within `reach` [m] and have no joint in geometry of the start.

    narrow: of the geometry of the start.
    """
    n = model.n_parts
    near = faces.where(np.abs(faces.separation) <= reach)
    joined = near.parts[narrow.touching(model, near, bodies.corners, reach)]
    pairs = np.setdiff1d(near.parts[:, 0] * n + near.parts[:, 1], joined[:, 0] * n + joined[:, 1])
    parts = np.column_stack([pairs // n, pairs % n])
    places, owners = _shared_corners(model, parts, bodies.corners, reach)
    counts = np.bincount(owners, minlength=len(parts))
    kept = counts > 0
    blocks = model.part_blocks[parts]
    first, second = blocks[owners].T
    return CornerMeetings(
        parts[kept], blocks[kept], model.parts.sizes[parts[kept]].min(axis=1, initial=np.inf),
        np.concatenate([[0], np.cumsum(counts[kept])]).astype(np.int64),
        places - bodies.positions[first], places - bodies.positions[second],
    )  # fmt: skip


def _shared_corners(
    model: Model, parts: np.ndarray, corners: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Corners of either part that lie on the other one, (n_places, d), and the pair of each, in order, (n_places,)."""
    topology = model.topology
    normals = shapes_of(corners).normals(corners, topology)
    heights = (normals * corners[topology.ends[:, 0]]).sum(axis=1)
    places, owners = [], []
    for pair, (a, b) in enumerate(parts):
        for own, other in ((a, b), (b, a)):
            of_part = corners[model.part_starts[own] : model.part_starts[own + 1]]
            sides = slice(topology.part_faces[other], topology.part_faces[other + 1])
            outside = (of_part[:, np.newaxis] * normals[sides]).sum(axis=2) - heights[sides]
            found = of_part[outside.max(axis=1) <= reach]
            places.append(found)
            owners.append(np.full(len(found), pair))
    if not places:
        return np.zeros((0, model.dimension)), np.zeros(0, np.int64)
    return np.concatenate(places), np.concatenate(owners)
