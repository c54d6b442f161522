"""Walls of rectangular blocks in courses."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Pair, Positive
from dem_cli.geometry.polygon import rectangle
from dem_cli.model.blocks import Block
from dem_cli.structures import tops
from dem_cli.structures.bases import base_block
from dem_cli.structures.courses import HEADER_BONDS, LEAST_PIECE, bed_joints
from dem_cli.structures.masonry import Core, Masonry, Quoins
from dem_cli.structures.masonry_blocks import masonry_blocks
from dem_cli.structures.openings import NARROWEST_PIECE, Opening, check_apart, check_opening
from dem_cli.structures.sides import Side, SupportedWall, side_blocks
from dem_cli.structures.wall_outline import NOT_UPRIGHT, Outlined, hollows

MOST_BLOCKS = 1_000_000
OF_OUTLINE = ("courses", "blocks_per_course", "length", "course_heights", "course_lengths", "gable", "profile")


class Wall(Outlined):
    """Blocks in courses from the bottom up. Local origin: lower left corner of the wall, on top of its base.

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
    bond: Literal["running", "stack", "english", "english-garden", "flemish"] | None = Field(
        None,
        description="running: every other course is shifted by half a block; stack: none is; english: courses of "
        "stretchers and of headers (half a block long) in turn; english-garden: three of stretchers, one of headers; "
        "flemish: stretchers and headers in turn in each course; headers go through all leaves; default: running",
        examples=["stack"],
    )
    offset: NonNegative | None = Field(
        None, description="shift of every other course [m], instead of bond; less than the block length", examples=[0.1]
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
    leaves: int = Field(1, ge=1, le=3, description="walls side by side that the thickness consists of", examples=[2])
    through_stones: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="share of the stones of a face that go through all leaves, evenly spaced [-]",
        examples=[0.2],
    )
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
        """Those of the case and, after them, those drawn."""
        return self.with_drawn(self.openings)

    @property
    def is_plain(self) -> bool:
        """Whether blocks and what is cut of them stay as they fall, however short: one leaf, holes without arches."""
        return not self._shaped_by

    @property
    def _shaped_by(self) -> list[str]:
        """Keys by which it is laid without short pieces."""
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
        if count > MOST_BLOCKS:
            key = "course_lengths" if self.course_lengths else "courses"
            raise KeyProblem(f"{count:.3g} blocks are too many; must be at most {MOST_BLOCKS:,}", key)
        return self

    @model_validator(mode="after")
    def _consistent(self) -> Wall:
        for key in ("course_heights", "course_lengths"):
            given = getattr(self, key)
            if given and len(given) != self.courses:
                raise KeyProblem(f"{len(given)} values; must be one for each of the {self.courses} courses", key)
        if self.offset is not None:
            if self.bond is not None:
                raise KeyProblem("bond and offset say the same; give one of them", "offset")
            shortest = min(self.course_lengths or (self.block[0],))
            if self.offset >= shortest:
                message = f"{self.offset:g} is not allowed; must be less than the block length, {shortest:g}"
                raise KeyProblem(message, "offset")
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
    """Raises KeyProblem where leaves, through-stones and a core do not go together."""
    if wall.through_stones and wall.leaves == 1:
        raise KeyProblem("not used with leaves = 1: every stone goes through", "through_stones")
    if wall.through_stones and wall.bond in HEADER_BONDS:
        raise KeyProblem(f"not used with bond = '{wall.bond}': its headers go through", "through_stones")
    if wall.core and wall.leaves != 3:
        raise KeyProblem("a core is the middle one of three leaves: give leaves = 3", "core")
    if wall.core and wall.core.thickness >= wall.thickness:
        message = f"{wall.core.thickness:g} is not allowed; must be less than the thickness of the wall, "
        raise KeyProblem(f"{message}{wall.thickness:g}", "core", "thickness")
    if wall.quoins and _quoin_courses(wall) < 1:
        raise KeyProblem(NOT_UPRIGHT, "quoins")
    if wall.quoins and 2.0 * wall.quoins.length > wall.extent:
        message = f"{wall.quoins.length:g} is not allowed; must be at most {wall.extent / 2.0:g}, half the wall"
        raise KeyProblem(message, "quoins", "length")


