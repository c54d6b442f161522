"""Files that ParaView and pyvista open by name, one step per frame: blocks, contact points, joints, links (.vtkhdf)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import h5py
import numpy as np

from dem_cli.model.model import Model
from dem_cli.output.layout import declared
from dem_cli.output.paraview.cells import cells_of, lines, outlines_of_joints
from dem_cli.output.paraview.described_fields import (
    BLOCK_FIELDS,
    CONTACT_FIELDS,
    JOINT_FIELDS,
    LINK_FIELDS,
    STEP_FIELDS,
    VTK_FILES,
)
from dem_cli.output.paraview.fields import (
    block_fields,
    contact_fields,
    joint_fields,
    joint_places,
    step_fields,
    turning_fields,
)
from dem_cli.output.paraview.vertices import in_space, placed_vertices, rest_vertices, vertex_velocities
from dem_cli.output.paraview.vtkhdf import GridSeries, PointSeries
from dem_cli.output.record import ContactRecord, Frame, JointPlaces, JointStates, LinkPlaces

BLOCKS, CONTACTS, JOINTS, LINKS = VTK_FILES


class JointsNow(Protocol):
    """All joints at one instant."""

    @property
    def states(self) -> JointStates:
        """As results.h5 keeps them."""

    @property
    def gaps(self) -> np.ndarray:
        """Distance at both ends [m], (n, 2); in space at the corners, (n_corners,)."""

    @property
    def ends(self) -> np.ndarray:
        """Where these are [m], (n, 2, 2); in space (n_corners, 3)."""


class FollowedJoints(Protocol):
    """The joints of a structure as it was drawn, and what became of them (contact/drawn_joints.py)."""

    @property
    def places(self) -> JointPlaces:
        """Where they were drawn."""

    def at(self, positions: np.ndarray, orientations: np.ndarray, contacts: ContactRecord) -> JointsNow:
        """At one instant."""


class ParaViewFiles:
    """The files of a run. opened: makes one by its name; joints, links: None where there are none."""

    def __init__(
        self,
        model: Model,
        joints: FollowedJoints | None,
        opened: Callable[[str], h5py.File],
        links: LinkPlaces | None = None,
    ):
        self.model, self._rest, d = model, rest_vertices(model), model.dimension
        said = declared(BLOCK_FIELDS | STEP_FIELDS, d)
        self.blocks = GridSeries(opened(BLOCKS), cells_of(model), block_fields(model), said)
        self.points = PointSeries(opened(CONTACTS), declared(CONTACT_FIELDS | STEP_FIELDS, d))
        self.joints: GridSeries | None = None
        if joints is not None:
            cells, said = outlines_of_joints(joints.places), declared(JOINT_FIELDS | STEP_FIELDS, d)
            self.joints = GridSeries(opened(JOINTS), cells, joint_places(joints.places), said)
        self.links: GridSeries | None = None
        if links is not None:
            numbers = {"link": np.arange(len(links.starts) - 1, dtype=np.int32)}
            self.links = GridSeries(opened(LINKS), lines(links.starts), numbers, declared(LINK_FIELDS | STEP_FIELDS, d))

    def write_out(self) -> None:
        """What waits becomes part of the files."""
        for series in (self.blocks, self.points, self.joints, self.links):
            if series is not None:
                series.write_out()

    def add(self, value: float, frame: Frame, joints: JointsNow | None) -> None:
        """Append a frame; value: what ParaView counts it by."""
        model, steps = self.model, step_fields(frame)
        vertices = placed_vertices(model, frame.positions, frame.orientations)
        velocities = vertex_velocities(model, vertices, frame.positions, frame.velocities)
        moving = {"displacement": in_space(vertices - self._rest), "velocity": in_space(velocities)}
        self.blocks.add(value, in_space(vertices), moving, turning_fields(model, frame), steps)
        self.points.add(value, in_space(frame.contacts.points), contact_fields(frame.contacts), steps)
        if self.joints is not None and joints is not None:
            ends = in_space(joints.ends.reshape(-1, model.dimension))
            gaps = {"gap": joints.gaps.ravel().astype(np.float32)}
            self.joints.add(value, ends, gaps, joint_fields(joints.states), steps)
        if self.links is not None and frame.links is not None:
            points = in_space(frame.links.places.at(frame.positions, frame.orientations))
            forces = {"force": frame.links.forces.astype(np.float32)}
            self.links.add(value, points, forces, {"largest_force": frame.links.largest().astype(np.float32)}, steps)
