"""Table of a building in a case file: axes in plan, openings, gables, floors, the ground below."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Name, NonNegative, Pair, Positive, RandomStructure, check_count
from dem_cli.masonry.structures.bonding import BondKeys
from dem_cli.masonry.structures.building.patterns import BuildingPattern
from dem_cli.masonry.structures.courses import HEADER_BONDS, bed_joints
from dem_cli.masonry.structures.openings import Opening, check_apart
from dem_cli.masonry.structures.tops import Gable

FRONT = {"id": "front", "axis": [[0.0, 0.0], [5.0, 0.0]]}
PATTERN = {"kind": "voronoi", "cell": 0.4}
FLOOR = {"id": "attic", "z": 2.5, "on": ["left", "right"], "kind": "beams", "mass": 900.0}


class PlanWall(CaseModel):
    """structure.walls: one wall of a building, along its axis in plan.

    Walls meet where their axes do, or where one ends within the thickness of the other.
    """

    id: Name = Field(description="name of the wall, part of the names of its blocks", examples=["front"])
    axis: tuple[Pair, Pair] = Field(
        description="from where to where its middle line goes in plan: x and y of both ends [m]",
        examples=[[[0.0, 0.0], [5.0, 0.0]]],
    )
    thickness: Positive | None = Field(
        None, description="of this wall [m]; default: that of the building", examples=[0.6]
    )
    courses: int | None = Field(
        None, ge=1, le=10_000, description="courses of this wall; default: those of the building", examples=[4]
    )
    material: str = Field("", description="a name in [materials]; default: that of the building", examples=["brick"])
    openings: tuple[Opening, ...] = Field(
        (),
        description="doors and windows; x from the first end of the axis, y from the foot of the wall [m]",
        examples=[[{"x": 0.8, "y": 0.0, "width": 0.9, "height": 2.0}]],
    )
    gable: Gable | None = Field(None, description="a triangle on top; default: none", examples=[{"height": 1.5}])
    pattern: BuildingPattern | None = Field(
        None, description="irregular stones of this wall; default: those of the building", examples=[PATTERN]
    )

    @model_validator(mode="after")
    def _has_a_length(self) -> PlanWall:
        if self.axis[0] == self.axis[1]:
            raise KeyProblem("both ends are the same point; a wall has a length", "axis")
        check_apart(self.openings)
        return self


class Floor(CaseModel):
    """structure.floors: a floor of one room, a rigid plate or beams, on a bed joint.

    Where it bears on a wall the courses beside it give way: what is above rests on the floor and on what is left of the
    wall. The room is the one that the walls named bound, or lies between two of them that do not meet.
    """

    id: Name = Field(description="name of the plate, first part of the names of the beams", examples=["attic"])
    z: NonNegative = Field(description="height of its lower face above the foot of the walls [m]", examples=[2.5])
    on: Annotated[tuple[Name, ...], Field(min_length=1)] = Field(
        description="walls that it bears on; of beams the two that they reach from and to, and after these others of "
        "their room where these two bound more than one",
        examples=[["left", "right"]],
    )
    kind: Literal["rigid", "beams"] = Field(
        "rigid", description="rigid: one plate; beams: square to the first wall in on, each a block"
    )
    bearing: Positive | None = Field(
        None,
        description="how far it reaches into the walls that it bears on [m]; default: a plate half of their "
        "thickness, beams all of it",
        examples=[0.2],
    )
    height: Positive | None = Field(
        None, description="of the plate or the beams [m]; default: to the next bed joint", examples=[0.2]
    )
    mass: Positive | None = Field(
        None, description="of the whole floor with what lies on it [kg]; default: by its density", examples=[900.0]
    )
    material: str = Field("", description="a name in [materials]; default: that of the building", examples=["oak"])
    spacing: Positive = Field(0.6, description="of beams, from middle to middle, about [m]")
    width: Positive = Field(0.15, description="of beams [m]")
    gap: NonNegative = Field(0.02, description="of a plate, to walls of the room that it does not bear on [m]")

    @property
    def bears_on(self) -> tuple[str, ...]:
        """Walls that carry the floor."""
        return self.on[:2] if self.kind == "beams" else self.on

    @model_validator(mode="after")
    def _keys_of_its_kind(self) -> Floor:
        foreign = ("gap",) if self.kind == "beams" else ("spacing", "width")
        for key in foreign:
            if getattr(self, key) != type(self).model_fields[key].default:
                whose = "a plate" if self.kind == "beams" else "beams"
                raise KeyProblem(f"not allowed with kind = '{self.kind}': it is that of {whose}", key)
        return self


class Building(BondKeys, RandomStructure):
    """Walls that meet, from their axes in plan: bonded at corners, T-junctions and crossings of any angle, with
    openings, gables and floors. Local origin: that of the plan, at the foot of the walls, on top of the base.

    Of two walls that meet, the one named first passes in odd courses, the other one in even ones. Where a length is no
    whole number of blocks, some are cut, none to less than a quarter of the given length.
    With a pattern the stones of the regular courses where walls meet, end or carry a floor are kept as dressed ones.
    Block names: "<id>-<wall>-<course>-<number>", both from 1, numbers along the axis; with a pattern
    "<id>-<wall>-dressed-<course>-<number>" and "<id>-<wall>-<number>", coursed "<id>-<wall>-<course>-<number>";
    "<id>-<wall>-lintel-<number of the opening>"; "<id>-<floor>", beams "<id>-<floor>-<number>"; "<id>-base", strips
    "<id>-base-<wall>".
    """

    only_in: ClassVar[int | None] = 3
    no_base: ClassVar[bool | str] = "none"

    kind: Literal["building"] = "building"
    block: tuple[Positive, Positive] = Field(
        description="length and height of a full block; the thickness of the walls may follow [m]",
        examples=[[0.5, 0.25]],
        json_schema_extra={"maxItems": 3},
    )
    thickness: Positive = Field(0.4, description="of the walls [m]")
    courses: int = Field(ge=1, le=10_000, description="courses of the walls", examples=[10])
    course_heights: tuple[Positive, ...] = Field(
        (), description="height of each course from below [m]; default: block[1]", examples=[[0.25, 0.2, 0.2]]
    )
    walls: Annotated[tuple[PlanWall, ...], Field(min_length=1)] = Field(
        description="the walls by their axes in plan", examples=[[FRONT]]
    )
    floors: tuple[Floor, ...] = Field((), description="plates and beams on the walls", examples=[[FLOOR]])
    pattern: BuildingPattern | None = Field(
        None,
        description="irregular stones between dressed ones where walls meet and end; default: regular courses",
        examples=[PATTERN],
    )
    base: Literal["slab", "strips", "none"] = Field(
        "slab", description="fixed blocks below: one slab under all walls, strips along them, or none"
    )
    base_height: Positive | None = Field(
        None, description="height of the base [m]; default: that of a block", examples=[0.3]
    )
    base_extension: NonNegative = Field(0.5, description="how far the base goes beyond the walls on all sides [m]")

    @property
    def levels(self) -> np.ndarray:
        """Heights of the bed joints from the foot to the top [m], (courses + 1,)."""
        return bed_joints(self.courses, self.block[1], self.course_heights)

    @property
    def base_depth(self) -> float:
        """Height of the base [m]."""
        return self.base_height or self.block[1]

    def number(self, wall: str) -> int:
        """Return the number of the wall with a name."""
        return [each.id for each in self.walls].index(wall)

    @model_validator(mode="after")
    def _consistent(self) -> Building:
        self.check_bond(self.block[0])
        _check_pattern(self)
        if self.course_heights and len(self.course_heights) != self.courses:
            given = len(self.course_heights)
            raise KeyProblem(f"{given} values; must be one for each of the {self.courses} courses", "course_heights")
        if "seed" in self.model_fields_set and not (self.pattern or any(wall.pattern for wall in self.walls)):
            raise KeyProblem("not used without a pattern: nothing is drawn at random", "seed")
        names = [wall.id for wall in self.walls] + [floor.id for floor in self.floors]
        for i, name in enumerate(names):
            if name in names[:i] or name == "base":
                where = ("walls", i) if i < len(self.walls) else ("floors", i - len(self.walls))
                raise KeyProblem(f"the name '{name}' is taken; give another", *where, "id")
        for i, wall in enumerate(self.walls):
            if wall.courses is not None and wall.courses > self.courses:
                message = f"{wall.courses} is not allowed; must be at most {self.courses}, the courses of the building"
                raise KeyProblem(message, "walls", i, "courses")
        for i, floor in enumerate(self.floors):
            _check_floor(self, floor, i)
        return self

    @model_validator(mode="after")
    def _not_too_many(self) -> Building:
        length = sum(float(np.hypot(*np.subtract(*wall.axis))) for wall in self.walls)
        count = length / self.block[0] * self.courses
        check_count(count, "courses")
        return self


def _check_pattern(building: Building) -> None:
    """Raise KeyProblem where keys of regular courses contradict a pattern of irregular stones."""
    if building.pattern is None and all(wall.pattern is None for wall in building.walls):
        return
    if building.leaves > 1:
        raise KeyProblem("not used with a pattern: its stones go through the whole wall", "leaves")
    if building.bond in HEADER_BONDS:
        allowed = "must be 'running' or 'stack', or an offset"
        raise KeyProblem(f"'{building.bond}' is not allowed with a pattern; {allowed}", "bond")


def _check_floor(building: Building, floor: Floor, i: int) -> None:
    """Raise KeyProblem where a floor names an unknown wall, or lies on no bed joint."""
    known = [wall.id for wall in building.walls]
    for k, name in enumerate(floor.on):
        if name not in known:
            listed = ", ".join(f"'{one}'" for one in known)
            raise KeyProblem(f"there is no wall '{name}' (walls: {listed})", "floors", i, "on", k)
    if len(set(floor.on)) < len(floor.on):
        raise KeyProblem("a wall is named twice", "floors", i, "on")
    if floor.kind == "beams" and len(floor.on) < 2:
        message = "one wall; beams reach from one wall to another: give two"
        raise KeyProblem(message, "floors", i, "on")
    near = building.levels[np.abs(building.levels - floor.z).argmin()]
    if abs(near - floor.z) > 1e-6 * building.block[1]:
        raise KeyProblem(f"{floor.z:g} is no bed joint; the nearest one is at {near:g}", "floors", i, "z")