def _check_top(wall: Wall) -> None:
    """Raises KeyProblem where a gable or a profile is not the top of the wall, or openings cross it."""
    if wall.gable and wall.profile:
        raise KeyProblem("a wall has a gable or a profile, not both", "profile")
    if wall.profile:
        tops.check_profile(wall.profile, wall.extent, wall.courses_top)
    if wall.gable and wall.gable.ridge is not None and wall.gable.ridge >= wall.extent:
        message = f"{wall.gable.ridge:g} is not allowed; must be less than the length of the wall, {wall.extent:g}"
        raise KeyProblem(message, "gable", "ridge")
    top = _top(wall)
    if top is None:
        return
    for i, opening in enumerate(wall.openings):
        gap = NARROWEST_PIECE * opening.width
        if any(tops.cuts_off(top, shape, gap) for shape in opening.void.solids):
            raise KeyProblem("reaches above the top of the wall there", "openings", i)


def _check_side(wall: Wall, side: Side, i: int) -> None:
    """Raises KeyProblem where a side does not fit the wall."""
    widest = side.widest(wall.extent)
    if side.strip is not None and side.strip > widest * (1.0 + NARROWEST_PIECE):
        of = f"{'half ' if side.ends == 'both' else ''}the length of the wall"
        raise KeyProblem(f"{side.strip:g} is not allowed; must be at most {widest:g}, {of}", "sides", i, "strip")
    if wall.ends == "toothed" and not side.long:
        raise KeyProblem(
            f"'{side.face}' is not allowed with ends = 'toothed': the ends are not plane", "sides", i, "face"
        )


def build(wall: Wall) -> list[Block]:
    """Blocks in local coordinates, course by course from below, the base first, lintels last."""
    if wall.is_plain:
        boxes = [_course(wall, k) for k in range(len(wall.levels) - 1)]
        ends = (min(box[0, 0] for box in boxes), max(box[-1, 2] for box in boxes))
        laid = _plain_blocks(wall, boxes)
    else:
        ends = (0.0, wall.extent)
        laid = masonry_blocks(masonry_of(wall))
    blocks = []
    if wall.base:
        left, right = ends[0] - wall.base_extension, ends[1] + wall.base_extension
        shape = rectangle(left, -wall.base_depth, right - left, wall.base_depth)
        blocks.append(base_block("base", shape, wall.thickness, wall.base_extension))
    foot = -wall.base_depth if wall.base and not wall.base_extension else 0.0
    blocks += side_blocks(wall.sides, SupportedWall(wall.extent, wall.courses_top, wall.thickness, foot))
    blocks += laid
    if all(block.fixed for block in blocks):
        raise ValueError("the openings leave nothing of the wall")
    return blocks


def masonry_of(wall: Wall) -> Masonry:
    """What a wall is made of that is laid without short pieces."""
    levels = wall.levels
    courses = len(levels) - 1
    if wall.gable:
        levels = tops.with_gable(levels, wall.gable, wall.block[1])
    top, stepped = _top(wall), wall.gable is not None and wall.gable.edges == "stepped"
    spans = [((0.0, wall.extent),)] * courses
    if wall.gable and top is not None:
        edges = zip(levels[courses:-1].tolist(), levels[courses + 1 :].tolist(), strict=True)
        spans += [(tops.level_span(top, (low + high) / 2.0 if stepped else low),) for low, high in edges]
    return Masonry(
        length=wall.block[0],
        thickness=wall.thickness,
        levels=levels,
        spans=spans,
        bond=wall.bond or "running",
        offset=wall.offset,
        first=wall.first,
        lengths=wall.course_lengths and (*wall.course_lengths, *[wall.block[0]] * (len(spans) - courses)),
        leaves=wall.leaves,
        through_stones=wall.through_stones,
        core=wall.core,
        quoins=wall.quoins,
        quoin_courses=_quoin_courses(wall),
        openings=wall.all_openings,
        hollows=hollows(wall.outline),
        top=None if stepped else top,
    )


def _quoin_courses(wall: Wall) -> int:
    """How many courses have quoins: those at whose ends the outline is upright."""
    if wall.outline is None:
        return len(wall.levels) - 1
    return int(np.searchsorted(wall.levels, wall.outline.drawn.eaves * (1.0 + NARROWEST_PIECE), side="right")) - 1


