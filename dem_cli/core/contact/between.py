"""Joint between two blocks of the undeformed structure: its outline as material points of both."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.detect import find_joints
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.joints import DrawnFaces, Faces
from dem_cli.core.contact.start import TOUCHING_GAP
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.core.model.scales import smallest_edge

WIDEST_JOINT = 0.05  # of the smallest edge: a wider gap is no joint


class JointEnds(NamedTuple):
    """Outline of a joint before anything moved: in the plane its two ends, in space its corners."""

    normal: np.ndarray  # unit, from the first block to the second, (d,)
    on_first: np.ndarray  # from the centroid of the first block [m], (n, d)
    on_second: np.ndarray  # opposite places on the second, from its centroid [m], (n, d)
    shares: np.ndarray  # of the joint that belong to each place, (n,)

    def middles(self) -> tuple[np.ndarray, np.ndarray]:
        """Compute the middle of the joint on both blocks, from their centroids [m], (d,) each."""
        return product(self.shares, self.on_first), product(self.shares, self.on_second)


class StartJoints:
    """All joints of the undeformed structure, by the two blocks that share them."""

    def __init__(self, model: Model):
        self.model, self._corners, edge = model, undeformed(model), smallest_edge(model)
        self._near, self._least = find_joints(model, self._corners, WIDEST_JOINT * edge), TOUCHING_GAP * edge
        self.faces = self._drawn(self._near)

    def _drawn(self, faces: Faces) -> DrawnFaces:
        return geometry_of(self.model.dimension).drawn(self.model, faces, self._corners, self._least)

    def neighbours(self, block: int) -> list[int]:
        """List the blocks that share a joint with this one."""
        pairs = self.faces.blocks[(self.faces.blocks == block).any(axis=1)]
        return sorted({int(b) for b in pairs.ravel()} - {block})

    def ends(self, first: int, second: int) -> JointEnds | None:
        """Find the outline of the joint of two blocks, the longest where they share several; None where they share
        none.
        """
        blocks = self.model.part_blocks[self._near.parts]
        shared = (np.sort(blocks, axis=1) == sorted((first, second))).all(axis=1)
        turned, near = blocks[shared, 0] != first, self._near.where(shared)
        order = np.where(turned[:, np.newaxis], [1, 0], [0, 1])  # it turns with the first block, whichever that is
        parts, pairs = (np.take_along_axis(field, order, axis=1) for field in (near.parts, near.faces))
        found = self._drawn(Faces(parts, pairs, near.separation))
        if not len(found.blocks):
            return None
        joint, centroids = int(found.lengths.argmax()), self.model.centroids
        here = slice(found.starts[joint], found.starts[joint + 1])
        on_first, on_second = found.on_first[here] - centroids[first], found.on_second[here] - centroids[second]
        return JointEnds(found.normals[joint], on_first, on_second, found.shares[here])
