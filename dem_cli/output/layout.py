"""Layout of results.h5 and of the files for ParaView: meaning, units, axes and columns of every dataset and attribute.

Whoever writes a dataset takes its attributes from here and can write no other; docs/results.md is made of the same
declarations (scripts/docs --write).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import h5py

PURE, WORDS = "1", ""  # units of pure numbers, counts and numbers of things; of text
_XY = ("x", "y")
PER_SECOND, PER_STEP = ("m/s", "m/s", "rad/s"), ("m/step", "m/step", "rad/step")
TEXT = h5py.string_dtype()


class Described(NamedTuple):
    """What a dataset holds: attributes `meaning`, `units` and `columns`, and the labels of its axes."""

    meaning: str
    units: str | tuple[str, ...] = PURE  # several: of each column
    axes: tuple[str, ...] = ()  # what each of its dimensions counts
    columns: tuple[str, ...] = ()  # names along the last axis


class Group(NamedTuple):
    """What a group of results.h5 is, its datasets by name, and the meaning of its attributes."""

    about: str
    datasets: Mapping[str, Described]
    attributes: Mapping[str, str] = {}  # "*": any other


def describe(dataset: h5py.Dataset, said: Described) -> None:
    """Write what a dataset holds as its attributes."""
    named = {"units": said.units, "columns": said.columns, "DIMENSION_LABELS": said.axes}  # the last one is HDF5's own
    dataset.attrs.create("meaning", said.meaning, dtype=TEXT)
    for name, words in named.items():
        if isinstance(words, str):
            dataset.attrs.create(name, words, dtype=TEXT)
        elif words:
            dataset.attrs.create(name, list(words), dtype=TEXT)


_BLOCK, _JOINT, _POINT = ("block",), ("joint",), ("contact point",)
_MOVED = ("x", "y", "rotation")
MODEL = {
    "block_ids": Described("name of each block", WORDS, _BLOCK),
    "material_names": Described("name of each material", WORDS, ("material",)),
    "block_material": Described("material of each block, by its number", PURE, _BLOCK),
    "fixed": Described("whether the block cannot move", PURE, _BLOCK),
    "thickness": Described("depth out of plane", "m", _BLOCK),
    "masses": Described("mass", "kg", _BLOCK),
    "inertias": Described("moment of inertia about the centroid", "kg m2", ("block", "axis"), ("z",)),
    "centroids": Described("centroid where the structure was drawn", "m", ("block", "coordinate"), _XY),
    "part_blocks": Described("block that each convex part belongs to, by its number", PURE, ("part",)),
    "part_starts": Described(
        "first corner of each convex part; they are counter-clockwise, and the last number is their count",
        PURE,
        ("part + 1",),
    ),
    "vertices": Described("corner from the centroid of its block, undeformed", "m", ("corner", "coordinate"), _XY),
    "dead_loads": Described(
        "weight and dead point loads about the centroid", ("N", "N", "N m"), ("block", "component"), _MOVED
    ),
    "live_loads": Described(
        "loads that the multiplier acts on, about the centroid", ("N", "N", "N m"), ("block", "component"), _MOVED
    ),
}
FRAMES = {
    "positions": Described("centroid", "m", ("frame", "block", "coordinate"), _XY),
    "orientations": Described(
        "angle that the block has turned by, counter-clockwise", "rad", ("frame", "block", "axis"), ("z",)
    ),
    "velocities": Described(
        "velocity and spin: per second in a time history, else per solver step",
        PER_SECOND,
        ("frame", "block", "component"),
        _MOVED,
    ),
    "step": Described("solver steps so far", PURE, ("frame",)),
    "load": Described("load multiplier λ", PURE, ("frame",)),
    "displacement": Described("control displacement: the largest of any block since the start", "m", ("frame",)),
    "time": Described("time since the start of a time history; 0 in other analyses", "s", ("frame",)),
    "stage": Described("stage of the analysis: index into the attribute `stages` of /dem", PURE, ("frame",)),
    "n_contacts": Described(
        "how many rows of /dem/contacts are of this frame; they follow each other", PURE, ("frame",)
    ),
}
CONTACTS = {
    "joint": Described("joint that owns the point; numbered anew whenever joints are found anew", PURE, _POINT),
    "blocks": Described("the two blocks, by their numbers", PURE, ("contact point", "side"), ("a", "b")),
    "points": Described("where the force acts", "m", ("contact point", "coordinate"), _XY),
    "normals": Described("unit vector from block a to block b", PURE, ("contact point", "coordinate"), _XY),
    "normal_force": Described("normal force, compression positive", "N", _POINT),
    "shear_force": Described(
        "shear force on block b along the tangent, the normal turned by +90°", "N", ("contact point", "tangent"), ("t",)
    ),
    "gap": Described("distance of the faces, positive open", "m", _POINT),
    "slip": Described("length of the path of slip so far", "m", _POINT),
    "state": Described("0 open, 1 sticking, 2 sliding: index into the attribute `states` of /dem", PURE, _POINT),
}
JOINT_PLACES = {
    "blocks": Described("the two blocks, by their numbers", PURE, ("joint", "side"), ("a", "b")),
    "ends": Described("where the joint begins and ends on block a, as drawn", "m", ("joint", "end", "coordinate"), _XY),
    "normals": Described("unit vector from block a to block b, as drawn", PURE, ("joint", "coordinate"), _XY),
    "length": Described("length of the joint as drawn", "m", _JOINT),
    "area": Described("length times the smaller thickness of both blocks", "m2", _JOINT),
}
_STATE = ("frame", "joint")
JOINT_STATES = {
    "opening": Described("mean distance of its two ends across the joint, positive open", "m", _STATE),
    "crack_width": Described("distance of its wider end across the joint; 0 where none is open", "m", _STATE),
    "slip": Described(
        "how far the middle of b has slid on a along the tangent, the normal turned by +90°", "m", _STATE
    ),
    "normal_stress": Described("normal force over area, compression positive", "Pa", _STATE),
    "shear_stress": Described("shear force on b along the tangent over area", "Pa", _STATE),
    "eccentricity": Described(
        "how far the normal force acts from the middle, along the tangent; 0 without a force", "m", _STATE
    ),
    "state": Described("0 open, 1 sticking, 2 sliding: index into the attribute `states` of /dem", PURE, _STATE),
}
_ROW = ("row",)
HISTORY = {
    "step": Described("solver steps so far", PURE, _ROW),
    "load": Described("load multiplier λ", PURE, _ROW),
    "displacement": Described("control displacement: the largest of any block since the start", "m", _ROW),
    "unbalanced": Described("largest unbalanced force on a block over its own weight", PURE, _ROW),
    "overlap": Described("largest overlap of two blocks", "m", _ROW),
    "time": Described("time since the start of a time history; 0 in other analyses", "s", _ROW),
    "monitor_values": Described(
        "value of each [[monitor]]; `columns` names them, `units` has one for each", (), ("row", "monitor")
    ),
    "stage": Described("stage of the analysis: index into the attribute `stages` of /dem", PURE, _ROW),
}
ENERGY = {
    "kinetic": Described("kinetic energy", "J", _ROW),
    "elastic": Described("energy in the springs of the joints", "J", _ROW),
    "gravity": Described("potential energy of the weights, since the start", "J", _ROW),
    "external": Described("work of the loads but gravity, and of the base, since the start", "J", _ROW),
    "friction": Described("lost to friction and to damage of joints, since the start", "J", _ROW),
    "damping": Described("lost to local and numerical damping, since the start", "J", _ROW),
    "supports": Described("work done by supports that are moved, since the start", "J", _ROW),
    "dashpots": Described("lost to viscous joints, since the start", "J", _ROW),
    "mass_damping": Described("lost to damping by mass, since the start", "J", _ROW),
    "maxwell": Described("lost to Maxwell elements of joints, since the start", "J", _ROW),
}
_SAMPLE = ("sample", "coordinate")
SERIES = {
    "base_acceleration": Described("acceleration of the base", "m/s2", _SAMPLE, _XY),
    "base_velocity": Described("velocity of the base", "m/s", _SAMPLE, _XY),
    "base_displacement": Described("displacement of the base", "m", _SAMPLE, _XY),
    "monitors": Described(
        "value of each [[monitor]]; `columns` names them, `units` has one for each", (), ("sample", "monitor")
    ),
    "time": Described("time since the start", "s", ("sample",)),
}
DEM = {"case": Described("the case as it was run, defaults filled in: TOML", WORDS)}
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
    "/dem/model": Group("the structure as it was drawn", MODEL, {"dimension": "2: x to the right, y upwards"}),
    "/dem/frames": Group(
        "snapshots: as many as `output.frames` asks for, or as the motion of a time history needs", FRAMES
    ),
    "/dem/contacts": Group("contact points of all frames, one frame after the other", CONTACTS),
    "/dem/joints": Group(
        "joints as they were drawn, and the state of each at every frame; blocks that come to touch later have contact "
        "points, but no joint",
        JOINT_PLACES | JOINT_STATES,
    ),
    "/dem/history": Group("states that the solver reported", HISTORY, {"monitors": "names of the [[monitor]] tables"}),
    "/dem/history/energy": Group("the energy ledger, a value per row of the history", ENERGY),
    "/dem/series": Group(
        "of time histories: motion of the base and monitors at an even rate",
        SERIES,
        {"monitors": "names of the [[monitor]] tables", "quantities": "what each of them follows"},
    ),
}

# Fields for ParaView, float32 or whole numbers.
BLOCK_FIELDS = {
    "PointData/displacement": Described("displacement of a corner since the start", "m"),
    "PointData/velocity": Described("velocity of a corner: m/s in a time history, else per solver step", "m/s"),
    "CellData/block_id": Described("number of the block"),
    "CellData/material": Described("number of its material"),
    "CellData/fixed": Described("1: the block cannot move"),
    "CellData/rotation": Described("angle that the block has turned by, counter-clockwise", "rad"),
}
CONTACT_FIELDS = {
    "PointData/joint": CONTACTS["joint"],
    "PointData/block_a": Described("number of the first block"),
    "PointData/block_b": Described("number of the second block"),
    "PointData/normal": CONTACTS["normals"],
    "PointData/force": Described("force on block b", "N"),
    "PointData/normal_force": CONTACTS["normal_force"],
    "PointData/shear_force": CONTACTS["shear_force"],
    "PointData/gap": CONTACTS["gap"],
    "PointData/slip": CONTACTS["slip"],
    "PointData/state": Described("0 open, 1 sticking, 2 sliding"),
}
JOINT_FIELDS = {
    "PointData/gap": Described("distance across the joint at this end, positive open", "m"),
    "CellData/block_a": Described("number of the first block"),
    "CellData/block_b": Described("number of the second block"),
    "CellData/area": JOINT_PLACES["area"],
    **{f"CellData/{name}": said for name, said in JOINT_STATES.items() if name != "state"},
    "CellData/state": Described("0 open, 1 sticking, 2 sliding"),
}
STEP_FIELDS = {
    "FieldData/load_multiplier": Described("load multiplier λ"),
    "FieldData/control_displacement": Described("largest displacement of any block since the start", "m"),
    "FieldData/stage": FRAMES["stage"],
    "FieldData/step": Described("solver steps so far"),
    "FieldData/time": Described("time since the start of a time history", "s"),
}
VTK_FILES = {  # what each shows, and its fields
    "blocks.vtkhdf": ("blocks, as cells whose corners move", BLOCK_FIELDS),
    "contacts.vtkhdf": ("contact points with their forces", CONTACT_FIELDS),
    "joints.vtkhdf": ("joints as they were drawn, as lines that move with the blocks", JOINT_FIELDS),
}


def units_of(declared: dict[str, Described]) -> dict[str, str]:
    """Units of what has one, by name."""
    units = {name: said.units for name, said in declared.items()}
    return {name: unit for name, unit in units.items() if isinstance(unit, str) and unit not in (PURE, WORDS)}
