"""Joints as arrays, before and after their geometry is known: properties, pairs of faces, stiffness, empty contacts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol, Self

import numpy as np

from dem_cli.core.contact.block_compliance import BlockCompliance
from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.kernels.fixed_joints import NO_SHARES
from dem_cli.core.kernels.records import INTEGRATED, NOTHING, Contacts, FixedJoints, Joints, MovingJoints
from dem_cli.core.model.copies import numbered_through, repeated
from dem_cli.core.model.model import Model


class Faces(NamedTuple):
    """Pairs of faces of convex parts that touch or may touch, ordered by parts."""

    parts: np.ndarray  # the two parts a < b, (n, 2) int64
    faces: np.ndarray  # the two faces, as Model.topology numbers them, (n, 2) int64
    separation: np.ndarray  # distance along the best separating axis [m], negative: overlap, (n,)
    reach: float = 0.0  # within which they were looked for [m]

    def where(self, kept: np.ndarray) -> Faces:
        """Select the pairs of faces of a mask (n,) bool."""
        return Faces(self.parts[kept], self.faces[kept], self.separation[kept], self.reach)


class DrawnFaces(NamedTuple):
    """Pairs of faces that share a joint in the undeformed structure, with the outline of each as places on both parts.

    Pair j has the places starts[j]:starts[j + 1]: in the plane both ends, in space the corners around the overlap.
    """

    blocks: np.ndarray  # the two blocks, (n, 2) int64
    normals: np.ndarray  # unit, from the first to the second, (n, d)
    starts: np.ndarray  # (n + 1,) int64
    on_first: np.ndarray  # on the first block [m], (n_places, d)
    on_second: np.ndarray  # opposite, on the second [m], (n_places, d)
    shares: np.ndarray  # of the joint that belong to each place, (n_places,)
    lengths: np.ndarray  # between the two places that are furthest apart [m], (n,)
    areas: np.ndarray  # [m²], (n,)

    def taken(self, order: np.ndarray) -> DrawnFaces:
        """Select the pairs with these numbers, in this order."""
        places = points_of(self.starts, order)
        starts = np.concatenate([[0], np.cumsum(np.diff(self.starts)[order])])
        return DrawnFaces(
            self.blocks[order], self.normals[order], starts, self.on_first[places], self.on_second[places],
            self.shares[places], self.lengths[order], self.areas[order],
        )  # fmt: skip

    def copies(self, count: int, n_blocks: int) -> DrawnFaces:
        """Repeat the faces for several copies of a structure, one behind the other; blocks and places are numbered
        through.
        """
        starts = numbered_through(self.starts[:-1], self.starts[-1], count)
        normals, *others = (repeated(values, count) for values in (self.normals, *self[3:]))
        blocks = numbered_through(self.blocks, n_blocks, count)
        return DrawnFaces(blocks, normals, np.append(starts, count * self.starts[-1]), *others)


# Normal forces [N] of points by parameters of their joints, overlaps [m], negative: open, memory and kn
# (laws/law.py: `pressed`).
PressedLaw = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


# Parameters of the law of joints, (n, n_parameters), by their named joint (n,), their stiffness kn [Pa/m], (n,), and
# the model with the numbers of their blocks, (n, 2).
LawRows = Callable[[np.ndarray, np.ndarray, Model, np.ndarray], np.ndarray]


class JointProperties(NamedTuple):
    """Stiffness, law and contact points of each named joint, by its number."""

    names: tuple[str, ...]
    by_material: np.ndarray  # joint of each pair of materials, (n_materials, n_materials) int64
    kn: np.ndarray  # [Pa/m], (n_named,)
    ks: np.ndarray  # [Pa/m], (n_named,)
    law: np.ndarray  # parameters of the law, (n_named, n_parameters)
    intact: np.ndarray  # what points that touch at the start remember, (n_named, n_scalars)
    layouts: tuple[PointLayout | None, ...]  # where the contact points are; None: at the two ends of the joint
    spread: np.ndarray  # in space: those without bonds or given points, whose friction has the torsion
    # of a spread pressure (contact/corner_forces.py), (n_named,) bool
    rigid: np.ndarray  # whose stiffness is a means and no property: kn = "auto", no block deforms, (n_named,) bool
    pressed: PressedLaw = lambda parameters, overlaps, memory, kn: kn * np.maximum(overlaps, 0.0)
    bonded: bool = False  # whether points lose work across the joint too: it is counted from gap to gap
    integrated: np.ndarray | None = None  # whose pressure is integrated where elastic, (n_named,) bool; None: of none
    compliance: BlockCompliance | None = None  # of the blocks, lumped into their joints; None: all blocks are rigid
    lands: bool = False  # whether blocks land on points at the ends of joints: on elastic ones these twist alone
    heads: np.ndarray | None = None  # named joint in the head joints of each, −1: nothing, (n_named,); None: its own
    rows: LawRows | None = None  # of joints whose stiffness or friction is not that of their name; None: as `law`

    @property
    def profiled(self) -> bool:
        """True where any joint has points elsewhere than at its two ends."""
        return any(layout is not None for layout in self.layouts)

    @property
    def rough(self) -> bool:
        """True where any joint has a profile: points that are not in one plane."""
        return any(layout is not None and layout.sides is not None for layout in self.layouts)

    @property
    def given(self) -> bool:
        """True where the stiffness of any joint is a property of the structure: kn given, or blocks that deform."""
        return self.compliance is not None or not self.rigid.all()

    @property
    def plane(self) -> list[PointLayout]:
        """Layouts of plane joints; joints with a profile as if they had none."""
        return [PointLayout() if layout is None or layout.sides is not None else layout for layout in self.layouts]

    @property
    def centred(self) -> np.ndarray:
        """Joints in space with points at the corners and the centroid of each face joint, (n_named,) bool."""
        return np.array([layout.centred for layout in self.plane])

    @property
    def along_sides(self) -> np.ndarray:
        """Number of points along each side of a face joint; 2: at its corners alone, or at its centre too,
        (n_named,).
        """
        return np.array([2 if layout.centred else layout.points for layout in self.plane])

    def between(self, model: Model, blocks: np.ndarray) -> np.ndarray:
        """Find the named joint of each pair of blocks (n, 2), −1 for an open head joint, (n,) int64."""
        heads = np.arange(len(self.names)) if self.heads is None else self.heads
        return model.joints_between(self.by_material, blocks, heads)

    def acting(self, model: Model, faces: Faces) -> Faces:
        """Select faces that can transfer force: without those in head joints that are not filled."""
        if self.heads is None or (self.heads >= 0).all():
            return faces
        return faces.where(self.between(model, model.part_blocks[faces.parts]) >= 0)

    def rigid_between(self, model: Model, blocks: np.ndarray) -> np.ndarray:
        """Test whether the joint of each pair of blocks (n, 2) is as rigid as the solver can make it, (n,) bool."""
        rigid = self.rigid[self.between(model, blocks)]
        return rigid if self.compliance is None else rigid & ~self.compliance.deforms[blocks].any(axis=1)

    def integrated_between(self, model: Model, blocks: np.ndarray) -> np.ndarray:
        """Test whether pressure is integrated over the faces of each pair of blocks (n, 2), (n,) bool."""
        if self.integrated is None:
            return np.zeros(len(blocks), bool)
        return self.integrated[self.between(model, blocks)] & ~self.rigid_between(model, blocks)

    def spread_between(self, model: Model, blocks: np.ndarray) -> np.ndarray:
        """Test whether friction between each pair of blocks (n, 2) has the torsion of a spread pressure, (n,) bool."""
        spread = self.spread[self.between(model, blocks)]
        return spread & self.rigid_between(model, blocks) if self.lands else spread

    def stiffness_of(self, named: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute normal and shear stiffness kn, ks of joints by name and faces [Pa/m], (n,) each, with the compliance
        of their blocks.

        faces: of both blocks, (n, 2), or of one that meets something rigid, (n, 1).
        """
        kn, ks = self.kn[named], self.ks[named]
        if self.compliance is None:
            return kn, ks
        together = self.compliance.in_series(np.column_stack([kn, ks]), faces, named)
        return together[:, 0], together[:, 1]

    def law_of(self, named: np.ndarray, kn: np.ndarray, model: Model, blocks: np.ndarray) -> np.ndarray:
        """Collect the law parameters of joints by name, stiffness kn [Pa/m] and blocks (n, 2), (n, n_parameters)."""
        return np.ascontiguousarray(self.law[named] if self.rows is None else self.rows(named, kn, model, blocks))


