"""Write the ParaView files of blocks, contact points, joints and links (.vtkhdf), one step per frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import h5py
import numpy as np

from dem_cli.core.model.copies import repeated
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord, FrameStack, JointPlaces, JointStates, LinkPlaces
from dem_cli.results.output.layout import declared
from dem_cli.results.output.paraview.cells import cells_of, lines, outlines_of_joints
from dem_cli.results.output.paraview.described_fields import (
    BLOCK_FIELDS,
    CONTACT_FIELDS,
    JOINT_FIELDS,
    LINK_FIELDS,
    STEP_FIELDS,
    VTK_FILES,
)
from dem_cli.results.output.paraview.fields import (
    block_fields,
    contact_fields,
    joint_fields,
    joint_places,
    step_fields,
    turning_fields,
)
from dem_cli.results.output.paraview.vertices import in_space, placed_vertices, rest_vertices, vertex_velocities
from dem_cli.results.output.paraview.vtkhdf import GridSeries, PointSeries

BLOCKS, CONTACTS, JOINTS, LINKS = VTK_FILES


class JointsNow(Protocol):
    """State of all joints at one or several instants."""

    @property
    def states(self) -> JointStates:
        """Return the joint states as stored in results.h5."""

    @property
    def gaps(self) -> np.ndarray:
        """Return the joint gaps at both ends [m], (n, 2); in space at the corners, (n_corners,)."""

    @property
    def ends(self) -> np.ndarray:
        """Return the positions of the joint ends [m], (n, 2, 2); in space (n_corners, 3)."""


class FollowedJoints(Protocol):
    """Joints of a structure as drawn, followed through the run (core/contact/drawn_joints.py)."""

    @property
    def places(self) -> JointPlaces:
        """Positions of the joints as drawn."""

    def at(self, positions: np.ndarray, orientations: np.ndarray, contacts: ContactRecord) -> JointsNow:
        """Return the joints at one instant, or at those of a FrameStack with its contacts."""


class ParaViewFiles:
    """ParaView files of a run. opened: creates one by its name; joints, links: None where there are none."""

    def __init__(
        self,
        model: Model,
        joints: JointPlaces | None,
        opened: Callable[[str], h5py.File],
        links: LinkPlaces | None = None,
    ):
        self.model, self._rest, d = model, rest_vertices(model), model.dimension
        said = declared(BLOCK_FIELDS | STEP_FIELDS, d)
        self.blocks = GridSeries(opened(BLOCKS), cells_of(model), block_fields(model), said)
        self.points = PointSeries(opened(CONTACTS), declared(CONTACT_FIELDS | STEP_FIELDS, d))
        self.joints: GridSeries | None = None
        if joints is not None:
            cells, said = outlines_of_joints(joints), declared(JOINT_FIELDS | STEP_FIELDS, d)
            self.joints = GridSeries(opened(JOINTS), cells, joint_places(joints), said)
        self.links: GridSeries | None = None
        if links is not None:
            numbers = {"link": np.arange(len(links.starts) - 1, dtype=np.int32)}
            self.links = GridSeries(opened(LINKS), lines(links.starts), numbers, declared(LINK_FIELDS | STEP_FIELDS, d))

    def write_out(self) -> None:
        """Write the buffered rows to the files."""
        for series in (self.blocks, self.points, self.joints, self.links):
            if series is not None:
                series.write_out()

    def add(self, values: np.ndarray, stack: FrameStack, joints: JointsNow | None) -> None:
        """Append frames; values (n_frames,): the times or numbers shown by ParaView."""
        model, steps, copies = self.model, step_fields(stack), len(stack.frames)
        vertices = placed_vertices(model, stack.positions, stack.orientations)
        velocities = vertex_velocities(model, vertices, stack.positions, stack.velocities)
        moving = {
            "displacement": in_space(vertices - repeated(self._rest, copies)), "velocity": in_space(velocities)
        }  # fmt: skip
        self.blocks.add(values, in_space(vertices), moving, turning_fields(model, stack), steps)
        contacts = stack.own_contacts()
        self.points.add(values, stack.n_points, in_space(contacts.points), contact_fields(contacts), steps)
        if self.joints is not None and joints is not None:
            ends = in_space(joints.ends.reshape(-1, model.dimension))
            gaps = {"gap": joints.gaps.ravel().astype(np.float32)}
            self.joints.add(values, ends, gaps, joint_fields(joints.states), steps)
        if self.links is not None:
            drawn = [(frame.links, frame) for frame in stack.frames if frame.links is not None]
            points = np.concatenate([at.places.at(frame.positions, frame.orientations) for at, frame in drawn])
            forces = np.concatenate([at.forces for at, _ in drawn]).astype(np.float32)
            largest = np.concatenate([at.largest() for at, _ in drawn]).astype(np.float32)
            self.links.add(values, in_space(points), {"force": forces}, {"largest_force": largest}, steps)
