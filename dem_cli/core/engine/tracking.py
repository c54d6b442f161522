"""Tracking of joints: faces that meet now, detected anew as blocks move; the memory of contact points follows them."""

from __future__ import annotations

from collections.abc import Iterable
from operator import is_

import numpy as np

from dem_cli.core.contact.assemble import build_joints
from dem_cli.core.contact.geometry import NarrowPhase, geometry_of, motion_of
from dem_cli.core.contact.joints import Faces, JointArrays, JointProperties
from dem_cli.core.contact.keys import same_rows
from dem_cli.core.contact.memory import carry_memory
from dem_cli.core.contact.start import TOUCHING_GAP, bond_touching, close_touching, corner_meetings, joints_of_start
from dem_cli.core.engine.settings import DEFAULT, DetectionSettings
from dem_cli.core.kernels.fixed_joints import FixedJoints
from dem_cli.core.kernels.records import Bodies, Contacts
from dem_cli.core.kernels.tiles.joint_tiles import BLOCKS_OF_CHUNK, tiled
from dem_cli.core.kernels.tiles.team import new_team
from dem_cli.core.model.model import Model


class JointTracking:
    """Tracking of the joints and contact points of blocks that may move.

    moves      whether geometry does; else joints are those of the start for good
    n_memory   numbers that each contact point remembers
    smallest   shortest edge of a block [m]
    reach      how near faces are that may soon touch [m]
    joints, geometry, contacts     the present ones
    detections                     how often they were looked for
    meetings                       parts that met corner to corner at the start
    unpassed                       those of them that have not passed each other, and have no joint, (n_meetings,) bool
    farthest                       how far a block may move until faces are looked at again [m]
    """

    def __init__(
        self, model: Model, bodies: Bodies, properties: JointProperties, moves: bool, n_memory: int, smallest: float,
        reach: float, settings: DetectionSettings = DEFAULT.detection,
    ):  # fmt: skip
        self.model, self.properties, self.moves, self.n_memory = model, properties, moves, n_memory
        self.smallest, self.reach, self.settings = smallest, reach, settings
        self.chains = None  # what comes back of the joints of the start
        self.detections = 0
        self.unpassed = np.zeros(0, bool)
        self.farthest = 0.5 * reach  # two may come towards each other
        self.take(self._first(bodies))

    @property
    def narrow(self) -> NarrowPhase:
        """Module that finds and places contact points; no copy of a simulation could include it."""
        return (motion_of if self.moves else geometry_of)(self.model.dimension)

    def take(self, arrays: JointArrays) -> None:
        """Replace the present joints."""
        self.joints, self.geometry, self.contacts = arrays

    def arrays(self) -> JointArrays:
        """Return all arrays of the present joints."""
        return JointArrays(self.joints, self.geometry, self.contacts)

    def tile(self, n_numbers: int, threads: int) -> None:
        """Sort joints that do not move into tiles, for a law that reads so many numbers of a joint there."""
        joints = self.joints
        if isinstance(joints, FixedJoints):
            n, d, members = self.model.n_blocks, self.model.dimension, self._of_use(threads)
            self.joints = joints._replace(tiles=tiled(joints.blocks, joints.starts, n, d, n_numbers, members))

    def _of_use(self, threads: int) -> int:
        """Return how many of so many threads find work: one for each chunk of blocks but the first."""
        return max(min(threads, (self.model.n_blocks - 1) // BLOCKS_OF_CHUNK), 1)

    def assemble(self, n_numbers: int, threads: int) -> int:
        """Form a team of at most so many threads for the next call of the loop over tiles; returns how many.

        Tiles are made anew where they have no room for them, as a run has that goes on with more than it began with.
        """
        if not isinstance(self.joints, FixedJoints):
            return 1
        members = self._of_use(threads)
        if len(self.joints.tiles.controls) < members:
            self.tile(n_numbers, members)
        self.joints.tiles.team[:] = new_team(members)
        return members

    def _first(self, bodies: Bodies) -> JointArrays:
        model, n_memory = self.model, self.n_memory
        self.detections += 1
        if not self.moves:
            return joints_of_start(model, bodies, self.properties, self.smallest, n_memory)
        found = self.properties.acting(model, self.narrow.find(model, bodies.corners, self.reach))
        still = geometry_of(model.dimension)
        self.meetings = corner_meetings(model, still, found, bodies, TOUCHING_GAP * self.smallest)
        self.unpassed = np.ones(len(self.meetings.parts), bool)
        self._look_ahead(0.0, self.settings.passing * self.meetings.sizes)
        faces = self._passed(found)
        self.chains = self.narrow.chains_of(model, faces, bodies.corners, self.properties)
        built = build_joints(model, faces, bodies, self.properties, n_memory, self.chains)
        close_touching(built.contacts, self.smallest)
        bond_touching(model, built, self.properties, self.narrow)
        return built

    def faces_within(self, bodies: Bodies, distance: float) -> Faces:
        """Find pairs of faces that are nearer to each other than a distance [m], where the blocks are now."""
        found = self.narrow.find(self.model, bodies.corners, distance)
        return self._passed(self.properties.acting(self.model, found))

    def _passed(self, faces: Faces) -> Faces:
        """Remove faces of parts that met corner to corner and have not passed each other since."""
        if not self.unpassed.any():
            return faces
        return faces.where(same_rows(self.meetings.parts[self.unpassed], faces.parts) < 0)

    def _room(self, bodies: Bodies) -> np.ndarray:
        """Compute how far parts that met corner to corner may move until one has passed the other [m],
        (n_meetings,).

        By more than the elastic overlap there, and by more than what is no width of a joint.
        """
        deepest = float(self.arrays().closed.max(initial=0.0))
        passing = np.maximum(self.settings.passing * self.meetings.sizes, self.settings.overlaps * deepest)
        return passing - self.meetings.shifts(bodies)

    def _look_ahead(self, travel: float, room: np.ndarray) -> None:
        """Compute the travel before which no corner can have passed another one. travel: of the farthest block up
        to now [m]; room: of those that have not (n,) [m]."""
        self.farthest = 0.5 * self.reach  # two may come towards each other
        if len(room):
            least = self.settings.looks * self.settings.passing * float(self.meetings.sizes[self.unpassed].min())
            self.farthest = min(self.farthest, travel + 0.5 * max(float(room.min()), least))

    def due(self, bodies: Bodies) -> bool:
        """Test whether a block has moved so far, or a corner so passed another one, that there may be other faces.

        Else `farthest` says how far blocks may move until the next look.
        """
        travel = float(bodies.travel.max(initial=0.0))
        if travel > 0.5 * self.reach or self.contacts.stale[-1]:
            return True
        if travel > self.farthest:
            room = self._room(bodies)[self.unpassed]
            self._look_ahead(travel, room)
            return bool((room < 0.0).any())
        return False

    def detect(self, bodies: Bodies) -> None:
        """Detect new faces after large motion; memory follows the contact points."""
        old = self.arrays()
        before = self.unpassed
        if before.any():
            room = self._room(bodies)
            self.unpassed = before & (room >= 0.0)
            self._look_ahead(0.0, room[self.unpassed])
        Gauge(self).measured(self, bodies)  # the points of the old joints, for those that move on
        faces = self.faces_within(bodies, self.reach)
        new = build_joints(self.model, faces, bodies, self.properties, self.n_memory, self.chains)
        self._begin_unpressed(new, before & ~self.unpassed)
        carry_memory(motion_of(self.model.dimension), old, new, self.properties)
        if bodies.travel.max(initial=0.0) < self.settings.same_place * self.reach:
            # Still the same faces though nothing moved: do not ask again at every step.
            asked = old.geometry.keys[old.contacts.stale[:-1] == 1]
            new.contacts.stale[:-1] |= same_rows(asked, new.geometry.keys) >= 0
        self.take(new)
        self.detections += 1

    def _begin_unpressed(self, new: JointArrays, passed: np.ndarray) -> None:
        """Start joints of parts that have just passed each other, (n_meetings,) bool, unpressed: only closing from
        now on counts.

        How deep corners were inside each other meanwhile is no elastic overlap: nothing did that work. Time histories
        know no closure (engine/rigid_joints.py), and do not ask for it.
        """
        if passed.any():
            parts = self.model.topology.face_parts[new.geometry.faces]
            own = (same_rows(self.meetings.parts[passed], parts) >= 0)[new.joints.owners]
            new.contacts.closure[own] = np.minimum(new.contacts.gaps[own], 0.0)


class Gauge:
    """Gauge of the present joints: their gaps at one instant after the other, without a change of contact points.

    What a compiled loop may write to is the same arrays each time: it then knows all of them from the last call.
    """

    def __init__(self, tracking: JointTracking):
        self.of = tracking.arrays()
        self.geometry, self.contacts = self.of.geometry.kept(), Contacts(*(a.copy() for a in self.of.contacts))

    def fits(self, tracking: JointTracking) -> bool:
        """Test whether these are still the joints that the gauge was made for."""
        return all(map(is_, self.of, tracking.arrays()))

    def measured(self, tracking: JointTracking, bodies: Bodies) -> Contacts:
        """Measure the gaps of this instant; frames, levers and points of the joints follow, nothing else."""
        if tracking.moves:
            _copy([*self.of.geometry.kept(), *self.of.contacts], [*self.geometry, *self.contacts])
            tracking.narrow.place(self.of.joints, self.geometry, self.contacts, bodies)
            return Contacts(*(a.copy() for a in self.contacts))
        return Contacts(*(a.copy() for a in self.of.contacts))


def _copy(source: Iterable[np.ndarray], target: Iterable[np.ndarray]) -> None:
    """Copy records of arrays, in place where they are not the same."""
    for values, here in zip(source, target, strict=True):
        if here is not values:
            here[...] = values
