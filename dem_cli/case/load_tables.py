"""Tables [[load]], [[pressure]], [[fill]] and [[restraint]]: point and line loads, pressure, earth, restraints."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Pair, Positive, Vector
from dem_cli.case.selection import Selection
from dem_cli.case.wording import show

Kind = Literal["dead", "live"]
KIND = "dead: constant; live: times the multiplier"
Angle = Annotated[float, Field(gt=0.0, lt=90.0)]
FACES = {  # name: axis and sign; "up" is y in the plane and z in space
    "+x": ("x", 1.0), "-x": ("x", -1.0), "+y": ("y", 1.0), "-y": ("y", -1.0), "+z": ("z", 1.0), "-z": ("z", -1.0),
    "top": ("up", 1.0), "bottom": ("up", -1.0),
}  # fmt: skip
PRESSURES = ("uniform", "fluid", "earth")


class Load(Selection):
    """[[load]]: a force on blocks, at a point, or along a line on what lies under it.

    On several blocks the force is shared in proportion to their masses. Without a block it acts on what lies highest
    under `at` or `line`; of blocks that cannot move only one that is named has a load.
    """

    needs_blocks: ClassVar[bool] = False

    force: Vector | None = Field(
        default=None, description="force, of several blocks on all together [N]", examples=[[100.0, 0.0]]
    )
    each: bool = Field(default=False, description="true: the force on each of several blocks", examples=[True])
    at: Vector | None = Field(
        default=None,
        description="point of application [m]; of several blocks, and without any, the force acts on the one under it; "
        "default: centroid of each block",
        examples=[[0.0, 1.75]],
    )
    line: tuple[Vector, Vector] | None = Field(
        default=None,
        description="instead of at: ends of a line, whose load acts on the blocks under it [m]",
        examples=[[[0.0, 3.0], [2.0, 3.0]]],
    )
    force_per_length: Vector | None = Field(
        default=None, description="with line: force per length of it [N/m]", examples=[[0.0, -2000.0]]
    )
    spread: NonNegative | None = Field(
        default=None,
        description="a load at a point or along a line spreads to each side on its way down through fill, by this "
        "share of its depth, evenly, from a point in 3D over a disc: 0.5 is two down to one aside [-]; default: it "
        "does not",
        examples=[0.5],
    )
    kind: Kind = Field(default="dead", description=KIND, examples=["live"])
    inertia: bool = Field(
        default=False,
        description="true: of a dead load, what presses down is the weight of a mass, such as that of a floor, and has "
        "its share in the load of pattern = 'mass', as that of the blocks",
        examples=[True],
    )
    follows: Literal["point", "block"] | None = Field(
        default=None,
        description="where geometry moves: 'point', it goes along with the point of the block that it was put on; "
        "'block', its direction turns with the block as well; default: it keeps direction and lever about the centroid",
        examples=["point"],
    )

    @model_validator(mode="after")
    def _a_force(self) -> Load:
        here, there = ("force", "force_per_length") if self.line is None else ("force_per_length", "force")
        if getattr(self, here) is None:
            of = "per length of the line [N/m]" if self.line is not None else "[N]"
            raise KeyProblem(f"missing; must be a list of numbers, the force {of}", here)
        for key in (there, *(("at",) if self.line is not None else ())):
            if getattr(self, key) is not None:
                raise KeyProblem(f"not allowed {'with' if self.line is not None else 'without'} line", key)
        if self.line is not None and math.dist(self.line[0][:-1], self.line[1][:-1]) == 0.0:
            raise KeyProblem(f"{show(self.line)} is not allowed; seen from above its ends are the same point", "line")
        placed = self.at is not None or self.line is not None
        if self.selected is None and not placed:
            raise KeyProblem("missing; say which blocks it acts on, or at which point or along which line", "block")
        if self.spread is not None and not placed:
            raise KeyProblem("not used without at or line", "spread")
        if self.follows == "point" and not placed:
            raise KeyProblem("'point' is not used without at or line: a force at the centroid follows it", "follows")
        if self.each and placed:
            raise KeyProblem(f"true is not allowed with {'at' if self.line is None else 'line'}", "each")
        return self

    @model_validator(mode="after")
    def _inertia_of_weights(self) -> Load:
        if self.inertia and self.kind == "live":
            raise KeyProblem("true is not allowed of a live load: it is no weight", "inertia")
        if self.inertia and (self.force or self.force_per_length or (0.0,))[-1] >= 0.0:
            raise KeyProblem("true is not allowed of a force that does not press down: it is no weight", "inertia")
        return self

    @property
    def falls(self) -> bool:
        """Tell whether the load acts on the blocks under a line or area instead of named blocks."""
        return self.line is not None or self.spread is not None or self.selected is None


class Fluid(CaseModel):
    """pressure.fluid: water or another fluid at rest, against faces below its level."""

    density: Positive = Field(default=1000.0, description="mass per volume [kg/m3]")
    level: float = Field(description="height of its surface [m]", examples=[3.0])


class Earth(CaseModel):
    """pressure.earth: lateral earth pressure below a level surface, a share of the vertical stress.

    A stress field: sideways `coefficient` times the vertical stress, which is the weight above; on faces that look up
    as well it lies with its weight. Faces that look down have the thrust alone.
    """

    density: Positive = Field(description="mass per volume, under water less that of water [kg/m3]", examples=[1800.0])
    level: float = Field(description="height of its surface [m]", examples=[3.0])
    coefficient: NonNegative | None = Field(
        default=None, description="horizontal over vertical stress [-]; or give friction_angle_deg", examples=[0.33]
    )
    friction_angle_deg: Angle | None = Field(
        default=None,
        description="angle of internal friction, for the active pressure of Rankine, with wall friction that of "
        "Coulomb on an upright wall [deg]",
        examples=[30.0],
    )
    wall_friction_deg: Annotated[float, Field(ge=0.0, lt=90.0)] = Field(
        default=0.0, description="how steeply its thrust points down on an upright face [deg]"
    )
    surcharge: NonNegative = Field(default=0.0, description="load on its surface [Pa]")

    @model_validator(mode="after")
    def _one_coefficient(self) -> Earth:
        if (self.coefficient is None) == (self.friction_angle_deg is None):
            if self.coefficient is None:
                raise ValueError(
                    "neither 'coefficient' nor 'friction_angle_deg' is given; one of them says how it pushes"
                )
            raise KeyProblem("'coefficient' and 'friction_angle_deg' are both given; give one of them", "coefficient")
        if self.friction_angle_deg is not None and self.wall_friction_deg > self.friction_angle_deg:
            message = f"{show(self.wall_friction_deg)} is not allowed; must be at most friction_angle_deg"
            raise KeyProblem(message, "wall_friction_deg")
        return self

    @property
    def sideways(self) -> float:
        """Lateral earth pressure coefficient, horizontal over vertical stress: given, or active.

        Rankine (1857): tan²(45° − φ/2); with friction δ on the wall the horizontal part of that of Coulomb (1776):
        cos²φ / (1 + √(sin(φ + δ) sin φ / cos δ))².
        """
        if self.friction_angle_deg is None:
            return self.coefficient or 0.0
        phi, delta = math.radians(self.friction_angle_deg), math.radians(self.wall_friction_deg)
        root = math.sqrt(math.sin(phi + delta) * math.sin(phi) / math.cos(delta))
        return (math.cos(phi) / (1.0 + root)) ** 2


class Pressure(Selection):
    """[[pressure]]: pressure on the faces of blocks that nothing covers at the start: uniform, of a fluid or of earth.

    It acts on faces, or parts of them, that no other block covers and that look towards `face` or at the point
    `facing`, square to them. What the structure does later changes neither force nor point of application.
    """

    face: Literal["+x", "-x", "+y", "-y", "+z", "-z", "top", "bottom", "all"] | Vector | None = Field(
        default=None,
        description="which way the faces look that it acts on: a side, a direction, or all of them [-]",
        examples=["-x"],
    )
    facing: Vector | None = Field(
        default=None,
        description="instead of face: a point that the faces look at, such as the middle of a curved wall [m]",
        examples=[[0.0, 2.0]],
    )
    within_deg: Annotated[float, Field(gt=0.0, le=90.0)] = Field(
        default=60.0, description="largest angle between that direction and a face's normal [deg]"
    )
    levels: Pair | None = Field(
        default=None, description="acts between these heights only [m]; default: at any", examples=[[0.0, 2.0]]
    )
    uniform: float | None = Field(
        default=None, description="the same everywhere, negative: suction [Pa]", examples=[5000.0]
    )
    fluid: Fluid | None = Field(default=None, description="of a fluid at rest", examples=[{"level": 3.0}])
    earth: Earth | None = Field(
        default=None,
        description="of earth with a level surface",
        examples=[{"density": 1800.0, "level": 3.0, "friction_angle_deg": 30.0}],
    )
    kind: Kind = Field(default="dead", description=KIND, examples=["live"])

    @model_validator(mode="after")
    def _one_of_each(self) -> Pressure:
        given = [key for key in PRESSURES if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(f"'{key}'" for key in given) + " are" if given else "none of them is"
            raise ValueError(f"{found} given; a pressure has one of 'uniform', 'fluid' and 'earth'")
        if (self.face is None) == (self.facing is None):
            if self.face is None:
                raise ValueError("neither 'face' nor 'facing' is given; one of them says which faces it acts on")
            raise KeyProblem("'face' and 'facing' are both given; one of them says which faces", "face")
        if isinstance(self.face, tuple) and not any(self.face):
            raise KeyProblem(f"{show(self.face)} is not allowed; a direction has a length", "face")
        if self.face == "all" and "within_deg" in self.model_fields_set:
            raise KeyProblem("not used with face = 'all'", "within_deg")
        if self.levels is not None and not self.levels[0] < self.levels[1]:
            raise KeyProblem(f"{show(self.levels)} is not allowed; the second value is the larger one", "levels")
        return self

    def direction(self, dimension: int) -> tuple[float, ...] | None:
        """Common outward direction of the loaded faces; None where the faces look in several directions."""
        if not isinstance(self.face, str):
            return self.face
        if self.face == "all":
            return None
        name, sign = FACES[self.face]
        axis = dimension - 1 if name == "up" else "xyz".index(name)
        return tuple(sign if i == axis else 0.0 for i in range(dimension))


class Fill(Selection):
    """[[fill]]: earth fill on blocks up to a level: its weight as dead load, and its thrust.

    Its weight above each exposed face that looks up, and a share of the vertical stress sideways on inclined faces,
    and on upright ones within its extent. What lies under another block has no fill on it.
    """

    density: Positive = Field(description="mass per volume [kg/m3]", examples=[1800.0])
    level: float = Field(description="height of its surface [m]", examples=[3.0])
    coefficient: NonNegative | None = Field(
        default=None,
        description="horizontal over vertical stress [-]; default: 0, with friction_angle_deg 1 - sin of it",
        examples=[0.5],
    )
    friction_angle_deg: Angle | None = Field(
        default=None, description="angle of internal friction, for the thrust of earth at rest [deg]", examples=[30.0]
    )
    extent: Pair | tuple[Pair, Pair] | None = Field(
        default=None,
        description="where it lies, seen from above: [x, x], in 3D opposite corners [[x, y], [x, y]] [m]; default: "
        "above the selected blocks, in 3D within their convex hull",
        examples=[[0.0, 4.0]],
    )
    inertia: bool = Field(
        default=False,
        description="true: its weight has its share in the load of pattern = 'mass', as that of the blocks",
        examples=[True],
    )

    @model_validator(mode="after")
    def _consistent(self) -> Fill:
        if self.coefficient is not None and self.friction_angle_deg is not None:
            raise KeyProblem("'coefficient' and 'friction_angle_deg' are both given; give one of them", "coefficient")
        sides = self.sides
        if any(low >= high for low, high in sides):
            raise KeyProblem(f"{show(self.extent)} is not allowed; the second values are the larger ones", "extent")
        return self

    @property
    def sideways(self) -> float:
        """Lateral earth pressure coefficient: given, or at rest, 1 − sin φ (Jaky 1944)."""
        if self.friction_angle_deg is not None:
            return 1.0 - math.sin(math.radians(self.friction_angle_deg))
        return self.coefficient or 0.0

    @property
    def sides(self) -> tuple[Pair, ...]:
        """Extent of the fill along x, in space also along y [m]; (): above all blocks."""
        if self.extent is None:
            return ()
        low, high = (end if isinstance(end, tuple) else (end,) for end in self.extent)
        return tuple(zip(low, high, strict=True))


class GroundTable(CaseModel):
    """[ground]: one fixed block named "ground" under all structures, which then have no bases of their own.

    A structure has one with base = true, beside the ground or above it; springings without piers stay fixed.
    """

    level: float | None = Field(
        default=None,
        description="height of its top [m]; default: the lowest point of what stands on it",
        examples=[0.0],
    )
    margin: NonNegative | None = Field(
        default=None,
        description="how far it goes beyond what stands on it [m]; default: a tenth of the largest extent of that",
        examples=[1.0],
    )
    height: Positive | None = Field(
        default=None, description="from its top to its bottom [m]; default: as margin's", examples=[0.5]
    )
    material: str = Field(
        default="", description="a name in [materials]; may be left out when there is only one", examples=["rock"]
    )


Motion = Literal["x", "y", "z", "rotation", "rotation_x", "rotation_y", "rotation_z"]


class Restraint(Selection):
    """[[restraint]]: prevented motions of blocks, such as the rotation of a guided beam.

    The centroid of each block does not move along what is held, and the block does not turn about it. What holds it
    gives whatever force or moment that takes and does no work; where the base moves, it moves along.
    """

    fixed: Annotated[tuple[Motion, ...], Field(min_length=1)] = Field(
        description="what is held: 'x', 'y', 'rotation'; in 3D also 'z', 'rotation' about all axes or 'rotation_x', "
        "'rotation_y', 'rotation_z' about one",
        examples=[["rotation"]],
    )
