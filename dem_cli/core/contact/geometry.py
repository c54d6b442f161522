"""Geometry of contact by dimension: the one place that knows which narrow phase belongs to which.

A narrow phase finds the faces that meet, makes contact points between them and places these where the blocks are.
Everything else in the package asks for it by `geometry_of` and does not know how many dimensions there are.
"""

from __future__ import annotations

from typing import Any, Protocol, TypeVar

import numpy as np

from dem_cli.core.contact import planar, spatial, spatial_motion
from dem_cli.core.contact.joints import DrawnFaces, Faces, JointArrays, JointGeometry, JointProperties, PressedLaw
from dem_cli.core.contact.layout import PointLayout, ProfileFault
from dem_cli.core.kernels.records import BlockShapes, Bodies, Contacts, Joints, MovingJoints
from dem_cli.core.model.model import Model
from dem_cli.errors import UsageError

Geometry = TypeVar("Geometry", bound=JointGeometry)
Returning = TypeVar("Returning")  # what of the joints of the start comes back; None: nothing


class NarrowPhase(Protocol[Geometry, Returning]):
    """The contract of a module like contact/planar.py, for its own record of the geometry of joints."""

    def find(self, model: Model, corners: np.ndarray, reach: float) -> Faces:
        """All pairs of faces of different blocks that are closer than `reach` [m]."""

    def points(
        self, model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: Returning | None
    ) -> tuple[MovingJoints, Geometry]:
        """Joints between faces with their stiffness, and their geometry; not yet placed."""

    def place(self, joints: Joints, geometry: Geometry, contacts: Contacts, bodies: Bodies) -> None:
        """Gaps, frames, levers and points where the blocks are now."""

    def corners_of(self, shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
        """Corners of all parts in place [m], (n_vertices, d)."""

    def left_out(self, model: Model, corners: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Blocks that touch beside their joints, within `reach` [m], (n, 2), and how much of an area [m²], (n,)."""

    def touching(self, model: Model, faces: Faces, corners: np.ndarray, reach: float | np.ndarray) -> np.ndarray:
        """Whether faces near each other, once they touch, carry force between blocks that do not move, (n,) bool.

        reach: they do not where they share less than that [m], one for all or (n,).
        """

    def facing(self, model: Model, faces: Faces, corners: np.ndarray, sine: float, least: np.ndarray) -> np.ndarray:
        """Whether faces look at each other under an angle of at most this sine, over more than `least` [m], (n,)."""

    def open_gaps(self, model: Model, faces: Faces, corners: np.ndarray, steepest: float, bare: float) -> np.ndarray:
        """Largest gap of each pair of faces that look at each other [m], (n,); 0 where they do not, or overlap.

        steepest: slope of one against the other; bare: share of the smaller one that they have to face each other over.
        """

    def drawn(self, model: Model, faces: Faces, corners: np.ndarray, least: float) -> DrawnFaces:
        """Outlines of the joints of the undeformed structure that are wider than `least` [m]."""

    def bonds(self, model: Model, geometry: Geometry) -> np.ndarray:
        """Joints of the start that have an area which a bond can hold, (n_joints,) bool."""

    def end_to_end(self, model: Model, geometry: Geometry) -> np.ndarray:
        """Joints without a length, of corners that meet where blocks were drawn, (n_joints,) bool."""

    def chains_of(
        self, model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties
    ) -> Returning | None:
        """What of the joints of the start comes back wherever the same faces meet again; None: nothing."""


class MovingNarrowPhase(NarrowPhase[Geometry, Returning], Protocol[Geometry, Returning]):
    """What it has to know beside that where blocks move: how new contact points go on from old ones."""

    def take_over(self, old: JointArrays, new: JointArrays, match: np.ndarray, known: np.ndarray) -> None:
        """What new joints have from the old ones with the same faces; match: their numbers, −1: none.

        known: points that were there before, (n_points,) bool.
        """

    def carry(self, old: JointArrays, new: JointArrays, target: np.ndarray, source: np.ndarray) -> None:
        """Stiffness and forces of new points (n,) from the old ones (n,) that they go on from."""

    def book(self, old: JointArrays, new: JointArrays, known: np.ndarray, pressed: PressedLaw) -> None:
        """Books the elastic energy that came or went with other points (Contacts.exchanged); known: those that were
        there before, (n_points,) bool; pressed: what overlaps of the others hold (laws/law.py)."""

    def profile_fault(
        self, model: Model, faces: Faces, corners: np.ndarray, layout: PointLayout, among: np.ndarray
    ) -> ProfileFault | None:
        """Why these joints (n,) bool of the start cannot have a profile; None: they can."""

    def microrotations(self, joints: Joints, geometry: Geometry) -> np.ndarray:
        """Largest rotation of each joint before it rests on another side of its profile [rad], (n_joints,)."""

    def sink(self, geometry: Geometry, joint: int, depth: float) -> None:
        """A joint that takes over from another one starts from its penetration [m]."""


AnyNarrowPhase = NarrowPhase[Any, Any]  # the dimension is known when a case is
AnyMovingNarrowPhase = MovingNarrowPhase[Any, Any]
GEOMETRY: dict[int, AnyNarrowPhase] = {2: planar, 3: spatial}  # of the start
MOTION: dict[int, AnyMovingNarrowPhase] = {2: planar, 3: spatial_motion}


def geometry_of(dimension: int) -> AnyNarrowPhase:
    """The narrow phase for blocks in so many dimensions. Raises UsageError where there is none."""
    if dimension not in GEOMETRY:
        known = " or ".join(map(str, sorted(GEOMETRY)))
        raise UsageError(f"blocks in {dimension} dimensions cannot touch: contact is known in {known} dimensions")
    return GEOMETRY[dimension]


def motion_of(dimension: int) -> AnyMovingNarrowPhase:
    """The narrow phase for blocks that move; joints of the start that stay there are those of `geometry_of`."""
    return MOTION[dimension]
