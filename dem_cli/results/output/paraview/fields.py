"""Fields of blocks, contact points and joints for ParaView, as arrays: float32 and whole numbers."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.rotation import angles_of
from dem_cli.core.model.copies import numbered_through
from dem_cli.core.model.model import Model
from dem_cli.core.model.uniform_strain import components
from dem_cli.core.records.frames import ContactRecord, Frame, FrameStack, JointPlaces, JointStates
from dem_cli.results.output.block_stress import mean_stresses, principal_values
from dem_cli.results.output.paraview.vertices import in_space


def block_fields(model: Model) -> dict[str, np.ndarray]:
    """Return the constant fields of the blocks for ParaView, a value per convex part."""
    parts = model.part_blocks
    return {
        "block_id": parts.astype(np.int32),
        "material": model.block_material[parts].astype(np.int32),
        "fixed": model.fixed[parts].astype(np.uint8),
    }


def turning_fields(model: Model, frame: Frame | FrameStack) -> dict[str, np.ndarray]:
    """Return rotation, angular velocity (3D) and stress of the blocks; per convex part, frame by frame."""
    d, copies = model.dimension, len(frame.positions) // model.n_blocks
    parts = numbered_through(model.part_blocks, model.n_blocks, copies)
    found = {"rotation": angles_of(frame.orientations)}
    if frame.orientations.shape[1] == 4:
        found |= {"orientation": frame.orientations, "angular_velocity": frame.velocities[:, d:]}
    mean = mean_stresses(model, frame)
    found |= {"mean_stress": components(mean), "principal_stress": principal_values(mean)}
    if frame.stresses is not None:
        found["stress"] = frame.stresses
    return {name: values[parts].astype(np.float32) for name, values in found.items()}


def contact_fields(contacts: ContactRecord) -> dict[str, np.ndarray]:
    """Return the fields of the contact points for ParaView."""
    shear = contacts.shear_force
    return {
        "joint": contacts.joint.astype(np.int32),
        "block_a": contacts.blocks[:, 0].astype(np.int32),
        "block_b": contacts.blocks[:, 1].astype(np.int32),
        "normal": in_space(contacts.normals),
        "force": in_space(contacts.forces()),
        "normal_force": contacts.normal_force.astype(np.float32),
        "shear_force": (shear[:, 0] if shear.shape[1] == 1 else np.linalg.norm(shear, axis=1)).astype(np.float32),
        "gap": contacts.gap.astype(np.float32),
        "slip": contacts.slip.astype(np.float32),
        "state": contacts.state.astype(np.uint8),
    }


def joint_places(places: JointPlaces) -> dict[str, np.ndarray]:
    """Return the constant fields of the joints for ParaView."""
    blocks = places.blocks.astype(np.int32)
    return {"block_a": blocks[:, 0], "block_b": blocks[:, 1], "area": places.area.astype(np.float32)}


def joint_fields(states: JointStates) -> dict[str, np.ndarray]:
    """Return the fields of the joints at one instant for ParaView."""
    found = {name: values.astype(np.float32) for name, values in states._asdict().items() if name != "state"}
    return found | {"state": states.state.astype(np.uint8)}


def step_fields(stack: FrameStack) -> dict[str, np.ndarray]:
    """Return the numbers of whole frames, (n_frames,) each."""
    return {
        "load_multiplier": stack.numbers("load"),
        "control_displacement": stack.numbers("displacement"),
        "stage": stack.numbers("stage", np.int64),
        "step": stack.numbers("step", np.int64),
        "time": stack.numbers("time"),
    }
