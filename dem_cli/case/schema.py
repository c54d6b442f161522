"""Tables of a case file, in SI units; degrees only where a key says `_deg`.

Which structures, joint laws and analyses exist is handed in (`case_model`): this package knows no registry.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from functools import reduce
from operator import or_
from types import GenericAlias
from typing import Annotated, Any, ClassVar, Literal, cast, get_args

from pydantic import BeforeValidator, Field, create_model, model_validator

from dem_cli.case.base import (
    CaseModel,
    KeyProblem,
    Name,
    NonNegative,
    OneOrMoreSchema,
    Positive,
    StructureBase,
    Turn,
    Vector,
    one_or_more,
    sequence_of,
)
from dem_cli.case.block_table import BlockTable
from dem_cli.case.cross_references import OF_CUTS, REACTIONS
from dem_cli.case.dimensions import in_space
from dem_cli.case.imperfection import Imperfection
from dem_cli.case.load_tables import Fill, GroundTable, Load, Pressure, Restraint
from dem_cli.case.reference import BLIND, Alternative, Prediction, Reference
from dem_cli.case.selection import GroupMembers, Selection
from dem_cli.case.sweep import Sweep
from dem_cli.input_limits import MOST_FRAMES, MOST_TABLES


class Material(CaseModel):
    """[materials.NAME]"""

    density: Positive = Field(description="mass per volume [kg/m3]", examples=[2400.0])
    young: Positive | None = Field(
        default=None, description="Young's modulus [Pa] of blocks that deform; default: they are rigid", examples=[5e9]
    )
    poisson: Annotated[float, Field(ge=0.0, lt=0.5)] = Field(
        default=0.2, description="Poisson's ratio of blocks that deform [-]", examples=[0.2]
    )
    deformation: Literal["joints", "uniform-strain", "quadratic", "none"] | None = Field(
        default=None,
        description="how blocks deform: 'joints' lumps half of each block into the joints on it, 'uniform-strain' "
        "gives each block one strain of its own, linear elastic (in 2D in plane stress), 'quadratic' lets "
        "it bend and bulge as well (2D), 'none' keeps blocks rigid; "
        "default: joints where young is given. Fixed blocks do not deform",
        examples=["joints"],
    )

    @model_validator(mode="after")
    def _deforms_by_its_modulus(self) -> Material:
        if self.deformation in ("joints", "uniform-strain", "quadratic") and self.young is None:
            message = f"'{self.deformation}' is not allowed without 'young', Young's modulus [Pa]"
            raise KeyProblem(message, "deformation")
        return self

    @property
    def moduli(self) -> tuple[float, float]:
        """Young's and shear modulus, E and G = E / 2(1 + ν), of blocks that deform in their joints [Pa]; infinite if
        rigid.
        """
        if self.young is None or self.deformation not in (None, "joints"):
            return math.inf, math.inf
        return self.young, self.young / (2.0 * (1.0 + self.poisson))

    @property
    def strains(self) -> bool:
        """Tell whether the blocks deform with a uniform or quadratic strain."""
        return self.deformation in ("uniform-strain", "quadratic")

    @property
    def bends(self) -> bool:
        """Tell whether the blocks deform with a quadratic displacement field, which includes bending."""
        return self.deformation == "quadratic"


class Interface(CaseModel):
    """[[interface]]: the joint between two materials, instead of the first one in [joints]."""

    between: tuple[str, str] = Field(description="two names in [materials]", examples=[["stone", "wood"]])
    joint: str = Field(description="a name in [joints]", examples=["seat"])


class ImposedStrain(Selection):
    """[[strain]]: imposed strain of blocks, free of stress: warming, swelling, drying; several add up."""

    value: Annotated[float, Field(ge=-0.05, le=0.05)] = Field(
        description="strain in all directions, positive: longer; of warming: coefficient of expansion × degrees, of "
        "drying: minus the shrinkage [-]",
        examples=[-2e-4],
    )


class Settlement(Selection):
    """[[settlement]]: imposed movement of supports; those of a structure, a pattern or a group as one rigid body."""

    displacement: Vector = Field(
        default=(0.0, 0.0), description="how far the centroid moves [m]", examples=[[0.01, -0.02]]
    )
    rotation_deg: Turn = Field(
        default=0.0,
        description="turn about the centroid, of several supports their common one, counter-clockwise; in 3D axis "
        "times angle, in components along x, y and z, right-handed [deg]",
        examples=[1.0],
    )

    @property
    def rotation(self) -> tuple[float, ...]:
        """Rotation about the centroid [rad]: counter-clockwise in the plane, in space axis times angle."""
        degrees = self.rotation_deg if isinstance(self.rotation_deg, tuple) else (self.rotation_deg,)
        return tuple(math.radians(angle) for angle in degrees)


DEFAULT_LAW, DEFAULT_ANALYSIS = "coulomb", "pushover"  # of tables that do not say
PLACES = ("block", "structure", "point", "between", "cut", "tie", "bar")  # where a monitor may be
OF_LINKS = {"tie": ("force", "elongation"), "bar": ("force", "slip")}
AT_JOINTS = ("opening", "slip")
DRIFT = "drift"  # of a cut
OF_POINTS = ("displacement", "velocity", "acceleration")
VECTORS = (*OF_POINTS, "rotation", *REACTIONS)  # what has components


class Monitor(Selection):
    """[[monitor]]: a number followed through the run; of several blocks the mean, weighted by their masses."""

    needs_blocks: ClassVar[bool] = False

    name: Name | None = Field(
        default=None, description="label; default: made of place, quantity and component", examples=["top"]
    )
    block: str | None = Field(
        default=None,
        description="id of a block, a pattern of ids with * and ?, or a name in [groups]: the centroid is followed",
        examples=["top-right"],
    )
    point: Vector | None = Field(
        default=None, description="instead of block: a point of the undeformed structure [m]", examples=[[0.0, 1.9]]
    )
    between: tuple[str, str] | None = Field(
        default=None,
        description="for opening and slip: ids of two blocks that share a joint at the start",
        examples=[["arch-3", "arch-4"]],
    )
    cut: Annotated[tuple[Vector, ...], Field(min_length=2)] | None = Field(
        default=None,
        description="for forces in a pier or spandrel, and its drift: a line across it from A to B, in 3D the corners "
        "of a plane polygon [m]; the part beyond is to the left of the line, or where the corners are seen "
        "counter-clockwise from",
        examples=[[[0.0, 1.0], [1.2, 1.0]]],
    )
    height: Positive | None = Field(
        default=None,
        description="for the drift of a cut: height of the pier, half of it to either side of the cut [m]",
        examples=[2.0],
    )
    tie: str | None = Field(default=None, description="for force and elongation: id of a [[tie]]", examples=["north"])
    bar: str | None = Field(
        default=None, description="for force and slip: id of a [[reinforcement]], with at", examples=["corner-1"]
    )
    at: NonNegative | None = Field(
        default=None, description="of a bar: how far along it from its start [m]", examples=[0.6]
    )
    quantity: Literal[
        "displacement",
        "rotation",
        "velocity",
        "acceleration",
        "opening",
        "slip",
        "force",
        "elongation",
        "reaction",
        "reaction_moment",
        "normal_force",
        "shear_force",
        "moment",
        "shear_force_across",
        "moment_across",
        "torsion",
        "drift",
    ] = Field(
        default="displacement",
        description="what is followed: displacement [m], rotation [rad], velocity [m/s] or acceleration [m/s2]; of "
        "a joint: opening [m] (largest separation of its two ends, in 3D of its corners, negative: pressed) or slip "
        "[m] of the second block against the first, at the middle, along the normal turned by +90°; in 3D its length; "
        "of a tie: force [N], tension positive, or elongation [m] since it was drawn; of a bar: force, or slip [m] "
        "along it against its block; of blocks that are fixed or have a [[restraint]], in analyses without time: "
        "reaction [N], what holds them gives to all of them together, or its reaction_moment [N m] about their common "
        "centroid, where that is then; of a cut, but in modes, what the part beyond it gives to the other: "
        "normal_force [N], compression positive, shear_force [N] along the line or first side, and moment [N m], "
        "positive where it presses the end of the line: normal force times eccentricity; in 3D also "
        "shear_force_across and moment_across, along the normal × the first side, and torsion about the normal; of a "
        "cut with its height, in all analyses: drift [rad], the displacement along the line between both ends of the "
        "height, over it",
        examples=["rotation"],
    )
    component: Literal["x", "y", "z"] | None = Field(
        default=None, description="of the vector, in 3D also of the rotation; default: its length", examples=["x"]
    )
    absolute: bool = Field(
        default=False,
        description="true: with the motion of the base; false: relative to the base that moves",
        examples=[True],
    )

    @model_validator(mode="after")
    def _one_place(self) -> Monitor:
        given = [key for key in PLACES if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(f"'{key}'" for key in given) + " are" if given else "none of them is"
            listed = ", ".join(f"'{key}'" for key in PLACES[:-1])
            raise ValueError(f"{found} given; a monitor has one of {listed} and '{PLACES[-1]}'")
        if (self.at is None) == (self.bar is not None):
            raise KeyProblem("missing; how far along the bar [m]" if self.bar else "not used without bar", "at")
        allowed = {"between": AT_JOINTS, **OF_LINKS, "point": (*OF_POINTS, "rotation"), "cut": (*OF_CUTS, DRIFT)}.get(
            given[0], VECTORS
        )
        if self.quantity not in allowed:
            where = "'between' two blocks" if self.between is not None else f"a {given[0]}"
            listed = ", ".join(f"'{name}'" for name in allowed)
            raise KeyProblem(f"'{self.quantity}' is not allowed of {where}; must be one of {listed}", "quantity")
        if (self.height is None) == (self.quantity == DRIFT):
            raise KeyProblem("missing; the height of the pier [m]" if self.cut else "not used without drift", "height")
        if self.quantity not in VECTORS and self.component is not None:
            article = "an" if self.quantity[0] in "aeiou" else "a"
            raise KeyProblem(
                f"'{self.component}' is not allowed; {article} {self.quantity} has no component", "component"
            )
        if self.quantity not in OF_POINTS and self.absolute:
            listed = ", ".join(f"'{name}'" for name in OF_POINTS)
            raise KeyProblem(f"true is not allowed; only {listed} are absolute or relative to the base", "absolute")
        return self

    @property
    def of_what_holds(self) -> bool:
        """Tell whether the monitor records a reaction of fixed or restrained blocks."""
        return self.quantity in REACTIONS

    @property
    def place(self) -> str:
        """Location of the monitor in words: block, joint, cut or tie."""
        if self.between is not None:
            return " | ".join(self.between)
        if self.cut is not None:
            return f"cut {' '.join(_point(corner) for corner in self.cut)}"
        if self.tie is not None:
            return self.tie
        if self.bar is not None:
            return f"{self.bar} at {self.at:g}"
        return self.selected or _point(self.point or ())


def _point(point: tuple[float, ...]) -> str:
    """Format a point: (0.5, 2)."""
    return f"({', '.join(f'{x:g}' for x in point)})"


class Output(CaseModel):
    """[output]"""

    frames: Annotated[int, Field(ge=0, le=MOST_FRAMES)] | None = Field(
        default=None,
        description="snapshots kept; 0 for none; default: 20, of time histories as many as show the motion",
        examples=[60],
    )
    rate: Positive = Field(default=200.0, description="samples of the monitors per second, in time histories [1/s]")

    @property
    def snapshots(self) -> int:
        """Number of snapshots kept where the analysis sets no other default."""
        return 20 if self.frames is None else self.frames


class ProgramStamp(CaseModel):
    """[dem]: put into the effective case by the program."""

    version: str = Field(description="version of dem that wrote this file", examples=["0.8.0"])


class Case(CaseModel):
    """Complete case file. `case_model` narrows structure, joints and analysis to the kinds that exist."""

    title: str = Field(
        default="", description="one line; default: the name of the file", examples=["A wall of 21 blocks"]
    )
    dimension: Literal[2, 3] = Field(
        default=2, description="2: blocks in the x–y plane, y upwards; 3: blocks in space, z upwards"
    )
    gravity: NonNegative = Field(default=9.81, description="acceleration towards −y, in 3D towards −z [m/s2]")
    seed: int = Field(default=1, ge=0, description="makes whatever is random reproducible")
    inferred_from: tuple[Name, ...] = Field(
        default=(),
        description="results, by name, from which inputs of this case were inferred: none is a test of it. "
        "Nothing that is computed changes",
        examples=[["thesis_church.rigid_modelA_A"]],
    )
    chosen_by: tuple[Name, ...] = Field(
        default=(),
        description="results, by name, that were known when inputs of this case were chosen among others: none is a "
        "test of it. Nothing that is computed changes",
        examples=[["thesis_arch_shaking.harm_25"]],
    )
    dem: ProgramStamp | None = Field(default=None, description="written by the program")
    materials: dict[str, Material] = Field(min_length=1, description="materials by name")
    joints: dict[str, Any] = Field(min_length=1, description="joints by name; the first is the default one")
    interface: tuple[Interface, ...] = Field(default=(), description="other joints between two materials")
    structure: tuple[Any, ...] = Field(default=(), description="generated blocks")
    block: tuple[BlockTable, ...] = Field(default=(), description="blocks drawn by hand")
    imperfection: tuple[Imperfection, ...] = Field(default=(), description="errors of blocks and structures")
    ground: GroundTable | None = Field(default=None, description="one fixed block under all structures")
    groups: dict[str, GroupMembers] = Field(
        default={},
        description="blocks under one name: lists of ids, patterns, other groups and tables",
        examples=[{"front": ["left-13-*", {"structure": "right", "course": 13}]}],
    )
    load: tuple[Load, ...] = Field(default=(), description="forces on blocks")
    pressure: tuple[Pressure, ...] = Field(default=(), description="pressure on faces: uniform, of water, of earth")
    fill: tuple[Fill, ...] = Field(default=(), description="earth that lies on blocks")
    strain: tuple[ImposedStrain, ...] = Field(
        default=(), description="strains that blocks would have if nothing held them, of warming or drying"
    )
    restraint: tuple[Restraint, ...] = Field(default=(), description="motions of blocks that are held from outside")
    settlement: tuple[Settlement, ...] = Field(default=(), description="supports that are moved")
    damping: Any = Field(default=None, description="what joints and blocks lose in a time history, beside friction")
    initial: tuple[Any, ...] = Field(default=(), description="blocks that start a time history tilted or moving")
    analysis: Any = Field(description="what is computed")
    output: Output = Field(default=Output(), description="what is kept")
    tie: tuple[Any, ...] = Field(default=(), description="rods and cables between points of blocks")
    bars: dict[str, Any] = Field(default={}, description="kinds of reinforcing bars by name")
    reinforcement: tuple[Any, ...] = Field(default=(), description="bars in blocks, held by bond")
    monitor: tuple[Monitor, ...] = Field(default=(), description="numbers followed through the run")
    reference: Annotated[tuple[Reference, ...], OneOrMoreSchema()] = Field(
        default=(), description="what the answer is compared with: one [reference], or several [[reference]]"
    )
    alternative: tuple[Alternative, ...] = Field(
        default=(), description="of a blind case: what else its inputs could be; `dem verify --predict` runs each"
    )
    prediction: tuple[Prediction, ...] = Field(
        default=(), description="of a blind case: written by `dem verify --predict`, and never changed"
    )
    motion: tuple[Any, ...] = Field(default=(), description="how supports move: one [motion], or several [[motion]]")
    calibration: Any = Field(default=None, description="what was measured, and profiles to try; for `dem calibrate`")
    sweep: Sweep | None = Field(default=None, description="the runs of `dem sweep`; other commands ignore it")

    def __eq__(self, other: object) -> bool:
        """Test whether two cases have the same values, whichever kinds their classes know (`case_model`)."""
        return isinstance(other, Case) and dict(self) == dict(other)

    @model_validator(mode="before")
    @classmethod
    def _not_without_end(cls, tables: Any) -> Any:
        """Refuse too many tables before any of them is validated."""
        for key, several in tables.items() if isinstance(tables, dict) else ():
            if key != "block" and isinstance(several, (list, tuple, dict)) and len(several) > MOST_TABLES:
                raise KeyProblem(f"{len(several):,} tables are too many; at most {MOST_TABLES:,}", key)
        return tables

    @model_validator(mode="after")
    def _references_know_the_resolution(self) -> Case:
        for one in self.reference:
            one.resolved_to(getattr(self.analysis, "resolution", None))
        return self

    @model_validator(mode="after")
    def _predictions_are_of_blind_references(self) -> Case:
        asked = [one.path for one in self.reference if one.kind == BLIND]
        for key in ("alternative", "prediction"):
            if getattr(self, key) and not asked:
                raise KeyProblem(f"only allowed beside a [reference] of kind '{BLIND}'", key)
        for i, one in enumerate(self.prediction):
            if one.quantity not in asked or one.quantity in (other.quantity for other in self.prediction[:i]):
                message = f"'{one.quantity}' is not allowed; there is one prediction of each blind reference"
                raise KeyProblem(message, "prediction", i, "quantity")
        return self

    @model_validator(mode="after")
    def _on_the_ground(self) -> Case:
        """Remove the bases of structures that stand on a [ground], except where a structure has its own."""
        if self.ground is None:
            return self
        for i, table in enumerate(self.structure):
            for key in ("base_height", "base_extension"):
                if table.on_ground and key in table.model_fields_set and "base" not in table.model_fields_set:
                    raise KeyProblem(
                        "not used with [ground], which is its base; or give base = true", "structure", i, key
                    )
        standing = tuple(
            table.model_copy(update={"base": table.no_base})
            if hasattr(table, "base") and "base" not in table.model_fields_set and table.on_ground
            else table
            for table in self.structure
        )
        return self.model_copy(update={"structure": standing})

    @model_validator(mode="after")
    def _vectors_of_space(self) -> Case:
        return in_space(self) if self.dimension == 3 else self

    @property
    def compared(self) -> tuple[Reference, ...]:
        """References with a value of their own; `dem verify` alone judges blind ones, by their predictions."""
        return tuple(one for one in self.reference if one.kind != BLIND)

    @property
    def blind(self) -> tuple[Reference, ...]:
        """References that are predicted before they are measured."""
        return tuple(one for one in self.reference if one.kind == BLIND)

    @property
    def default_joint(self) -> str:
        """Name of the joint between materials that no [[interface]] names."""
        return next(iter(self.joints))

    def joint_between(self, material_a: str, material_b: str) -> str:
        """Return the name of the joint between two materials, in any order; of several interfaces the last counts."""
        pair = {material_a, material_b}
        named = [interface.joint for interface in self.interface if set(interface.between) == pair]
        return named[-1] if named else self.default_joint


def case_model(
    structures: Mapping[str, type[StructureBase]],
    laws: Mapping[str, type[CaseModel]],
    analyses: Mapping[str, type[CaseModel]],
    tables: Mapping[str, type[CaseModel]] | None = None,
    motions: Mapping[str, type[CaseModel]] | None = None,
    links: Mapping[str, type[CaseModel]] | None = None,
    left_out: Collection[str] = (),
) -> type[Case]:
    """Create the class of case files with these structure, joint and analysis kinds: kind -> class of its parameters.

    tables: classes of [calibration], [damping] and [[initial]] by key; one that is left out does not exist.
    motions: kinds of the [motion] tables; links: tables of links, and those by name that they name, by their key.
    left_out: keys that the files of this class do not have, so that their tables need not be known.
    """
    structure = one_of(structures, "kind") if structures else Any
    joint = one_of(laws, "law", default=DEFAULT_LAW)
    analysis = one_of(analyses, "kind", default=DEFAULT_ANALYSIS)
    fields, one = Case.model_fields, tables or {}
    narrowed: dict[str, Any] = {
        "structure": (sequence_of(structure), Field(default=(), description=fields["structure"].description)),
        "joints": (GenericAlias(dict, (str, joint)), Field(min_length=1, description=fields["joints"].description)),
        "analysis": (
            analysis,
            Field(default_factory=dict, validate_default=True, description=fields["analysis"].description),
        ),
        "motion": (one_or_more(one_of(motions, "kind") if motions else Any), fields["motion"]),
        "calibration": (one["calibration"] | None if "calibration" in one else None, fields["calibration"]),
        "damping": (one["damping"] | None if "damping" in one else None, fields["damping"]),
        "initial": (
            sequence_of(one["initial"]) if "initial" in one else tuple[()],
            Field(default=(), description=fields["initial"].description),
        ),
    }
    for key, table in (links or {}).items():
        several: Any = sequence_of(table) if fields[key].default == () else GenericAlias(dict, (str, table))
        narrowed[key] = (several, Field(default=fields[key].default, description=fields[key].description))
    narrowed |= {key: (Any, fields[key]) for key in left_out}
    return cast(type[Case], create_model("Case", __base__=Case, __doc__="A dem case file.", **narrowed))


def one_of(kinds: Mapping[str, type[CaseModel]], key: str, default: str | None = None) -> Any:
    """Return the type of a table whose `key` selects one of the `kinds`; without the key it is the `default`."""
    for kind, parameters in kinds.items():
        field = parameters.model_fields.get(key)
        if field is None or get_args(field.annotation) != (kind,):
            raise TypeError(f"{parameters.__name__} must declare {key}: Literal[{kind!r}]")
    classes = list(kinds.values())
    table: Any = reduce(or_, classes)
    if len(classes) > 1:
        table = Annotated[table, Field(discriminator=key)]
    return Annotated[table, BeforeValidator(with_default(key, default))] if default in kinds else table


def with_default(key: str, value: str | None) -> Callable[[Any], Any]:
    """Return a function that adds `key = value` to a table without that key."""
    return lambda table: {key: value, **table} if isinstance(table, dict) and key not in table else table
