"""Section cuts: a line across a pier in the plane, a plane polygon in space; forces carried from side to side.

A block is on the side of its centroid, and a cut passes through the joints between blocks on both sides whose middle
lies across it, between its ends. The part of the structure on one side is then cut free along joints, and all that is
carried through them is in equilibrium with the loads of the blocks beyond.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry.polyhedron import newell
from dem_cli.core.geometry.rotation import cross

WITHIN = 1e-6  # of the length of a cut: nearer to its ends, a joint is beside it
FLAT = 1e-6  # of the same: corners of a polygon so far out of its plane are in it


class SectionCut(NamedTuple):
    """Straight cut of the undeformed structure."""

    middle: np.ndarray  # of the line, or centroid of the polygon [m], (d,)
    axes: np.ndarray  # unit: the normal, along the line or first side, in space the normal × that, (d, d)
    outline: np.ndarray  # its corners from the middle, along the axes behind the normal [m], (n, d − 1)

    def sides(self, places: np.ndarray) -> np.ndarray:
        """Test whether places (n, d) lie beyond the cut, where its normal points, (n,) bool."""
        return product(places - self.middle, self.axes[0]) > 0.0

    def across(self, places: np.ndarray) -> np.ndarray:
        """Test whether places (n, d) lie across the cut and not beside it, seen along its normal, (n,) bool."""
        found = product(places - self.middle, self.axes[1:].T)
        reach = float(np.ptp(self.outline, axis=0).max())
        if found.shape[1] == 1:
            return np.abs(found[:, 0]) < 0.5 * reach * (1.0 - 2.0 * WITHIN)
        inside = np.zeros(len(found), bool)
        near = np.zeros(len(found), bool)
        for start, end in zip(self.outline, np.roll(self.outline, -1, axis=0), strict=True):
            side, arms = end - start, found - start
            share = np.clip((arms * side).sum(axis=1) / (side**2).sum(), 0.0, 1.0)
            near |= np.hypot(*(arms - share[:, None] * side).T) <= WITHIN * reach
            straddles = (start[1] > found[:, 1]) != (end[1] > found[:, 1])
            inside ^= straddles & ((cross(np.broadcast_to(side, arms.shape), arms) > 0.0) == (side[1] > 0.0))
        return inside & ~near

    def passes(self, centroids: np.ndarray, blocks: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Find the joints that the cut passes through, (n,) bool.

        centroids: of all undeformed blocks [m], (n_blocks, d); blocks: of each joint, (n, 2); places: undeformed
        middles of the joints [m], (n, d).
        """
        beyond = self.sides(centroids)[blocks]
        return (beyond[:, 0] != beyond[:, 1]) & self.across(places)


class SectionForces(NamedTuple):
    """Section forces at the middle of a cut: from the part beyond it on the part before it."""

    normal_force: float  # compression positive [N]
    shear_force: float  # along the line or the first side [N]
    moment: float  # positive: it presses the end of the line, normal force × eccentricity along it [N m]
    shear_force_across: float = 0.0  # in space, along the normal × the first side [N]
    moment_across: float = 0.0  # normal force × eccentricity along that [N m]
    torsion: float = 0.0  # about the normal [N m]


def section_cut(corners: Sequence[Sequence[float]]) -> SectionCut:
    """Build the cut along a line from A to B, normal to the left, or over a polygon that turns about its normal.

    corners: [m], (2, 2) or (n, 3). Raises ValueError, with the reason, for a line without length, for corners that are
    too few, the same, or not in one plane.
    """
    points = np.array(corners, float)
    sides = points[1] - points[0]
    if points.shape[1] == 2:
        if len(points) != 2:
            raise ValueError(f"{len(points)} points are not allowed; a cut in 2D is a line: [[x, y], [x, y]]")
        if not sides.any():
            raise ValueError("both ends are the same point")
        along = sides / norm(sides)
        half = 0.5 * norm(sides)
        axes = np.array([[-along[1], along[0]], along])
        return SectionCut(points.mean(axis=0), axes, np.array([[-half], [half]]))
    if len(points) < 3:
        raise ValueError(f"{len(points)} points are not allowed; a cut in 3D is a polygon of at least three corners")
    area, size = newell(points), float(np.ptp(points, axis=0).max())
    if not norm(area) > FLAT * size**2 or not sides.any():
        raise ValueError("the polygon has no area, or its first two corners are the same")
    normal, along = area / norm(area), sides / norm(sides)
    if np.abs(product(points - points[0], normal)).max() > FLAT * size:
        raise ValueError("the corners are not in one plane")
    axes = np.stack([normal, along, np.cross(normal, along)])
    flat = product(points - points[0], axes[1:].T)
    middle = _centroid(flat)
    return SectionCut(points[0] + product(middle, axes[1:]), axes, flat - middle)


def drift_ends(corners: Sequence[Sequence[float]], height: float) -> list[np.ndarray]:
    """Return both ends of the height of a pier [m]: half of it before the middle of its cut, and half of it beyond."""
    cut = section_cut(corners)
    return [cut.middle + share * height * cut.axes[0] for share in (-0.5, 0.5)]


def section_forces(cut: SectionCut, places: np.ndarray, forces: np.ndarray) -> SectionForces:
    """Compute resultants of the forces [N], (n, d), that the part beyond exerts on the part before it at places
    [m], (n, d)."""
    arms, given = product(places - cut.middle, cut.axes.T), product(forces, cut.axes.T)
    normal, along = -given[:, 0], given[:, 1]
    moment = float((normal * arms[:, 1] + along * arms[:, 0]).sum())
    if given.shape[1] == 2:
        return SectionForces(float(normal.sum()), float(along.sum()), moment)
    across = given[:, 2]
    return SectionForces(
        float(normal.sum()), float(along.sum()), moment, float(across.sum()),
        float((normal * arms[:, 2] + across * arms[:, 0]).sum()),
        float((arms[:, 1] * across - arms[:, 2] * along).sum()),
    )  # fmt: skip


def _centroid(corners: np.ndarray) -> np.ndarray:
    """Compute the centroid of a polygon (n, 2) that turns counter-clockwise [m], (2,)."""
    after = np.roll(corners, -1, axis=0)
    twice = cross(corners, after)
    middle: np.ndarray = ((corners + after) * twice[:, None]).sum(axis=0) / (3.0 * twice.sum())
    return middle
