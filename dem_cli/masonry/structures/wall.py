"""Table of a wall of rectangular blocks in courses."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Pair, Positive, check_count
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.bonding import BondKeys
from dem_cli.masonry.structures.courses import HEADER_BONDS, LEAST_PIECE, bed_joints
from dem_cli.masonry.structures.masonry import Core, Quoins
from dem_cli.masonry.structures.openings import NARROWEST_PIECE, Opening, check_apart, check_opening
from dem_cli.masonry.structures.sides import Side
from dem_cli.masonry.structures.wall_outline import NOT_UPRIGHT, Outlined

OF_OUTLINE = ("courses", "blocks_per_course", "length", "course_heights", "course_lengths", "gable", "profile")


class Wall(BondKeys, Outlined):
    """Wall of blocks in courses from the bottom up. Local origin: lower left corner of the wall, on top of its base.

    In 3D half of the thickness lies to either side of the origin.

    Block names: "<id>-<course>-<number>", both from 1, numbers from left to right, of one leaf with its letter after
    them, "a" at the front (-y); "<id>-base"; "<id>-lintel-<number of the opening>"; "<id>-arch-<opening>-<voussoir>",
    from the left; "<id>-quoin-left-<number>" and right, from below; "<id>-side-<number>", "<id>-side-<number>-left"
    and so on.
    """

    kind: Literal["wall"] = "wall"
    block: tuple[Positive, Positive] = Field(
        description="length and height of a full block, in 3D its thickness may follow [m]",
        examples=[[0.4, 0.2]],
        json_schema_extra={"maxItems": 3},
    )
    courses: int | None = Field(
        None, ge=1, le=10_000, description="number of courses; default: those of the outline", examples=[12]
    )
    blocks_per_course: int | None = Field(
        None,
        ge=1,
        le=10_000,
        description="full blocks in a full course: the wall is this many block lengths long",
        examples=[8],
    )
    length: Positive | None = Field(
        None, description="length of the wall [m], instead of blocks_per_course", examples=[6.0]
    )
    ends: Literal["half", "toothed"] = Field(
        "half",
        description="half: part blocks close the ends flush; "
        "toothed: no part blocks, shifted courses stick out to the right",
    )
    first: Literal["half", "full"] = Field(
        "half",
        description="lowest course; half: shifted, starts with a part block; full: starts with a full block",
    )
    course_heights: tuple[Positive, ...] = Field(
        (), description="height of each course from below [m]; default: block[1]", examples=[[0.25, 0.2, 0.2]]
    )
    course_lengths: tuple[Positive, ...] = Field(
        (), description="block length in each course from below [m]; default: all alike", examples=[[0.5, 0.4, 0.4]]
    )
    thickness: Positive = Field(1.0, description="depth out of plane [m]")
    core: Core | None = Field(
        None,
        description="rubble in place of the middle one of three leaves; default: none",
        examples=[{"thickness": 0.3, "material": "rubble"}],
    )
    quoins: Quoins | None = Field(
        None, description="larger stones at both ends; default: none", examples=[{"length": 0.6, "height": 2}]
    )
    openings: tuple[Opening, ...] = Field(
        (), description="doors and windows", examples=[[{"x": 0.8, "y": 0.0, "width": 0.9, "height": 2.0}]]
    )
    gable: tops.Gable | None = Field(
        None, description="a triangle of masonry on top of the courses; default: none", examples=[{"height": 1.5}]
    )
    profile: tuple[Pair, ...] = Field(
        (),
        description="top of the wall from its left to its right end, points [x, y] [m]: courses are cut there; "
        "default: level",
        examples=[[[0.0, 2.0], [3.0, 1.2], [6.0, 1.2]]],
    )
    base: bool = Field(True, description="a fixed block below, as long as the wall")
    base_height: Positive | None = Field(
        None, description="height of the base [m]; default: that of a block", examples=[0.3]
    )
    base_extension: NonNegative = Field(
        0.0, description="how far the base goes beyond each end, in 3D also beyond each face [m]", examples=[0.5]
    )
    sides: tuple[Side, ...] = Field(
        (),
        description="fixed supports behind faces of the wall",
        examples=[[{"face": "-y", "strip": 0.8}]],
    )

    @property
    def extent(self) -> float:
        """Length of a full course [m]."""
        if self.outline:
            return self.outline.drawn.size[0]
        return self.block[0] * self.blocks_per_course if self.blocks_per_course else self.length or 0.0

    @property
    def base_depth(self) -> float:
        """Height of the base [m]."""
        return self.base_height or self.block[1]

    @property
    def courses_top(self) -> float:
        """Level of the top of the courses, without a gable [m]."""
        return float(self.levels[-1])

    @property
    def levels(self) -> np.ndarray:
        """Heights of the bed joints from the foot to the top [m], (courses + 1,).

        The uppermost course below an outline is as high as is left, a quarter of a course or more.
        """
        if self.outline is None:
            return bed_joints(self.courses or 1, self.block[1], self.course_heights)
        height, course = self.outline.drawn.size[1], self.block[1]
        count = max(1, math.ceil((height / course - LEAST_PIECE) * (1.0 - NARROWEST_PIECE)))
        return np.append(bed_joints(count - 1, course), height)

    @property
    def all_openings(self) -> tuple[Opening, ...]:
        """Openings of the case followed by those of the drawing."""
        return self.with_drawn(self.openings)

    @property
    def quoin_courses(self) -> int:
        """Number of courses with quoins: those at whose ends the outline is upright."""
        if self.outline is None:
            return len(self.levels) - 1
        eaves = self.outline.drawn.eaves * (1.0 + NARROWEST_PIECE)
        return int(np.searchsorted(self.levels, eaves, side="right")) - 1

    @property
    def top_line(self) -> tops.Profile | None:
        """Line of the top from left to right, of a gable or a profile; None: level, or drawn in the outline."""
        if self.gable:
            return tops.gable_profile(self.gable, 0.0, self.extent, self.courses_top)
        return np.array(self.profile) if self.profile else None

    @property
    def is_plain(self) -> bool:
        """Tell whether cut blocks stay however short: one leaf, holes without arches."""
        return not self._shaped_by

    @property
    def _shaped_by(self) -> list[str]:
        """Keys that require masonry without short pieces."""
        given = [key for key in ("length", "outline", "core", "quoins", "gable", "profile") if getattr(self, key)]
        given += ["bond"] * (self.bond in HEADER_BONDS) + ["leaves"] * (self.leaves > 1)
        return given + ["openings"] * any(opening.arch for opening in self.openings)

    @model_validator(mode="after")
    def _not_too_many(self) -> Wall:
        self.check_outlined(self.openings, OF_OUTLINE)
        if self.courses is None and self.outline is None:
            raise KeyProblem("missing; must be a whole number from 1 to 10,000, the number of courses", "courses")
        if self.outline is None and (self.blocks_per_course is None) == (self.length is None):
            found = "found none" if self.length is None else "found both"
            raise KeyProblem(f"a wall needs either blocks_per_course or length; {found}", "blocks_per_course")
        lengths = self.course_lengths or (self.block[0],) * (len(self.levels) - 1)
        count = sum(self.extent / length for length in lengths) * self.leaves
        check_count(count, "course_lengths" if self.course_lengths else "courses")
        return self

    @model_validator(mode="after")
    def _consistent(self) -> Wall:
        for key in ("course_heights", "course_lengths"):
            given = getattr(self, key)
            if given and len(given) != self.courses:
                raise KeyProblem(f"{len(given)} values; must be one for each of the {self.courses} courses", key)
        self.check_bond(min(self.course_lengths or (self.block[0],)))
        for i, length in enumerate(self.course_lengths):
            if length > self.extent * (1 + NARROWEST_PIECE):
                message = f"{length:g} is not allowed; must be at most {self.extent:g}, the length of the wall"
                raise KeyProblem(message, "course_lengths", i)
        for i, side in enumerate(self.sides):
            _check_side(self, side, i)
        top = self.courses_top + (self.gable.height if self.gable else 0.0)
        for i, opening in enumerate(self.openings):
            check_opening(opening, i, self.extent, top)
        return self

    @model_validator(mode="after")
    def _laid_together(self) -> Wall:
        if self.ends == "toothed" and self._shaped_by:
            raise KeyProblem(f"'toothed' is not allowed with {self._shaped_by[0]}", "ends")
        _check_leaves(self)
        _check_top(self)
        check_apart(self.openings)
        return self


def _check_leaves(wall: Wall) -> None:
    """Raise KeyProblem where leaves, a core and quoins contradict each other."""
    if wall.core and wall.leaves != 3:
        raise KeyProblem("a core is the middle one of three leaves: give leaves = 3", "core")
    if wall.core and wall.core.thickness >= wall.thickness:
        message = f"{wall.core.thickness:g} is not allowed; must be less than the thickness of the wall, "
        raise KeyProblem(f"{message}{wall.thickness:g}", "core", "thickness")
    if wall.quoins and wall.quoin_courses < 1:
        raise KeyProblem(NOT_UPRIGHT, "quoins")
    if wall.quoins and 2.0 * wall.quoins.length > wall.extent:
        message = f"{wall.quoins.length:g} is not allowed; must be at most {wall.extent / 2.0:g}, half the wall"
        raise KeyProblem(message, "quoins", "length")


def _check_top(wall: Wall) -> None:
    """Raise KeyProblem where a gable or a profile is not the top of the wall, or openings cross it."""
    if wall.gable and wall.profile:
        raise KeyProblem("a wall has a gable or a profile, not both", "profile")
    if wall.profile:
        tops.check_profile(wall.profile, wall.extent, wall.courses_top)
    if wall.gable and wall.gable.ridge is not None and wall.gable.ridge >= wall.extent:
        message = f"{wall.gable.ridge:g} is not allowed; must be less than the length of the wall, {wall.extent:g}"
        raise KeyProblem(message, "gable", "ridge")
    top = wall.top_line
    if top is None:
        return
    for i, opening in enumerate(wall.openings):
        gap = NARROWEST_PIECE * opening.width
        if any(tops.cuts_off(top, shape, gap) for shape in opening.void.solids):
            raise KeyProblem("reaches above the top of the wall there", "openings", i)


def _check_side(wall: Wall, side: Side, i: int) -> None:
    """Raise KeyProblem where a side does not fit the wall."""
    widest = side.widest(wall.extent)
    if side.strip is not None and side.strip > widest * (1.0 + NARROWEST_PIECE):
        of = f"{'half ' if side.ends == 'both' else ''}the length of the wall"
        raise KeyProblem(f"{side.strip:g} is not allowed; must be at most {widest:g}, {of}", "sides", i, "strip")
    if wall.ends == "toothed" and not side.long:
        raise KeyProblem(
            f"'{side.face}' is not allowed with ends = 'toothed': the ends are not plane", "sides", i, "face"
        )
