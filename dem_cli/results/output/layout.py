"""Layout of results.h5: meaning, units, axes, columns and kind of every dataset and attribute.

Writers of datasets take their attributes from here and can write no others; readers check datasets against them
(output/integrity/); docs/results.md is generated from the same declarations (scripts/docs --write).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import h5py
import numpy as np
from h5py import h5a, h5s, h5t

RESULTS_FORMAT = 1
ROW_SCALARS = ("step", "load", "displacement", "unbalanced", "overlap", "time", "live_displacement")
PURE, WORDS = "1", ""  # units of pure numbers, counts and numbers of things; of text
PER_SECOND, PER_STEP = ("m/s", "rad/s"), ("m/step", "rad/step")  # of velocities: of centroids, of spins
TEXT = h5py.string_dtype()
_ON_DISK, _IN_MEMORY, _ONE = h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT), h5s.create(h5s.SCALAR)
NUMBERS, WHOLE, TRUTHS, NAMES = "numbers", "whole numbers", "true or false", "text"  # kinds of values
ONE_MORE = " + 1"  # ends the label of an axis that has one more than what it counts: where each begins, and the end


class Described(NamedTuple):
    """Description of a dataset: attributes `meaning`, `units` and `columns`, and the labels of its axes."""

    meaning: str
    units: str | tuple[str, ...] = PURE  # several: of each column
    axes: tuple[str, ...] = ()  # what each of its dimensions counts
    columns: tuple[str, ...] = ()  # names along the last axis
    in_space: Described | None = None  # what it holds in 3D, where that is something else
    spatial: bool = False  # whether it is there in 3D alone
    kind: str = NUMBERS
    counts: str = ""  # what its whole numbers are numbers of, as an axis is labelled; "": of nothing that is there
    least: int = 0  # the smallest of them
    optional: bool = False  # only where a case asks for it, or since some version

    def of(self, dimension: int) -> Described:
        """Return the description of the dataset in two or three dimensions."""
        if dimension != 3 or self.in_space is None:
            return self
        kept = {name: getattr(self, name) for name in ("kind", "counts", "least", "optional")}
        return self.in_space._replace(**kept)


class Group(NamedTuple):
    """Description of a group of results.h5: its datasets by name, and its attributes."""

    about: str
    datasets: Mapping[str, Described]
    attributes: Mapping[str, str] = {}  # "*": any other
    several: frozenset[str] = frozenset()  # attributes that hold several words; others hold one, or a whole number
    counted_by: str = ""  # the dataset that is written last and has a row for each that is whole; "": none
    optional: bool = False  # only where a case asks for it


def describe(dataset: h5py.Dataset, said: Described) -> None:
    """Write the description of a dataset as its attributes."""
    columns = said.columns[: dataset.shape[-1]] if dataset.shape else said.columns  # modes: as many as there are
    named = {"meaning": said.meaning, "units": said.units, "columns": columns, "DIMENSION_LABELS": said.axes}
    for name, words in named.items():  # the last one is HDF5's own
        if isinstance(words, str) or words:
            _say(dataset, name, words)


def _say(dataset: h5py.Dataset, name: str, words: str | tuple[str, ...]) -> None:
    """Write a text attribute, three times as fast as h5py's `attrs`, which looks for an old one first."""
    shape = () if isinstance(words, str) else (len(words),)
    attribute = h5a.create(dataset.id, name.encode(), _ON_DISK, h5s.create_simple(shape) if shape else _ONE)
    attribute.write(np.array(words, dtype=TEXT), mtype=_IN_MEMORY)


_BLOCK, _JOINT, _POINT = ("block",), ("joint",), ("contact point",)
_XYZ, _QUATERNION = ("x", "y", "z"), ("w", "x", "y", "z")
_MOVED, _MOVED_IN_SPACE = ("x", "y", "rotation"), (*_XYZ, "rotation x", "rotation y", "rotation z")


def _vector(meaning: str, units: str, axes: tuple[str, ...]) -> Described:
    """Describe a vector: two components in the plane, three in space."""
    return Described(meaning, units, axes, _XYZ[:2], Described(meaning, units, axes, _XYZ))


