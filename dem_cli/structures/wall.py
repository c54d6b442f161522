"""Walls of rectangular blocks in courses."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase
from dem_cli.geometry.polygon import rectangle
from dem_cli.model.blocks import Block
from dem_cli.structures.bases import base_block
from dem_cli.structures.sides import Side, SupportedWall, side_blocks

MOST_BLOCKS = 1_000_000
NARROWEST_PIECE = 1e-6  # parts of a block below this fraction of its length or height are not made


class Lintel(CaseModel):
    """One block over an opening, in place of whatever it crosses."""

    height: Positive = Field(description="height [m]", examples=[0.2])
    bearing: NonNegative = Field(description="length that rests on the wall at each side [m]", examples=[0.15])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["wood"])


class Opening(CaseModel):
    """A rectangular hole; blocks that it cuts keep what is left of them as rectangles."""

    x: NonNegative = Field(description="left edge, from the left end of the wall [m]", examples=[0.8])
    y: NonNegative = Field(description="lower edge, from the foot of the wall [m]", examples=[0.0])
    width: Positive = Field(description="width [m]", examples=[0.9])
    height: Positive = Field(description="height [m]", examples=[2.0])
    lintel: Lintel | None = Field(
        None, description="a block over the opening; default: none", examples=[{"height": 0.2, "bearing": 0.15}]
    )


class Wall(StructureBase):
    """Blocks in courses from the bottom up. Local origin: lower left corner of the wall, on top of its base.

    In 3D half of the thickness lies to either side of the origin.

    Block names: "<id>-<course>-<number>", both from 1, numbers from left to right; "<id>-base";
    "<id>-lintel-<number of the opening>"; "<id>-side-<number>", "<id>-side-<number>-left" and so on.
    """

    kind: Literal["wall"] = "wall"
    block: tuple[Positive, Positive] = Field(
        description="length and height of a full block, in 3D its thickness may follow [m]",
        examples=[[0.4, 0.2]],
        json_schema_extra={"maxItems": 3},
    )
    courses: int = Field(ge=1, le=10_000, description="number of courses", examples=[12])
    blocks_per_course: int = Field(
        ge=1,
        le=10_000,
        description="full blocks in a full course: the wall is this many block lengths long",
        examples=[8],
    )
    bond: Literal["running", "stack"] | None = Field(
        None,
        description="running: every other course is shifted by half a block; stack: none is; default: running",
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
    openings: tuple[Opening, ...] = Field(
        (), description="doors and windows", examples=[[{"x": 0.8, "y": 0.0, "width": 0.9, "height": 2.0}]]
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
    def length(self) -> float:
        """Length of a full course [m]."""
        return self.block[0] * self.blocks_per_course

    @property
    def base_depth(self) -> float:
        """Height of the base [m]."""
        return self.base_height or self.block[1]

    @property
    def levels(self) -> np.ndarray:
        """Heights of the bed joints from the foot to the top [m], (courses + 1,)."""
        if self.course_heights:
            return np.concatenate([[0.0], np.cumsum(self.course_heights)])
        return np.arange(self.courses + 1) * self.block[1]

    @model_validator(mode="after")
    def _not_too_many(self) -> Wall:
        lengths = self.course_lengths or (self.block[0],) * self.courses
        count = sum(self.length / length for length in lengths)
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
            if length > self.length * (1 + NARROWEST_PIECE):
                message = f"{length:g} is not allowed; must be at most {self.length:g}, the length of the wall"
                raise KeyProblem(message, "course_lengths", i)
        for i, side in enumerate(self.sides):
            _check_side(self, side, i)
        for i, opening in enumerate(self.openings):
            _check_opening(opening, i, self.length, float(self.levels[-1]))
        return self


def _check_side(wall: Wall, side: Side, i: int) -> None:
    """Raises KeyProblem where a side does not fit the wall."""
    widest = side.widest(wall.length)
    if side.strip is not None and side.strip > widest * (1.0 + NARROWEST_PIECE):
        of = f"{'half ' if side.ends == 'both' else ''}the length of the wall"
        raise KeyProblem(f"{side.strip:g} is not allowed; must be at most {widest:g}, {of}", "sides", i, "strip")
    if wall.ends == "toothed" and not side.long:
        raise KeyProblem(
            f"'{side.face}' is not allowed with ends = 'toothed': the ends are not plane", "sides", i, "face"
        )


def _check_opening(opening: Opening, i: int, length: float, height: float) -> None:
    """Raises KeyProblem where the opening or its lintel does not lie within the wall."""
    slack = 1.0 + NARROWEST_PIECE
    limits = [
        ("width", opening.x + opening.width, length, "x + width", "length"),
        ("height", opening.y + opening.height, height, "y + height", "height"),
    ]
    for key, value, limit, what, name in limits:
        if value > limit * slack:
            message = f"{what} = {value:g} is not allowed; must be at most the {name} of the wall, {limit:g}"
            raise KeyProblem(message, "openings", i, key)
    if opening.lintel is None:
        return
    bearing, top = opening.lintel.bearing, opening.y + opening.height + opening.lintel.height
    room = min(opening.x, length - opening.x - opening.width)
    if bearing > room + NARROWEST_PIECE * length:
        message = f"{bearing:g} is not allowed; must be at most {room:g}, what is left beside the opening"
        raise KeyProblem(message, "openings", i, "lintel", "bearing")
    if top > height * slack:
        message = f"the lintel would reach up to {top:g}; the wall is {height:g} high"
        raise KeyProblem(message, "openings", i, "lintel", "height")


def build(wall: Wall) -> list[Block]:
    """Blocks in local coordinates, course by course from below, the base first, lintels last."""
    boxes = [_course(wall, k) for k in range(wall.courses)]
    holes = [(o.x, o.y, o.x + o.width, o.y + o.height) for o in wall.openings]
    lintels = [_lintel_box(o) for o in wall.openings]
    blocks = []
    if wall.base:
        left = min(box[0, 0] for box in boxes) - wall.base_extension
        right = max(box[-1, 2] for box in boxes) + wall.base_extension
        shape = rectangle(left, -wall.base_depth, right - left, wall.base_depth)
        blocks.append(base_block("base", shape, wall.thickness, wall.base_extension))
    foot = -wall.base_depth if wall.base and not wall.base_extension else 0.0
    blocks += side_blocks(wall.sides, SupportedWall(wall.length, float(wall.levels[-1]), wall.thickness, foot))
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
    if all(block.fixed for block in blocks):
        raise ValueError("the openings leave nothing of the wall")
    return blocks


def _course(wall: Wall, k: int) -> np.ndarray:
    """Boxes [left, bottom, right, top] of course k (from 0), (n, 4), from left to right."""
    length = wall.course_lengths[k] if wall.course_lengths else wall.block[0]
    shift = wall.offset if wall.offset is not None else (0.0 if wall.bond == "stack" else length / 2.0)
    if k % 2 == (0 if wall.first == "full" else 1):
        shift = 0.0
    count = round(wall.length / length, 6)
    if wall.ends == "toothed":
        heads = shift + length * np.arange(max(int(count), 1) + 1)
    else:
        inner = shift + length * np.arange(int(np.ceil(count)) + 1)
        small = NARROWEST_PIECE * length
        inner = inner[(inner > small) & (inner < wall.length - small)]
        heads = np.concatenate([[0.0], inner, [wall.length]])
    low, high = wall.levels[k : k + 2]
    ones = np.ones(len(heads) - 1)
    return np.stack([heads[:-1], low * ones, heads[1:], high * ones], axis=1)


def _lintel_box(opening: Opening) -> tuple[float, float, float, float] | None:
    lintel = opening.lintel
    if lintel is None:
        return None
    low = opening.y + opening.height
    return (opening.x - lintel.bearing, low, opening.x + opening.width + lintel.bearing, low + lintel.height)


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
