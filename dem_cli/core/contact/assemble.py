"""Assembly of joints from pairs of faces: arrays of the contact loop, geometry, and contacts without forces."""

from __future__ import annotations

from typing import Any

from dem_cli.core.contact.geometry import geometry_of, motion_of
from dem_cli.core.contact.joints import Faces, JointArrays, JointProperties, empty_contacts
from dem_cli.core.kernels.records import Bodies
from dem_cli.core.model.model import Model


def build_joints(
    model: Model,
    faces: Faces,
    bodies: Bodies,
    properties: JointProperties,
    n_memory: int,
    chains: Any = None,
    moves: bool = True,
) -> JointArrays:
    """Build the joints of the given faces with stiffness from their present overlap, and contacts without forces.

    chains: what comes back of the joints of the start (NarrowPhase.chains_of); None: these are they. moves: whether
    geometry does, else it is that of the start.
    """
    narrow = (motion_of if moves else geometry_of)(model.dimension)
    joints, geometry = narrow.points(model, faces, bodies.corners, properties, chains)
    contacts = empty_contacts(len(joints.blocks), len(joints.kn), model.dimension, n_memory, len(joints.integrated) > 0)
    narrow.place(joints, geometry, contacts, bodies)
    contacts.stale[-1] = 0  # faces that are the wrong ones already need not ask: the right ones are in the list
    return JointArrays(joints, geometry, contacts)