def _generalised(meaning: str, linear: str, angular: str, axes: tuple[str, ...]) -> Described:
    """Describe a generalised vector with a component for each degree of freedom of a block."""
    space = Described(meaning, (linear,) * 3 + (angular,) * 3, axes, _MOVED_IN_SPACE)
    return Described(meaning, (linear, linear, angular), axes, _MOVED, space)


def _of_stress(meaning: str, unit: str = "Pa") -> Described:
    """Describe the components of symmetric tensors of blocks, such as stresses."""
    axes = ("frame", "block", "component")
    space = Described(meaning, unit, axes, ("xx", "yy", "zz", "yz", "zx", "xy"))
    return Described(meaning, unit, axes, ("xx", "yy", "xy"), space, optional=True)


_BENDING = tuple(f"bending {k}" for k in range(1, 7))


def _of_modes(meaning: str, unit: str, axes: tuple[str, ...] = ("block", "mode")) -> Described:
    """Describe values with a component for each deformation mode of a block (core/model/uniform_strain.py)."""
    space = Described(meaning, unit, axes, ("even", "x - y", "x + y - 2 z", "yz", "zx", "xy"))
    return Described(meaning, unit, axes, ("even", "x - y", "xy", *_BENDING), space, optional=True)


_COMPONENT, _COORDINATE = ("block", "component"), ("block", "coordinate")
_INERTIA, _AXIS = "moment of inertia about the centroid", ("block", "axis")
MODEL = {
    "block_ids": Described(
        "name of each block, in the order of the case: structures, then blocks drawn by hand", WORDS, _BLOCK, kind=NAMES
    ),
    "material_names": Described("name of each material", WORDS, ("material",), kind=NAMES),
    "block_material": Described("material of each block, by its number", PURE, _BLOCK, kind=WHOLE, counts="material"),
    "fixed": Described("whether the block cannot move", PURE, _BLOCK, kind=TRUTHS),
    "thickness": Described(
        "depth out of plane", "m", _BLOCK, (), Described("1: the corners say how deep a block is", PURE, _BLOCK)
    ),
    "masses": Described("mass", "kg", _BLOCK),
    "inertias": Described(
        _INERTIA, "kg m2", _AXIS, ("z",), Described(f"principal {_INERTIA}", "kg m2", _AXIS, ("1", "2", "3"))
    ),
    "centroids": _vector("centroid where the structure was drawn", "m", _COORDINATE),
    "part_blocks": Described(
        "block that each convex part belongs to, by its number", PURE, ("part",), kind=WHOLE, counts="block"
    ),
    "part_starts": Described(
        "first corner of each convex part; they are counter-clockwise, and the last number is their count",
        PURE,
        ("part + 1",),
        (),
        Described("first corner of each convex part; the last number is their count", PURE, ("part + 1",)),
        kind=WHOLE,
        counts="corner",
    ),
    "vertices": _vector("corner from the centroid of its block, undeformed", "m", ("corner", "coordinate")),
    "dead_loads": _generalised("weight and dead point loads about the centroid", "N", "N m", _COMPONENT),
    "live_loads": _generalised("loads that the multiplier acts on, about the centroid", "N", "N m", _COMPONENT),
    "part_faces": Described(
        "first face of each convex part; the last number is their count",
        PURE,
        ("part + 1",),
        spatial=True,
        kind=WHOLE,
        counts="face",
    ),
    "face_starts": Described(
        "where the corners of each face begin in face_corners; the last number is their count",
        PURE,
        ("face + 1",),
        spatial=True,
        kind=WHOLE,
        counts="corner of a face",
    ),
    "face_corners": Described(
        "corners around each face, by their numbers; counter-clockwise seen from outside",
        PURE,
        ("corner of a face",),
        spatial=True,
        kind=WHOLE,
        counts="corner",
    ),
    "principal_axes": Described(
        "unit quaternion, scalar first, that turns vectors from the principal axes of a block to those of the world",
        PURE,
        _COMPONENT,
        _QUATERNION,
        spatial=True,
    ),
    "mode_stiffness": _of_modes("stiffness of each mode by which a block deforms; 0: a rigid block", "N/m"),
    "dead_mode_loads": _of_modes("what dead loads do to each mode by which a block deforms", "N"),
    "imposed_strains": Described(
        "strain in all directions that a block would have if nothing held it", PURE, _BLOCK, optional=True
    ),
    "mode_shapes": Described(
        "displacement by each quadratic mode, as coefficients of 1, x, y, x², x y, y² from the centroid; 2D, where "
        "blocks bend alone",
        "m, powers of it",
        ("block", "mode", "direction", "term"),
        optional=True,
    ),
    "live_mode_loads": _of_modes("what loads that the multiplier acts on do to each mode", "N"),
    "pieces": Described(
        "stone that each block is a piece of, and the joint within it, by their numbers; -1: a whole stone; where the "
        "case has stones that can crack alone",
        PURE,
        _COMPONENT,
        ("stone", "joint"),
        kind=WHOLE,
        least=-1,
        optional=True,
    ),
    "courses": Described(
        "course that each block is laid in and the row across it, by number; -1: in no course, row 0: all of them; "
        "where head joints are not like beds alone",
        PURE,
        _COMPONENT,
        ("course", "row"),
        kind=WHOLE,
        least=-1,
        optional=True,
    ),
    "restrained": Described(
        "whether each motion of the block is held; where the case has restraints alone",
        PURE,
        _COMPONENT,
        _MOVED,
        Described(
            "whether each motion of the block is held; where the case has restraints alone",
            PURE,
            _COMPONENT,
            _MOVED_IN_SPACE,
        ),
        kind=TRUTHS,
        optional=True,
    ),
}
TURNED = "angle that the block has turned by, counter-clockwise"
FRAMES = {
    "positions": _vector("centroid", "m", ("frame", "block", "coordinate")),
    "orientations": Described(
        TURNED, "rad", ("frame", "block", "axis"), ("z",),
        Described(
            "unit quaternion, scalar first, of how the block has turned since it was drawn",
            PURE, ("frame", "block", "component"), _QUATERNION,
        ),
    ),
    "velocities": _generalised(
        "velocity and spin: per second in a time history, else per solver step", *PER_SECOND,
        ("frame", "block", "component"),
    ),
    "stresses": _of_stress("stress of each block, in its own axes, tension positive; where blocks deform alone"),
    "first_moments": _of_stress(
        "symmetric part of the sum of f ⊗ x of loads at points, ties and bars about the centroid of their block, and "
        "in geometry of the start of contact forces, x their arm of the start less that in the frame; where there are "
        "such loads, ties or bars alone", "N m",
    ),
    "step": Described("solver steps so far", PURE, ("frame",), kind=WHOLE),
    "load": Described("load multiplier λ", PURE, ("frame",)),
    "displacement": Described("control displacement: the largest of any block since the start", "m", ("frame",)),
    "time": Described("time since the start of a time history; 0 in other analyses", "s", ("frame",), optional=True),
    "stage": Described(
        "stage of the analysis: index into the attribute `stages` of /dem", PURE, ("frame",), kind=WHOLE, counts="stage"
    ),
    "n_contacts": Described(
        "how many rows of /dem/contacts are of this frame; they follow each other", PURE, ("frame",), kind=WHOLE
    ),
}  # fmt: skip
PER_STEP_FRAMES = FRAMES | {
    "velocities": _generalised(FRAMES["velocities"].meaning, *PER_STEP, FRAMES["velocities"].axes)
}
_STATES = "0 open, 1 sticking, 2 sliding: index into the attribute `states` of /dem"
_PLACE, _SHEAR = ("contact point", "coordinate"), ("contact point", "tangent")
CONTACTS = {
    "joint": Described(
        "joint that owns the point; numbered anew whenever joints are found anew", PURE, _POINT, kind=WHOLE
    ),
    "blocks": Described(
        "the two blocks, by their numbers", PURE, ("contact point", "side"), ("a", "b"), kind=WHOLE, counts="block"
    ),
    "points": Described(
        "where the force acts", "m", _PLACE, _XYZ[:2],
        Described("where the force acts; it goes along with block a", "m", _PLACE, _XYZ),
    ),
    "normals": _vector("unit vector from block a to block b", PURE, _PLACE),
    "normal_force": Described("normal force, compression positive", "N", _POINT),
    "shear_force": Described(
        "shear force on block b along the tangent, the normal turned by +90°", "N", _SHEAR, ("t",),
        Described("shear force on block b along `tangents` and normal × tangent", "N", _SHEAR, ("t1", "t2")),
    ),
    "gap": Described("distance of the faces, positive open", "m", _POINT),
    "slip": Described("length of the path of slip so far", "m", _POINT),
    "state": Described(_STATES, PURE, _POINT, kind=WHOLE, counts="state"),
    "tangents": Described(
        "unit vector of the first tangent, square to the normal; the second one is normal × tangent",
        PURE, _PLACE, _XYZ, spatial=True,
    ),
}  # fmt: skip
_END = ("joint", "end", "coordinate")
JOINT_PLACES = {
    "blocks": Described(
        "the two blocks, by their numbers", PURE, ("joint", "side"), ("a", "b"), kind=WHOLE, counts="block"
    ),
    "ends": Described(
        "where the joint begins and ends on block a, as drawn", "m", _END, _XYZ[:2],
        Described("the two corners of the joint on block a that are furthest apart, as drawn", "m", _END, _XYZ),
    ),
    "normals": _vector("unit vector from block a to block b, as drawn", PURE, ("joint", "coordinate")),
    "length": Described("length of the joint as drawn", "m", _JOINT, (), Described("between `ends`", "m", _JOINT)),
    "area": Described(
        "length times the smaller thickness of both blocks", "m2", _JOINT, (),
        Described("area of the overlap as drawn; of lone edges and corners what they stand for", "m2", _JOINT),
    ),
    "starts": Described(
        "first corner of each joint; the last number is their count", PURE, ("joint + 1",), spatial=True,
        kind=WHOLE, counts="corner of a joint",
    ),
    "corners": Described(
        "corners around each joint on block a, as drawn, counter-clockwise seen from block b; two of an edge, one of a "
        "corner", "m", ("corner of a joint", "coordinate"), _XYZ, spatial=True,
    ),
}  # fmt: skip
_STATE = ("frame", "joint")
JOINT_STATES = {
    "opening": Described(
        "mean distance of its two ends across the joint, positive open", "m", _STATE, (),
        Described("mean distance across the joint, positive open", "m", _STATE),
    ),
    "crack_width": Described(
        "how far its wider end has opened since it was drawn; 0 where none has", "m", _STATE, (),
        Described("how far its widest corner has opened since it was drawn; 0 where none has", "m", _STATE),
    ),
    "slip": Described(
        "how far the middle of b has slid on a along the tangent, the normal turned by +90°", "m", _STATE, (),
        Described("how far the middle of b has slid on a", "m", _STATE),
    ),
    "normal_stress": Described("normal force over area, compression positive", "Pa", _STATE),
    "shear_stress": Described(
        "shear force on b along the tangent over area", "Pa", _STATE, (),
        Described("shear force over area", "Pa", _STATE),
    ),
    "eccentricity": Described(
        "how far the normal force acts from the middle, along the tangent; 0 without a force", "m", _STATE, (),
        Described("how far the normal force acts from the middle; 0 without a force", "m", _STATE),
    ),
    "state": Described(_STATES, PURE, _STATE, kind=WHOLE, counts="state"),
}  # fmt: skip
_LINK_POINT = ("point of a link",)
LINKS = {
    "starts": Described(
        "first point of each tie or bar; the last number is their count", PURE, ("link + 1",), kind=WHOLE,
        counts="point of a link",
    ),
    "blocks": Described(
        "block that takes each point along; −1: none", PURE, _LINK_POINT, kind=WHOLE, counts="block", least=-1
    ),
    "arms": _vector(
        "point from the centroid of its block, as drawn; of no block from the origin", "m",
        ("point of a link", "coordinate"),
    ),
    "forces": Described("axial force at each point, tension positive", "N", ("frame", "point of a link")),
}  # fmt: skip
_ROW = ("row",)
HISTORY = {
    "step": Described("solver steps so far", PURE, _ROW, kind=WHOLE),
    "load": Described("load multiplier λ", PURE, _ROW),
    "displacement": Described("control displacement: the largest of any block since the start", "m", _ROW),
    "unbalanced": Described("largest unbalanced force on a block over its own weight", PURE, _ROW),
    "overlap": Described("largest overlap of two blocks", "m", _ROW),
    "time": Described("time since the start of a time history; 0 in other analyses", "s", _ROW, optional=True),
    "live_displacement": Described(
        "displacement of the live load along itself since the structure rested under dead loads: of one force that of "
        "its point, of several the mean by their size, positive along them; 0 without a live load",
        "m",
        _ROW,
        optional=True,
    ),
    "monitor_values": Described(
        "value of each [[monitor]]; `columns` names them, `units` has one for each", (), ("row", "monitor")
    ),
    "stage": Described(
        "stage of the analysis: index into the attribute `stages` of /dem", PURE, _ROW, kind=WHOLE, counts="stage"
    ),
}
ENERGY = {
    "kinetic": Described("kinetic energy", "J", _ROW),
    "elastic": Described("energy in the springs of the joints", "J", _ROW),
    "gravity": Described("potential energy of the weights, since the start", "J", _ROW),
    "external": Described("work of the loads but gravity, and of the base, since the start", "J", _ROW),
    "friction": Described("lost to friction and to damage of joints, since the start", "J", _ROW),
    "damping": Described("lost to local and numerical damping, since the start", "J", _ROW),
    "supports": Described("work done by supports that are moved, since the start", "J", _ROW),
    "dashpots": Described("lost to viscous joints, since the start", "J", _ROW, optional=True),
    "mass_damping": Described("lost to damping by mass, since the start", "J", _ROW, optional=True),
    "maxwell": Described("lost to Maxwell elements of joints, since the start", "J", _ROW, optional=True),
    "reweighting": Described(
        "gone with the areas of contact points that change where blocks move in 3D, net since the start; minus: made",
        "J",
        _ROW,
        optional=True,
    ),
}
_FACTORS = Described(
    "what dead and live loads are multiplied by; their ratio is λ", PURE, ("factor",), ("dead", "live")
)
_PLACED = ("x", "y", "rotation"), (*_XYZ, *_QUATERNION)
_ON_PLANE = ("x", "y", "normal x", "normal y", "normal force", "shear force", "friction")
_IN_SPACE = (
    *_XYZ, *(f"normal {axis}" for axis in _XYZ), *(f"tangent {axis}" for axis in _XYZ), "normal force",
    "shear force 1", "shear force 2", "friction",
)  # fmt: skip


