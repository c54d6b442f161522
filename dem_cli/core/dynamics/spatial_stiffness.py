"""Geometric stiffness in space: change of contact forces that turn and shift when the blocks between them move.

With F the force on b at a point and A, B the arms of the point from both centroids, the motion of b against a there is

    r = v_b − v_a + ω_b × B − ω_a × A.

The force turns with the spin Ω = S_a ω_a + S_b ω_b of normal and tangents, and the point goes along with b by R r and
with a by the rest. So virtual motions r', ω' see that much more work to the second order,

    r' · (Ω × F) + (ω_a' × F) · R r + (ω_b' × F) · (r − R r) + F · (ω_b' × (ω_b × B)) − F · (ω_a' × (ω_a × A)),

whatever the point is: a corner of b on a face of a has S_b = 0 and R = 1, one of a on a face of b S_a = 0 (but for the
tangents, that turn with a) and R = 0, a crossing of two edges what its cross product says. The symmetric part of that,
times −1, is what has to be added to the stiffness of the springs. The other part changes no frequency to first order:
for blocks at rest it is that of slip which is counted along a direction of the other block, and of a normal that turns
with both of the blocks where the point goes with one of them.

S and R are seen by turning and moving blocks a little: whatever the narrow phase makes of a point, this follows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.detect import block_shape, world_corners
from dem_cli.core.contact.geometry import motion_of
from dem_cli.core.contact.joints import JointGeometry
from dem_cli.core.geometry.rotation import turned_further, turns_of

if TYPE_CHECKING:
    from dem_cli.core.kernels.records import Bodies, Contacts, Joints
    from dem_cli.core.model.model import Model

SMALL = (
    1e-5  # rad, and shares of the radii of blocks: what is of second order is negligible, and a place that goes with
)
# one block on one side of a rim and with the other one beyond it is half way between, as in a vibration


class Attachment(NamedTuple):
    """Rotation and translation of contact points per motion of block b; block a has the rest of 1."""

    spins: np.ndarray  # of normal and tangents per spin of b, S_b, (n_points, 3, 3)
    follows: np.ndarray  # of the point per motion of b there, R, (n_points, 3, 3)


def attachment(model: Model, joints: Joints, geometry: JointGeometry, contacts: Contacts, bodies: Bodies) -> Attachment:
    """Find how contact points follow the motion of their blocks, by moving half of the blocks at a time.

    Of the blocks of a joint one is moved and the other one is not, for one digit at least of their binary numbers.
    """
    blocks, n = joints.blocks[joints.owners], len(joints.kn)
    arms = joints.points[:, None] - bodies.positions[blocks]
    found, rests = Attachment(*np.zeros((2, n, 3, 3))), np.ones(n, bool)
    moved = _Moved(model, joints, geometry, contacts, bodies)
    for digit in range(max(1, model.n_blocks - 1).bit_length()):
        chosen = (np.arange(model.n_blocks) >> digit) & 1 == 1
        here = rests & (chosen[blocks[:, 0]] != chosen[blocks[:, 1]])
        if not here.any():
            continue
        of_b = chosen[blocks[here, 1]]
        spin, shift, turn = moved.by(chosen, here)
        arm = np.where(of_b[:, None], arms[here, 1], arms[here, 0])
        spin += product(turn, cross_matrices(arm))  # turned about its centroid a block moves as well: not its spin
        own = np.where(of_b[:, None, None], 0.0, 1.0) * np.eye(3)
        sign = np.where(of_b[:, None, None], 1.0, -1.0)
        found.spins[here], found.follows[here] = own + sign * spin, own + sign * shift
        rests &= ~here
    return found


class _Moved:
    """Points of joints where blocks have moved a little."""

    def __init__(
        self, model: Model, joints: Joints, geometry: JointGeometry, contacts: Contacts, bodies: Bodies
    ) -> None:
        self.narrow, self.shape = motion_of(model.dimension), block_shape(model)
        self.joints = joints._replace(**{name: getattr(joints, name).copy() for name in ("frames", "levers", "points")})
        self.contacts = contacts._replace(gaps=contacts.gaps.copy())
        self.geometry, self.bodies = geometry, bodies
        self.size = SMALL * float(self.shape.radii.max())

    def by(self, chosen: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Measure how some points follow a motion of chosen blocks, (n, 3, 3) each. Returned are the spin of the
        frame per spin of the blocks, then motion of the place and spin of the frame per motion of them.
        """
        spin, shift, turn = (np.zeros((int(points.sum()), 3, 3)) for _ in range(3))
        for axis, unit in enumerate(np.eye(3)):
            sides = [self._placed(chosen, points, sign * SMALL * unit, 0.0) for sign in (1.0, -1.0)]
            spin[:, :, axis] = _spin_between(*sides) / (2.0 * SMALL)
            sides = [self._placed(chosen, points, 0.0 * unit, sign * self.size * unit) for sign in (1.0, -1.0)]
            turn[:, :, axis] = _spin_between(*sides) / (2.0 * self.size)
            shift[:, :, axis] = (sides[0][1] - sides[1][1]) / (2.0 * self.size)
        return spin, shift, turn

    def _placed(
        self, chosen: np.ndarray, points: np.ndarray, turn: np.ndarray, shift: np.ndarray | float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Frames (n, 3, 3) and places (n, 3) of the points when chosen blocks have turned and moved."""
        bodies = self.bodies
        positions, orientations = bodies.positions.copy(), bodies.orientations.copy()
        positions[chosen] += shift
        orientations[chosen] = turned_further(orientations[chosen], turn)
        corners = world_corners(self.shape, positions, orientations)
        there = bodies._replace(
            positions=positions, orientations=orientations, turns=turns_of(orientations), corners=corners
        )
        self.narrow.place(self.joints, self.geometry, self.contacts, there)
        return self.joints.frames[points].reshape(-1, 3, 3), self.joints.points[points]


def _spin_between(after: tuple[np.ndarray, np.ndarray], before: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Small rotation vectors from frames before to frames after [rad], (n, 3)."""
    turn = product(after[0].swapaxes(1, 2), before[0])
    return 0.5 * np.stack([turn[:, k, j] - turn[:, j, k] for j, k in ((1, 2), (2, 0), (0, 1))], axis=1)


def second_derivatives(forces: np.ndarray, arms: np.ndarray, attached: Attachment) -> np.ndarray:
    """Compute second derivatives of the work of contact forces, (n_points, 12, 12), symmetric: x, rotation vector
    of a, then of b.

    forces: on b [N], (n_points, 3); arms: from the centroids of a and b [m], (n_points, 2, 3).
    """
    spins, follows = attached
    n, unit = len(forces), np.eye(3)
    motion, found = np.zeros((n, 3, 12)), np.zeros((n, 12, 12))
    motion[:, :, :3], motion[:, :, 6:9] = -unit, unit
    turned = np.zeros((n, 3, 12))  # half of what forces, and moments by the way of the point, change by
    force = cross_matrices(forces)
    for side, spin, way in ((0, unit - spins, follows), (1, spins, unit - follows)):
        sign, arm, rotations = 2.0 * side - 1.0, arms[:, side], slice(6 * side + 3, 6 * side + 6)
        motion[:, :, rotations] = -sign * cross_matrices(arm)
        turned[:, :, rotations] = -0.5 * (product(force, spin) + product(way.swapaxes(1, 2), force))
        both = np.einsum("pi,pj->pij", forces, arm)
        found[:, rotations, rotations] = sign * (0.5 * (both + both.swapaxes(1, 2)) - _scaled_unit(both))
    mixed = product(motion.swapaxes(1, 2), turned)
    return found + mixed + mixed.swapaxes(1, 2)


def cross_matrices(vectors: np.ndarray) -> np.ndarray:
    """Build the matrices of v ×, (n, 3, 3)."""
    found = np.zeros((len(vectors), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[:, k, j], found[:, j, k] = vectors[:, i], -vectors[:, i]
    return found


def _scaled_unit(matrices: np.ndarray) -> np.ndarray:
    """Unit matrices times the traces of others, (n, 3, 3)."""
    return np.trace(matrices, axis1=1, axis2=2)[:, None, None] * np.eye(3)
