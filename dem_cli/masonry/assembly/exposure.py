"""Find the exposed faces of blocks: parts that no other block covers at the start, and those open to the sky."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.detect import find_joints
from dem_cli.core.contact.gaps import STEEPEST, joined, joint_reach
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.joints import Faces
from dem_cli.core.geometry import surface_pieces
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed

SLIVER = 1e-9  # of its face: a smaller piece is round-off
BESIDE = 1e-6  # of a face: so far from an upright one its open side is looked at


class SurfacePiece(NamedTuple):
    """Exposed piece of a block face, covered by no other block."""

    block: int
    part: int
    normal: np.ndarray  # unit, outwards, (d,)
    corners: np.ndarray  # two ends in the plane, in space around it [m], (n, d)
    least: float  # measure of what is round-off [m^(d-1)]


class Surfaces:
    """Faces of a model in place with the half-spaces of its parts and the faces that cover each other."""

    def __init__(self, model: Model):
        self.model, self.corners, self.topology = model, undeformed(model), model.topology
        self.normals = shapes_of(self.corners).normals(self.corners, self.topology)
        first = self.topology.face_corners[self.topology.face_starts[:-1]]
        self.offsets = (self.corners[first] * self.normals).sum(axis=1)
        starts = model.part_starts[:-1]
        self.low = np.minimum.reduceat(self.corners, starts, axis=0)
        self.high = np.maximum.reduceat(self.corners, starts, axis=0)
        self.sizes = shapes_of(self.corners).face_sizes(self.corners, self.topology)
        self.middles = self._middles()
        self.covers, self.covered = self._covers()
        self._pieces: dict[int, list[SurfacePiece]] = {}

    def exposed(self, blocks: np.ndarray, faces: np.ndarray) -> list[SurfacePiece]:
        """Return the exposed pieces of the selected faces (n_faces,) bool of some blocks (n,)."""
        parts = self.topology.face_parts
        of_blocks = np.isin(self.model.part_blocks[parts], blocks)
        chosen = np.flatnonzero(of_blocks & faces & ~self.model.inner_faces)
        bare = chosen[self.covered[chosen] < (1.0 - SLIVER) * self.sizes[chosen]]
        for face in bare.tolist():
            if face not in self._pieces:
                self._pieces[face] = list(self._free(face))
        return [piece for face in bare.tolist() for piece in self._pieces[face]]

    def near(self, normals: np.ndarray, offsets: np.ndarray) -> np.ndarray:
        """Select the faces that may reach into all of some half-spaces, by their corners, (n_faces,) bool."""
        found, first = np.ones(self.topology.n_faces, bool), self.topology.face_starts[:-1]
        for normal, offset in zip(normals, offsets, strict=True):
            found &= np.minimum.reduceat(product(self.corners, normal)[self.topology.face_corners], first) <= offset
        return found

    def open_above(self, pieces: Sequence[SurfacePiece], ceiling: float, roofs: np.ndarray) -> list[SurfacePiece]:
        """Keep the parts of exposed pieces above which no block of `roofs` (n,) begins below a ceiling [m]."""
        open_, roofing = list[SurfacePiece](), np.isin(self.model.part_blocks, roofs)
        for piece in pieces:
            upright = abs(piece.normal[-1]) <= SLIVER
            size = np.linalg.norm(piece.corners - piece.corners[0], axis=1).max()  # however it is turned in plan
            step = BESIDE * size * piece.normal if upright else 0.0
            left = [piece.corners + step]
            for part in self._above(piece, left[0], ceiling, roofing):
                left = [rest for one in left for rest in surface_pieces.outside(one, *self._shadow(part))]
            open_ += _pieces(piece, [one - step for one in left])
        return open_

    def _middles(self) -> np.ndarray:
        """Mean corner of each face [m], (n_faces, d)."""
        starts = self.topology.face_starts
        return np.add.reduceat(self.corners[self.topology.face_corners], starts[:-1]) / np.diff(starts)[:, np.newaxis]

    def _free(self, face: int) -> Iterator[SurfacePiece]:
        """Yield the exposed pieces of one face."""
        part, corners = int(self.topology.face_parts[face]), self._around(face)
        least = SLIVER * float(self.sizes[face])
        whole = SurfacePiece(int(self.model.part_blocks[part]), part, self.normals[face], corners, least)
        left = [corners]
        for other in self.covers.get(face, ()):
            sides = self._sides(other)
            left = [rest for one in left for rest in surface_pieces.outside(one, *sides)]
        yield from _pieces(whole, left)

    def _around(self, face: int) -> np.ndarray:
        """Return the corners of a face [m], (n, d)."""
        starts = self.topology.face_starts
        return self.corners[self.topology.face_corners[starts[face] : starts[face + 1]]]

    def _sides(self, face: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the half-spaces through the sides of a face, square to it; in the plane through its ends."""
        around, normal = self._around(face), self.normals[face]
        if len(normal) == 2:
            along = (around[1] - around[0]) / np.hypot(*(around[1] - around[0]))
            outwards = np.array([-along, along])
        else:
            outwards = np.cross(np.roll(around, -1, axis=0) - around, normal)
            outwards /= np.linalg.norm(outwards, axis=1)[:, np.newaxis]
        return outwards, (outwards * around).sum(axis=1)

    def _shadow(self, part: int) -> tuple[np.ndarray, np.ndarray]:
        faces = slice(self.topology.part_faces[part], self.topology.part_faces[part + 1])
        return surface_pieces.shadow(self.normals[faces], self.offsets[faces])

    def _above(self, piece: SurfacePiece, corners: np.ndarray, ceiling: float, roofing: np.ndarray) -> list[int]:
        """Find the parts that may lie above a piece with these corners and begin below the ceiling."""
        low, high = corners.min(axis=0), corners.max(axis=0)
        small = SLIVER * (high - low).max()
        over = (self.low[:, :-1] < high[:-1] - small).all(axis=1) & (self.high[:, :-1] > low[:-1] + small).all(axis=1)
        if (high - low)[:-1].max() <= small:  # seen from above a point: an upright segment
            over = (self.low[:, 0] <= low[0]) & (self.high[:, 0] >= low[0])
        elif len(low) > 2 and abs(piece.normal[-1]) <= SLIVER:  # seen from above a segment
            over = ((self.low <= high) & (self.high >= low))[:, :-1].all(axis=1)
        over &= (self.high[:, -1] > low[-1] + small) & (self.low[:, -1] < ceiling - small) & roofing
        over[piece.part] = False
        return np.flatnonzero(over).tolist()

    def _covers(self) -> tuple[dict[int, list[int]], np.ndarray]:
        """Find the faces that cover each face, and the area that they cover together [m^(d-1)]."""
        alone = self.model.parts_alone()._replace(thickness=np.ones(self.model.n_parts))
        found = self._face_to_face(find_joints(alone, self.corners, joint_reach(self.model)))
        outlines = geometry_of(self.model.dimension).drawn(alone, found, self.corners, -np.inf)
        covers: dict[int, list[int]] = {}
        covered = np.zeros(self.topology.n_faces)
        for k in np.flatnonzero(outlines.lengths > 0.0).tolist():
            common = surface_pieces.measure(outlines.on_first[outlines.starts[k] : outlines.starts[k + 1]])
            a, b = found.faces[k].tolist()
            if common > SLIVER * min(self.sizes[a], self.sizes[b]):
                covers.setdefault(a, []).append(b)
                covers.setdefault(b, []).append(a)
                covered[[a, b]] += common
        return covers, covered

    def _face_to_face(self, near: Faces) -> Faces:
        """Pair the faces of touching parts that lie on each other; several where a side has a corner on it."""
        scale = self.model.parts.sizes[near.parts].min(axis=1)
        touching = joined(near.separation, scale)
        parts, scale, gaps = near.parts[touching], scale[touching], near.separation[touching]
        first, counts = self.topology.part_faces[:-1], np.diff(self.topology.part_faces)
        n = counts[parts]
        pair = np.repeat(np.arange(len(parts)), n.prod(axis=1))
        number = np.arange(len(pair)) - np.repeat(np.cumsum(n.prod(axis=1)) - n.prod(axis=1), n.prod(axis=1))
        a = first[parts[pair, 0]] + number // n[pair, 1]
        b = first[parts[pair, 1]] + number % n[pair, 1]
        opposite = (self.normals[a] * self.normals[b]).sum(axis=1) < -np.sqrt(1.0 - STEEPEST**2)
        pair, a, b = pair[opposite], a[opposite], b[opposite]
        apart = (self.middles[b] * self.normals[a]).sum(axis=1) - self.offsets[a]
        level = np.abs(apart) <= 2.0 * STEEPEST * scale[pair]
        pair = pair[level]
        return Faces(parts[pair], np.column_stack([a[level], b[level]]), gaps[pair], near.reach)


def _pieces(whole: SurfacePiece, rest: Sequence[np.ndarray]) -> list[SurfacePiece]:
    """Return the remaining pieces of a face after cuts, round-off left out."""
    return [whole._replace(corners=one) for one in rest if surface_pieces.measure(one) > whole.least]
