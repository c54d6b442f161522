"""Model of a structure for the solvers: arrays only, the same fields in 2D and 3D.

Generalised vectors have n_dof = d + r columns: d translations, then r rotations
(2D: x, y, angle about z; 3D: x, y, z and three rotations).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.geometry.topology import Topology, topology_of_polygons
from dem_cli.core.model.block_measures import (
    BlockMeasures,
    FaceMeasures,
    PartMeasures,
    block_measures,
    face_measures,
    half_extents,
    part_measures,
)
from dem_cli.core.model.following_loads import FollowingLoads

NONE = np.zeros(0, np.int64)
NO_AXES = np.zeros((0, 4))
NO_MODES = np.zeros((0, 0))
MOTIONS = {2: ("x", "y", "rotation"), 3: ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")}  # of a block
NO_RESTRAINTS = np.zeros((0, 0), bool)
NO_PIECES = NO_COURSES = np.zeros((0, 2), np.int64)
NO_FIRST_MOMENTS = np.zeros((0, 0))
NO_SHAPES, NO_STRAINS = np.zeros((0, 6, 2, 6)), np.zeros(0)


class ModelArrays(NamedTuple):
    """Arrays of a model, as results store them (but for names of the input)."""

    dimension: int  # 2 or 3
    block_ids: tuple[str, ...]  # name of each block
    material_names: tuple[str, ...]  # the names that block_material indexes
    block_material: np.ndarray  # material of each block, (n_blocks,) int64
    fixed: np.ndarray  # blocks that cannot move, (n_blocks,) bool
    thickness: np.ndarray  # depth out of plane [m], (n_blocks,)
    masses: np.ndarray  # [kg], (n_blocks,)
    inertias: np.ndarray  # about the centroid, in space the principal ones [kg m2], (n_blocks, r)
    centroids: np.ndarray  # undeformed place [m], (n_blocks, d)
    part_blocks: np.ndarray  # block that each convex part belongs to, (n_parts,) int64, ascending
    part_starts: np.ndarray  # part p has the corners part_starts[p]:part_starts[p + 1], (n_parts + 1,) int64
    vertices: np.ndarray  # corners from the centroid of their block [m], (n_vertices, d); counter-clockwise in 2D
    dead_loads: np.ndarray  # weight and dead point loads [N, N m], (n_blocks, n_dof)
    live_loads: np.ndarray  # loads that the multiplier acts on [N, N m], (n_blocks, n_dof)
    aliases: tuple[tuple[str, str], ...] = ()  # other names of blocks: (alias, name of the block)
    selections: tuple[tuple[str, tuple[str, ...]], ...] = ()  # names of several blocks: (name, ids)
    # In space alone; in the plane they are empty, for there faces and axes follow from the corners:
    part_faces: np.ndarray = NONE  # part p has the faces part_faces[p]:part_faces[p + 1], (n_parts + 1,) int64
    face_starts: np.ndarray = NONE  # face f has face_corners[face_starts[f]:face_starts[f + 1]], (n_faces + 1,) int64
    face_corners: np.ndarray = NONE  # corners around each face seen from outside, counter-clockwise, int64
    principal_axes: np.ndarray = NO_AXES  # from the principal axes of each block to its own, quaternions, (n_blocks, 4)
    links: tuple[Any, ...] = ()  # ties and the like, arrays of each kind that there is (links/link.py)
    link_names: tuple[str, ...] = ()  # of all of them, kind by kind
    following: FollowingLoads | None = None  # loads, part of those above, that go along where geometry moves
    # Of blocks that deform alone (model/uniform_strain.py), else empty:
    mode_stiffness: np.ndarray = NO_MODES  # 0: rigid blocks among them [N/m], (n_blocks, m)
    dead_mode_loads: np.ndarray = NO_MODES  # what dead loads do to the modes [N], (n_blocks, m)
    live_mode_loads: np.ndarray = NO_MODES  # the same of live loads [N], (n_blocks, m)
    imposed_strains: np.ndarray = NO_STRAINS  # in all directions, if nothing holds the block; part of the dead loads of
    # modes as well, (n_blocks,)
    mode_shapes: np.ndarray = NO_SHAPES  # of quadratic modes (model/quadratic_modes.py), (n_blocks, 6, 2, 6)
    # Of structures with loads at points alone, else empty (model/first_moments.py), (n_blocks, 3 or 6):
    dead_first_moments: np.ndarray = NO_FIRST_MOMENTS  # of dead loads at points about the centroid [N m]
    live_first_moments: np.ndarray = NO_FIRST_MOMENTS  # the same of live loads [N m]
    # Of structures with restraints alone, else empty:
    restrained: np.ndarray = NO_RESTRAINTS  # motions of blocks that are held, (n_blocks, d + r) bool
    # Of stones that can crack alone, else empty:
    pieces: np.ndarray = NO_PIECES  # stone that each block is a piece of, by number, and the joint between its pieces,
    # by the number of its name; −1: it is a whole stone, (n_blocks, 2) int64
    # Of structures whose head joints are not like their beds alone, else empty:
    courses: np.ndarray = NO_COURSES  # course that each block is laid in, by number, −1: none, and the row across that,
    # 0: it goes through all of them, (n_blocks, 2) int64
    ranks: np.ndarray = NONE  # place of each block in the input, in which order results have them, (n_blocks,) int64;
    # empty: blocks are in that order


SPATIAL_MODEL = ("part_faces", "face_starts", "face_corners", "principal_axes")  # empty in the plane
OF_MODES = (  # empty where blocks are rigid
    "mode_stiffness", "dead_mode_loads", "live_mode_loads", "mode_shapes", "imposed_strains"
)  # fmt: skip
WHERE_ASKED_FOR = (
    *OF_MODES,
    "dead_first_moments",
    "live_first_moments",
    "restrained",
    "pieces",
    "courses",
    "ranks",
)  # rows of blocks; empty where the model has none


class Model(ModelArrays):
    """Structure that does not change during a run. Blocks are numbered 0 … n_blocks − 1.

    What follows from its arrays (names, topology, measures of the blocks) is worked out once, when it is first asked
    for; a model with other arrays (`_replace`, `only`) works it out anew.
    """

    @property
    def n_blocks(self) -> int:
        """Number of blocks."""
        return len(self.block_ids)

    @property
    def rotations(self) -> slice:
        """Columns of generalised vectors that are rotations; what is behind them deforms the block."""
        return slice(self.dimension, self.dimension + self.inertias.shape[1])

    @property
    def n_modes(self) -> int:
        """Number of modes by which blocks deform; 0: rigid blocks."""
        return self.mode_stiffness.shape[1]

    @cached_property
    def held(self) -> np.ndarray:
        """Motions that loads do not change: all of fixed blocks, and those restrained, (n_blocks, d + r) bool."""
        whole = np.repeat(self.fixed[:, None], self.rotations.stop, axis=1)
        return whole | self.restrained if len(self.restrained) else whole

    @cached_property
    def held_columns(self) -> np.ndarray:
        """Restrained columns of the free blocks, block by block, (n_free_blocks·(d + r),) bool."""
        return self.held[~self.fixed].ravel()

    @property
    def n_parts(self) -> int:
        """Number of convex parts of all blocks."""
        return len(self.part_blocks)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Number of each block by its name or alias; a name comes before an alias."""
        names = {name: i for i, name in enumerate(self.block_ids)}
        return names | {alias: names[name] for alias, name in self.aliases if alias not in names and name in names}

    @cached_property
    def groups(self) -> dict[str, np.ndarray]:
        """Numbers of the blocks of each selection by its name."""
        names = self.numbers
        return {name: np.array([names[i] for i in ids if i in names], np.int64) for name, ids in self.selections}

    def chosen(self, name: str | None, fixed: bool | None = None) -> np.ndarray:
        """Numbers of the blocks that a name stands for; none where there is no such name.

        fixed: of several, those that are supports alone, or (False) those that can move, where there are any.
        """
        if name in self.numbers:
            return np.array([self.numbers[name]], np.int64)
        found = self.groups.get(name or "", NONE)
        kept = found if fixed is None else found[self.fixed[found] == fixed]
        return kept if len(kept) else found

    def held_among(self, name: str | None) -> np.ndarray:
        """Numbers of those blocks of a name that are fixed or restrained in some motion."""
        found = self.chosen(name)
        return found[self.held[found].any(axis=1)]

    @cached_property
    def vertex_blocks(self) -> np.ndarray:
        """Block of each corner, (n_vertices,)."""
        return np.repeat(self.part_blocks, np.diff(self.part_starts))

    @cached_property
    def topology(self) -> Topology:
        """Faces of the parts, and their corners."""
        if len(self.face_starts):
            return Topology(self.part_faces, self.face_starts, self.face_corners)
        return topology_of_polygons(self.part_starts)

    @cached_property
    def inner_faces(self) -> np.ndarray:
        """Faces inside a block of several parts, that nothing else can touch, (n_faces,) bool."""
        return shapes_of(self.vertices).inner_faces(self.vertices, self.topology, self.part_blocks, self.parts.sizes)

    @cached_property
    def parts(self) -> PartMeasures:
        """Volumes and sizes of the parts."""
        return part_measures(self.vertices, self.part_starts, self.topology)

    @cached_property
    def shapes(self) -> BlockMeasures:
        """Volumes, widths, shortest edges and radii of the blocks."""
        return block_measures(self.vertices, self.part_starts, self.topology, self.part_blocks, self.parts)

    @cached_property
    def faces(self) -> FaceMeasures:
        """Areas, normals and sides of the faces of polyhedra."""
        return face_measures(self.vertices, self.topology)

    @cached_property
    def half_extents(self) -> np.ndarray:
        """Half the extent of its block across each face [m], (n_faces,)."""
        return half_extents(self.vertices, self.vertex_blocks, self.topology, self.part_blocks)

    def joints_between(self, by_material: np.ndarray, blocks: np.ndarray, heads: np.ndarray) -> np.ndarray:
        """Find the named joint of each pair of blocks (n, 2), (n,): of their materials, or within the stone of
        both.

        by_material: joint of each pair of materials, (n_materials, n_materials) int64; heads: the joint that lies in
        the head joints of each named one, −1: nothing does, (n_named,) int64. Returns −1 where there is nothing.
        """
        materials = self.block_material[blocks]
        named = by_material[materials[:, 0], materials[:, 1]]
        if len(self.courses):
            named = np.where(self.side_by_side(blocks), heads[named], named)
        if not len(self.pieces):
            return named
        stones = self.pieces[blocks, 0]
        return np.where((stones[:, 0] == stones[:, 1]) & (stones[:, 0] >= 0), self.pieces[blocks[:, 0], 1], named)

    def side_by_side(self, blocks: np.ndarray) -> np.ndarray:
        """Test whether each pair of blocks (n, 2) shares a head joint: both lie in one row of one course, (n,)
        bool.

        All are False where the model has no courses: head joints are not distinguished then.
        """
        if not len(self.courses):
            return np.zeros(len(blocks), bool)
        (course, other), (row, beside) = (self.courses[blocks, k].T for k in (0, 1))
        return (course == other) & (course >= 0) & ((row == beside) | (row == 0) | (beside == 0))

    def only(self, blocks: Sequence[int], fixed: np.ndarray) -> Model:
        """Reduce the model to these blocks, in this order, without links; fixed: which cannot move, (n,) bool."""
        of_blocks = [np.flatnonzero(self.part_blocks == block) for block in blocks]
        pick, parts = np.array(blocks), np.concatenate(of_blocks)
        part_starts, corners = _rows(self.part_starts, parts)
        part_faces, face_starts, face_corners = self.part_faces, self.face_starts, self.face_corners
        if len(face_starts):
            part_faces, faces = _rows(self.part_faces, parts)
            face_starts, places = _rows(self.face_starts, faces)
            renumbered = np.full(len(self.vertices), -1)
            renumbered[corners] = np.arange(len(corners))
            face_corners = renumbered[self.face_corners[places]]
        return self._replace(
            block_ids=tuple(self.block_ids[i] for i in blocks),
            block_material=self.block_material[pick],
            fixed=fixed,
            thickness=self.thickness[pick],
            masses=self.masses[pick],
            inertias=self.inertias[pick],
            centroids=self.centroids[pick],
            part_blocks=np.repeat(np.arange(len(blocks)), [len(p) for p in of_blocks]),
            part_starts=part_starts,
            vertices=self.vertices[corners],
            dead_loads=self.dead_loads[pick],
            live_loads=self.live_loads[pick],
            part_faces=part_faces,
            face_starts=face_starts,
            face_corners=face_corners,
            principal_axes=self.principal_axes[pick] if len(self.principal_axes) else self.principal_axes,
            links=(),
            link_names=(),
            following=None,
            **{name: getattr(self, name)[pick] for name in WHERE_ASKED_FOR if len(getattr(self, name))},
        )

    def parts_alone(self) -> Model:
        """Make every part a block of its own that can move; for detection, masses and loads are not divided."""
        return self._replace(
            part_blocks=np.arange(self.n_parts),
            fixed=np.zeros(self.n_parts, bool),
            mode_stiffness=NO_MODES,
            dead_mode_loads=NO_MODES,
            live_mode_loads=NO_MODES,
            dead_first_moments=NO_FIRST_MOMENTS,
            live_first_moments=NO_FIRST_MOMENTS,
            restrained=NO_RESTRAINTS,
            pieces=NO_PIECES,
            courses=NO_COURSES,
            mode_shapes=NO_SHAPES,
            imposed_strains=NO_STRAINS,
        )


def _rows(starts: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Select rows of compressed sparse rows: their new starts, and the places of their entries, row by row."""
    counts = np.diff(starts)[rows]
    upto = np.concatenate([[0], np.cumsum(counts)])
    return upto, np.arange(upto[-1]) + np.repeat(starts[rows] - upto[:-1], counts)