class JointGeometry(Protocol):
    """Interface of the geometry of joints, one record of arrays for each dimension (kernels/records.py)."""

    def __iter__(self) -> Iterator[np.ndarray]:
        """Iterate over all arrays."""

    @property
    def keys(self) -> np.ndarray:
        """Keys of joints, two numbers each, (n_joints, 2); with the features, keys of the points."""

    @property
    def faces(self) -> np.ndarray:
        """Two faces of each joint (model.topology), (n_joints, 2)."""

    @property
    def features(self) -> np.ndarray:
        """Feature of its joint that each contact point is, a number within the joint, (n_points,)."""

    def kept(self) -> Self:
        """Return a record with a copy of the arrays that change."""

    def settled(self) -> Self:
        """Return the part of the geometry that is used when points stay where they were placed."""


class JointArrays(NamedTuple):
    """Arrays of all joints at one moment: stiffness and law, geometry, contact state."""

    joints: Joints
    geometry: JointGeometry
    contacts: Contacts

    @property
    def whole(self) -> np.ndarray:
        """Points of faces over which pressure is integrated, (n_points,) bool."""
        if not len(self.joints.integrated):
            return np.zeros(len(self.joints.kn), bool)
        return (self.joints.integrated == INTEGRATED)[self.joints.owners]

    @property
    def closed(self) -> np.ndarray:
        """Closure of the normal springs of all points [m], (n_points,); points of elastic faces by their own gaps."""
        kn = self.joints.kn
        closed = self.contacts.normal / np.where(kn > 0.0, kn, 1.0)
        return np.where(self.whole, -self.contacts.gaps, closed) if len(self.joints.integrated) else closed

    @property
    def pressed(self) -> np.ndarray:
        """Twice the energy in the normal springs of all points [J], (n_points,)."""
        normal, kn = self.contacts.normal, self.joints.kn
        return normal * self.closed if len(self.joints.integrated) else normal**2 / np.where(kn > 0.0, kn, 1.0)


