"""The joint between two blocks of the undeformed structure: its two ends as material points of both, 2D."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.contact.detect import find_joints
from dem_cli.contact.edges import edges_of, overlap_ends
from dem_cli.contact.start import TOUCHING_GAP
from dem_cli.model.model import Model
from dem_cli.model.places import undeformed
from dem_cli.model.scales import smallest_edge

WIDEST_JOINT = 0.05  # of the smallest edge: a wider gap is no joint


class JointEnds(NamedTuple):
    """Where a joint begins and ends, before anything moved."""

    normal: np.ndarray  # unit, from the first block to the second, (d,)
    on_first: np.ndarray  # from the centroid of the first block [m], (2, d)
    on_second: np.ndarray  # opposite places on the second, from its centroid [m], (2, d)


class StartJoints:
    """All joints of the undeformed structure, by the two blocks that share them."""

    def __init__(self, model: Model):
        self.model, self.corners = model, undeformed(model)
        edge = smallest_edge(model)
        faces = find_joints(model, self.corners, WIDEST_JOINT * edge)
        edges = edges_of(model, faces)
        low, high = overlap_ends(edges, self.corners)
        keep = high - low > TOUCHING_GAP * edge
        self.edges = edges[keep]
        self.lengths = (high - low)[keep]
        self.blocks = model.part_blocks[faces.parts[keep]]

    def neighbours(self, block: int) -> list[int]:
        """Blocks that share a joint with this one."""
        pairs = self.blocks[(self.blocks == block).any(axis=1)]
        return sorted({int(b) for b in pairs.ravel()} - {block})

    def ends(self, first: int, second: int) -> JointEnds | None:
        """Of the joint of two blocks, the longest one where they share several; None: they share none."""
        shared = np.flatnonzero((np.sort(self.blocks, axis=1) == sorted((first, second))).all(axis=1))
        if not len(shared):
            return None
        joint = shared[[self.lengths[shared].argmax()]]
        turned = self.blocks[joint[0], 0] != first
        normals, on_first, on_second = self.sides(self.edges[joint][:, [2, 3, 0, 1]] if turned else self.edges[joint])
        centroids = self.model.centroids
        return JointEnds(normals[0], on_first[0] - centroids[first], on_second[0] - centroids[second])

    def sides(self, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Normals (n, d) of pairs of edges, and where they begin and end on either side [m], (n, 2, d) each."""
        a0, a1, b0, b1 = (self.corners[edges[:, i]] for i in range(4))
        along = (a1 - a0) / np.hypot(*(a1 - a0).T)[:, np.newaxis]
        places = np.stack(overlap_ends(edges, self.corners), axis=1)[..., np.newaxis]
        on_first = a0[:, np.newaxis] + places * along[:, np.newaxis]
        past = ((on_first - b0[:, np.newaxis]) * along[:, np.newaxis]).sum(axis=2)
        share = past / ((b1 - b0) * along).sum(axis=1)[:, np.newaxis]
        on_second = b0[:, np.newaxis] + share[..., np.newaxis] * (b1 - b0)[:, np.newaxis]
        return np.stack([along[:, 1], -along[:, 0]], axis=1), on_first, on_second
