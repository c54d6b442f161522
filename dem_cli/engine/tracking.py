"""Tracking of joints: which faces meet now, found anew as blocks move; the memory of contact points follows them."""

from __future__ import annotations

import numpy as np

from dem_cli.contact.assemble import (
    Chains,
    JointProperties,
    build_joints,
    carry_memory,
    chains_of_start,
    measure_points,
)
from dem_cli.contact.detect import Faces, find_joints, inner_edges
from dem_cli.contact.start import bond_touching, close_touching, joints_of_start
from dem_cli.engine.settings import DEFAULT, DetectionSettings
from dem_cli.kernels.records import Bodies, Contacts, Joints
from dem_cli.model.model import Model


class JointTracking:
    """The joints and contact points of blocks that may move.

    moves      whether geometry does; else joints are those of the start for good
    n_memory   numbers that each contact point remembers
    smallest   shortest edge of a block [m]
    reach      how near faces are that may soon touch [m]
    joints, contacts, detections   the present ones, and how often they were looked for
    """

    def __init__(
        self, model: Model, bodies: Bodies, properties: JointProperties, moves: bool, n_memory: int, smallest: float,
        reach: float, settings: DetectionSettings = DEFAULT.detection,
    ):  # fmt: skip
        self.model, self.properties, self.moves, self.n_memory = model, properties, moves, n_memory
        self.smallest, self.reach, self.settings = smallest, reach, settings
        self.inner = inner_edges(model)
        self.chains: Chains | None = None
        self.detections = 0
        self.joints, self.contacts = self._first(bodies)

    def _first(self, bodies: Bodies) -> tuple[Joints, Contacts]:
        model, n_memory = self.model, self.n_memory
        self.detections += 1
        if not self.moves:
            return joints_of_start(model, bodies, self.properties, self.smallest, n_memory)
        faces = self.faces_within(bodies, self.reach)
        if self.properties.profiled:
            self.chains = chains_of_start(model, faces, bodies, self.properties)
        joints, contacts = build_joints(model, faces, bodies, self.properties, n_memory, self.chains)
        close_touching(contacts, self.smallest)
        bond_touching(model, joints, contacts, self.properties)
        return joints, contacts

    def faces_within(self, bodies: Bodies, distance: float) -> Faces:
        """Pairs of faces that are nearer to each other than a distance [m], where the blocks are now."""
        return find_joints(self.model, bodies.corners, distance, self.inner)

    def due(self, bodies: Bodies) -> bool:
        """Whether a block has moved so far, or a corner so passed an edge, that there may be other faces."""
        return bool(bodies.travel.max(initial=0.0) > 0.5 * self.reach or self.contacts.stale[-1])

    def detect(self, bodies: Bodies) -> None:
        """New faces after large motion; memory follows the contact points."""
        old, memory = self.joints, self.contacts
        self.measured(bodies)  # the points of the old joints, for those that move on
        faces = self.faces_within(bodies, self.reach)
        joints, contacts = build_joints(self.model, faces, bodies, self.properties, self.n_memory, self.chains)
        carry_memory(old, memory, joints, contacts)
        if bodies.travel.max(initial=0.0) < self.settings.same_place * self.reach:
            # Still the same faces though nothing moved: do not ask again at every step.
            asked = {tuple(row) for row in old.edges[memory.stale[:-1] == 1].tolist()}
            contacts.stale[:-1] |= np.array([tuple(row) in asked for row in joints.edges.tolist()], bool)
        self.joints, self.contacts = joints, contacts
        self.detections += 1

    def measured(self, bodies: Bodies) -> Contacts:
        """Contacts with the gaps of this instant; frames, levers and points of the joints follow, nothing else."""
        contacts = Contacts(*(a.copy() for a in self.contacts))
        if self.moves:
            measure_points(self.joints, contacts, bodies)
        return contacts
