"""Contact geometry by dimension: selection of the narrow phase for 2D or 3D.

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
    """Interface of a narrow phase such as contact/planar.py, for its own record of the geometry of joints."""

    def find(self, model: Model, corners: np.ndarray, reach: float) -> Faces:
        """Find all pairs of faces of different blocks that are closer than `reach` [m]."""

    def points(
        self, model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: Returning | None
    ) -> tuple[MovingJoints, Geometry]:
        """Make joints between faces with their stiffness, and their geometry; not yet placed."""

    def place(self, joints: Joints, geometry: Geometry, contacts: Contacts, bodies: Bodies) -> None:
        """Update gaps, frames, levers and points to where the blocks are now."""

    def corners_of(self, shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
        """Compute corners of all parts in world coordinates [m], (n_vertices, d)."""

    def left_out(self, model: Model, corners: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Find blocks that touch beside their joints, within `reach` [m], (n, 2), and the areas of that [m²], (n,)."""

    def touching(self, model: Model, faces: Faces, corners: np.ndarray, reach: float | np.ndarray) -> np.ndarray:
        """Test whether faces near each other, once they touch, carry force between blocks that do not move, (n,) bool.

        reach: they do not where they share less than that [m], one for all or (n,).
        """

    def facing(self, model: Model, faces: Faces, corners: np.ndarray, sine: float, least: np.ndarray) -> np.ndarray:
        """Test whether faces look at each other within an angle of this sine, over more than `least` [m], (n,)."""

    def open_gaps(self, model: Model, faces: Faces, corners: np.ndarray, steepest: float, bare: float) -> np.ndarray:
        """Compute the largest gap of each pair of faces that look at each other [m], (n,); 0: they do not, or overlap.

        steepest: slope of one against the other; bare: share of the smaller one that they have to face each other over.
        """

    def drawn(self, model: Model, faces: Faces, corners: np.ndarray, least: float) -> DrawnFaces:
        """Compute outlines of the joints of the undeformed structure that are wider than `least` [m]."""

    def bonds(self, model: Model, geometry: Geometry) -> np.ndarray:
        """Test which joints of the start have an area that a bond can hold, (n_joints,) bool."""

    def end_to_end(self, model: Model, geometry: Geometry) -> np.ndarray:
        """Test which joints have no length: corners that meet where blocks were drawn, (n_joints,) bool."""

    def chains_of(
        self, model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties
    ) -> Returning | None:
        """Collect contact points of the start that come back wherever the same faces meet again; else None."""


class MovingNarrowPhase(NarrowPhase[Geometry, Returning], Protocol[Geometry, Returning]):
    """Interface of a narrow phase for blocks that move: how new contact points continue from old ones."""

    def take_over(self, old: JointArrays, new: JointArrays, match: np.ndarray, known: np.ndarray) -> None:
        """Copy the state of old joints to new ones with the same faces; match: numbers of the old joints, −1: none.

        known: points that were there before, (n_points,) bool.
        """

    def carry(self, old: JointArrays, new: JointArrays, target: np.ndarray, source: np.ndarray) -> None:
        """Copy stiffness and forces to new points (n,) from the old ones (n,) that they continue."""

    def book(self, old: JointArrays, new: JointArrays, known: np.ndarray, pressed: PressedLaw) -> None:
        """Add the elastic energy exchanged by new and lost points to the energy balance (Contacts.exchanged). known:
        points that were there before, (n_points,) bool; pressed: normal forces of overlaps of the others
        (laws/law.py).
        """

    def profile_fault(
        self, model: Model, faces: Faces, corners: np.ndarray, layout: PointLayout, among: np.ndarray
    ) -> ProfileFault | None:
        """Check that these joints (n,) bool of the start can have a profile; returns the fault or None."""

    def microrotations(self, joints: Joints, geometry: Geometry) -> np.ndarray:
        """Compute the largest rotation of each joint up to another side of its profile [rad], (n_joints,)."""

    def sink(self, geometry: Geometry, joint: int, depth: float) -> None:
        """Set the initial penetration of a joint that takes over from another one [m]."""


AnyNarrowPhase = NarrowPhase[Any, Any]  # the dimension is known when a model is
AnyMovingNarrowPhase = MovingNarrowPhase[Any, Any]
GEOMETRY: dict[int, AnyNarrowPhase] = {2: planar, 3: spatial}  # of the start
MOTION: dict[int, AnyMovingNarrowPhase] = {2: planar, 3: spatial_motion}


def geometry_of(dimension: int) -> AnyNarrowPhase:
    """Return the narrow phase for this dimension. Raises UsageError where there is none."""
    if dimension not in GEOMETRY:
        known = " or ".join(map(str, sorted(GEOMETRY)))
        raise UsageError(f"blocks in {dimension} dimensions cannot touch: contact is known in {known} dimensions")
    return GEOMETRY[dimension]


def motion_of(dimension: int) -> AnyMovingNarrowPhase:
    """Return the narrow phase for blocks that move; joints of the start that stay there are those of `geometry_of`."""
    return MOTION[dimension]