def empty_contacts(n_joints: int, n_points: int, dimension: int, n_memory: int, elastic: bool = False) -> Contacts:
    """Make contacts without forces. elastic: pressure is integrated over some faces. elastic: there are faces over
    which pressure is integrated.
    """
    return Contacts(
        gaps=np.zeros(n_points),
        shear=np.zeros((n_points, dimension - 1)),
        normal=np.zeros(n_points),
        slip=np.zeros(n_points),
        memory=np.zeros((n_points, n_memory)),
        closure=np.zeros(n_points),
        stale=np.zeros(n_joints + 1, np.int8),
        exchanged=np.zeros(2),
        jolts=np.zeros(1),
        lumped=np.zeros(n_points if elastic else 0),
    )


def joints_of(
    model: Model,
    faces: Faces,
    properties: JointProperties,
    starts: np.ndarray,
    areas: np.ndarray,
    shares: np.ndarray,
    torsion: np.ndarray = NO_SHARES,
    lone: np.ndarray | bool = False,
) -> MovingJoints:
    """Make joints of pairs of faces with their stiffness and law; frames, levers and points are yet to be placed.

    starts: first point of each joint, (n_joints + 1,); areas: of the joints [m²], (n_joints,); shares: of it that
    belong to each point, (n_points,); torsion: in space, as FixedJoints.torsion, (n_joints,); lone: joints of an edge
    or a corner, that have no face, (n_joints,) bool.
    """
    d, r, n_points = model.dimension, model.inertias.shape[1], int(starts[-1])
    blocks = model.part_blocks[faces.parts]
    named = properties.between(model, blocks)
    kn, ks = properties.stiffness_of(named, faces.faces)
    owners = np.repeat(np.arange(len(blocks)), np.diff(starts))
    integrated = properties.integrated_between(model, blocks) & ~lone
    elastic = dict[str, np.ndarray]()
    if integrated.any():
        elastic |= {name: np.zeros(n_points) for name in ("fans", "faint", "back")}
        elastic |= {"integrated": integrated.astype(np.int8), "after": np.arange(n_points)}
    return MovingJoints(
        blocks=blocks,
        starts=starts,
        frames=np.zeros((n_points, d * d)),
        levers=np.zeros((n_points, 2 * d * r)),
        points=np.zeros((n_points, d)),
        kn=(kn * areas)[owners] * shares,
        ks=(ks * areas)[owners] * shares,
        law=properties.law_of(named, kn, model, blocks),
        torsion=torsion,
        held=np.full(len(blocks), -1),
        **elastic,
    )


def points_in_use(joints: Joints) -> np.ndarray:
    """Test which points can carry a force, (n_points,) bool; in space joints that move have spare points."""
    return joints.kn > 0.0


def points_of(starts: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """List all points of these joints, joint by joint."""
    counts = starts[joints + 1] - starts[joints]
    before = np.concatenate([[0], np.cumsum(counts)])[:-1]
    return np.repeat(starts[joints] - before, counts) + np.arange(counts.sum())


def only_points(joints: Joints, kept: np.ndarray) -> Joints:
    """Reduce joints to some of their points, which keep their own forces; kept: (n_points,) bool."""
    starts = np.concatenate([[0], np.cumsum(kept)])[joints.starts]
    own = ("places",) if isinstance(joints, FixedJoints) else ("frames", "levers", "points")
    return joints._replace(
        starts=starts, **{name: getattr(joints, name)[kept] for name in (*own, "kn", "ks")}, integrated=NOTHING
    )