def _top(wall: Wall) -> tops.Profile | None:
    """Outline of the top from left to right; None: level."""
    if wall.gable:
        return tops.gable_profile(wall.gable, 0.0, wall.extent, wall.courses_top)
    return np.array(wall.profile) if wall.profile else None


def _plain_blocks(wall: Wall, boxes: list[np.ndarray]) -> list[Block]:
    """Blocks of courses (n, 4) and what openings leave of them, rectangles; lintels last."""
    holes = [opening.box for opening in wall.openings]
    lintels = [opening.lintel_box for opening in wall.openings]
    blocks = []
    small = NARROWEST_PIECE * min(wall.block[0], wall.block[1])
    for k, box in enumerate(boxes):
        pieces = box
        for hole in (*holes, *(lintel for lintel in lintels if lintel)):
            pieces = _cut(pieces, hole, small)
        for n, shape in enumerate(_corners(pieces)):
            blocks.append(Block(f"{k + 1}-{n + 1}", (shape,), "", wall.thickness, course=k + 1))
    for i, (opening, lintel_box) in enumerate(zip(wall.openings, lintels, strict=True)):
        if opening.lintel:
            shape = _corners(np.array([lintel_box]))[0]
            blocks.append(Block(f"lintel-{i + 1}", (shape,), opening.lintel.material, wall.thickness))
    return blocks


def _course(wall: Wall, k: int) -> np.ndarray:
    """Boxes [left, bottom, right, top] of course k (from 0), (n, 4), from left to right."""
    length = wall.course_lengths[k] if wall.course_lengths else wall.block[0]
    shift = wall.offset if wall.offset is not None else (0.0 if wall.bond == "stack" else length / 2.0)
    if k % 2 == (0 if wall.first == "full" else 1):
        shift = 0.0
    count = round(wall.extent / length, 6)
    if wall.ends == "toothed":
        heads = shift + length * np.arange(max(int(count), 1) + 1)
    else:
        inner = shift + length * np.arange(int(np.ceil(count)) + 1)
        small = NARROWEST_PIECE * length
        inner = inner[(inner > small) & (inner < wall.extent - small)]
        heads = np.concatenate([[0.0], inner, [wall.extent]])
    low, high = wall.levels[k : k + 2]
    ones = np.ones(len(heads) - 1)
    return np.stack([heads[:-1], low * ones, heads[1:], high * ones], axis=1)


def _cut(boxes: np.ndarray, hole: tuple[float, float, float, float], small: float) -> np.ndarray:
    """The boxes (n, 4) less the hole: pieces left and right at full height, others below and above it."""
    left, bottom, right, top = hole
    hit = (boxes[:, 0] < right - small) & (boxes[:, 2] > left + small)
    hit &= (boxes[:, 1] < top - small) & (boxes[:, 3] > bottom + small)
    if not hit.any():
        return boxes
    b = boxes[hit]
    x0, x1 = np.clip(left, b[:, 0], b[:, 2]), np.clip(right, b[:, 0], b[:, 2])
    y0, y1 = np.clip(bottom, b[:, 1], b[:, 3]), np.clip(top, b[:, 1], b[:, 3])
    pieces = np.concatenate(
        [
            np.stack([b[:, 0], b[:, 1], x0, b[:, 3]], axis=1),
            np.stack([x1, b[:, 1], b[:, 2], b[:, 3]], axis=1),
            np.stack([x0, b[:, 1], x1, y0], axis=1),
            np.stack([x0, y1, x1, b[:, 3]], axis=1),
        ]
    )
    pieces = pieces[(pieces[:, 2] - pieces[:, 0] > small) & (pieces[:, 3] - pieces[:, 1] > small)]
    kept = np.concatenate([boxes[~hit], pieces])
    return kept[np.lexsort((kept[:, 1], kept[:, 0]))]


def _corners(boxes: np.ndarray) -> np.ndarray:
    """Corners of boxes (n, 4), counter-clockwise, (n, 4, 2)."""
    x0, y0, x1, y1 = boxes.T
    return np.stack([x0, y0, x1, y0, x1, y1, x0, y1], axis=1).reshape(-1, 4, 2)