def _placed(meaning: str, axes: tuple[str, ...]) -> Described:
    """Describe places of blocks: centroid, then angle or quaternion."""
    space = Described(meaning, ("m",) * 3 + (PURE,) * 4, axes, _PLACED[1], optional=True)
    return Described(meaning, ("m", "m", "rad"), axes, _PLACED[0], space, optional=True)


def _certified_points(meaning: str, axis: str) -> Described:
    """Describe contact points with their forces on the second block, and their friction coefficient."""
    units, space = ("m",) * 2 + (PURE,) * 2 + ("N",) * 2 + (PURE,), ("m",) * 3 + (PURE,) * 6 + ("N",) * 3 + (PURE,)
    found = Described(meaning, space, (axis, "component"), _IN_SPACE)
    return Described(meaning, units, (axis, "component"), _ON_PLANE, found, optional=True)


def _certified_blocks(axis: str) -> Described:
    """Describe the two blocks of contact points."""
    meaning = "the two blocks, by their numbers"
    return Described(meaning, PURE, (axis, "side"), ("a", "b"), kind=WHOLE, counts="block", optional=True)


_HELD, _BOUND = "standing point", "mechanism point"
_RATES = "mechanism: rates of all blocks, whose live power is one"
CERTIFICATES = {
    "standing_factors": _FACTORS._replace(optional=True),
    "standing_places": _placed("where the blocks are at the highest load held at rest", ("block", "component")),
    "standing_blocks": _certified_blocks(_HELD),
    "standing_contacts": _certified_points("contact points that press at the highest load held at rest", _HELD),
    "mechanism_bounds": Described(
        "load multiplier in equilibrium with mechanism_contacts, and that above which the mechanism gains power",
        PURE, ("bound",), ("equilibrium", "mechanism"), optional=True,
    ),
    "mechanism_rates": _generalised(_RATES, "m/(N m)", "rad/(N m)", ("block", "component"))._replace(optional=True),
    "mechanism_blocks": _certified_blocks(_BOUND),
    "mechanism_contacts": _certified_points("contact points as drawn, with forces at the bound", _BOUND),
    "failing_factors": _FACTORS._replace(optional=True),
    "failing_places": _placed(
        "where the blocks are before and during the motion that shows a failure", ("instant", "block", "component")
    ),
    "failing_energies": Described(
        "energies since the start at both instants", "J", ("instant", "energy"),
        ("work of the loads", "friction", "elastic", "kinetic"), optional=True,
    ),
}  # fmt: skip
_SAMPLE = ("sample", "coordinate")
SERIES = {
    "base_acceleration": _vector("acceleration of the base", "m/s2", _SAMPLE),
    "base_velocity": _vector("velocity of the base", "m/s", _SAMPLE),
    "base_displacement": _vector("displacement of the base", "m", _SAMPLE),
    "monitors": Described(
        "value of each [[monitor]]; `columns` names them, `units` has one for each", (), ("sample", "monitor")
    ),
    "time": Described("time since the start", "s", ("sample",)),
}
DEM = {"case": Described("the case as it was run, defaults filled in: TOML", WORDS, kind=NAMES)}
GROUPS = {  # of results.h5
    "/dem": Group(
        "everything, in double precision",
        DEM,
        {
            "format": "number of this layout; a reader takes its own and refuses others",
            "kind": "kind of the analysis",
            "status": "how the run ended, as in summary.json; “running” until then",
            "stages": "names of the stages, in the order of their numbers",
            "states": "names of the states of a joint, in the order of their numbers",
        },
        frozenset(("stages", "states")),
    ),
    "/dem/provenance": Group(
        "what it was computed with",
        {},
        {
            "dem": "version of dem",
            "python": "version of Python",
            "machine": "kind of processor",
            "*": "version of each package that computed: numpy, numba, ...",
        },
    ),
    "/dem/model": Group(
        "the structure as it was drawn",
        MODEL,
        {"dimension": "2: x to the right, y upwards; 3: x and y horizontal, z upwards"},
    ),
    "/dem/frames": Group(
        "snapshots: as many as `output.frames` asks for, or as the motion of a time history needs",
        FRAMES,
        counted_by="n_contacts",
    ),
    "/dem/contacts": Group("contact points of all frames, one frame after the other", CONTACTS),
    "/dem/joints": Group(
        "joints as they were drawn, and the state of each at every frame; blocks that come to touch later have contact "
        "points, but no joint",
        JOINT_PLACES | JOINT_STATES,
        optional=True,
    ),
    "/dem/links": Group(
        "ties and bars, where there are any: lines through points of blocks, and the forces in them at every frame",
        LINKS,
        {"names": "name of each tie and bar", "kinds": "table of the case that each was drawn in"},
        frozenset(("names", "kinds")),
        optional=True,
    ),
    "/dem/history": Group(
        "states that the solver reported",
        HISTORY,
        {"monitors": "names of the [[monitor]] tables"},
        frozenset(("monitors",)),
        counted_by="stage",
    ),
    "/dem/history/energy": Group("the energy ledger, a value per row of the history", ENERGY, optional=True),
    "/dem/certificates": Group(
        "of static pushovers: arrays with which others check what the run claims",
        CERTIFICATES,
        {
            "stands": "what the forces of standing_contacts certify, or “none: ” and why",
            "impossible": "what mechanism_rates certify, or “none: ” and why",
            "fails": "what failing_places certify, or “none: ” and why",
            "unique": "what is certified about other loads, or “none: ” and why",
        },
        optional=True,
    ),
    "/dem/series": Group(
        "of time histories: motion of the base and monitors at an even rate",
        SERIES,
        {"monitors": "names of the [[monitor]] tables", "quantities": "what each of them follows"},
        frozenset(("monitors", "quantities")),
        counted_by="time",
        optional=True,
    ),
}


def declared(table: Mapping[str, Described], dimension: int) -> dict[str, Described]:
    """Return the descriptions of the datasets of a group in two or three dimensions."""
    return {name: said.of(dimension) for name, said in table.items() if dimension == 3 or not said.spatial}


def units_of(table: Mapping[str, Described]) -> dict[str, str]:
    """Return the units of the datasets that have one, by name."""
    units = {name: said.units for name, said in table.items()}
    return {name: unit for name, unit in units.items() if isinstance(unit, str) and unit not in (PURE, WORDS)}
