"""Generate herringbone masonry (opus spicatum) and reticulate work (opus reticulatum): equal inclined stones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, Positive, check_count
from dem_cli.core.arithmetic.products import product
from dem_cli.core.model.blocks import Block
from dem_cli.input_limits import MOST_STONES
from dem_cli.masonry.structures.patterns.cut import within
from dem_cli.masonry.structures.patterns.panel import fitted
from dem_cli.masonry.structures.patterns.pattern_wall import PatternWall, masonry
from dem_cli.masonry.structures.patterns.tiling import Loop, Tiling

SHORTEST = 0.02  # of the mean side: shorter edges at openings collapse


class HerringboneWall(PatternWall):
    """Wall of equal inclined stones. Local origin: lower left corner of the wall, on top of its base; in 3D half of the
    thickness lies to either side. Stones at its edges are cut; what is below a quarter of a stone is one with another.

    Block names: "<id>-<number>" from 1, from the lowest stone up, in rows "<id>-<row>-<number>"; "<id>-base";
    "<id>-quoin-left-<number>", "<id>-quoin-right-<number>"; "<id>-lintel-<opening>", "<id>-arch-<opening>-<number>";
    "<id>-side-<number>", "<id>-side-<number>-left" and so on.
    """

    kind: Literal["herringbone-wall"] = "herringbone-wall"
    block: tuple[Positive, Positive] = Field(
        description="length and height of a stone [m]", examples=[[0.2, 0.1]], json_schema_extra={"maxItems": 2}
    )
    bond: Literal["interlocked", "rows"] = Field(
        "interlocked",
        description="interlocked: each stone ends at the long side of the next one, its length is a whole number of "
        "heights, of one height reticulate work; rows: level rows of stones that lean right and left in turn",
    )
    angle_deg: float = Field(45.0, ge=20.0, le=70.0, description="of the stones from the level [deg]", examples=[45.0])

    @model_validator(mode="after")
    def _whole_number_of_heights(self) -> HerringboneWall:
        length, height = self.block
        if length < height * (1.0 - 1e-9):
            raise KeyProblem(f"a length of {length:g} is not allowed; must be at least the height, {height:g}", "block")
        if self.bond == "interlocked" and abs(length / height - round(length / height)) > 1e-6:
            near = round(length / height) * height
            message = f"a length of {length:g} is not allowed; must be a whole number of heights, such as {near:.4g}"
            raise KeyProblem(f"{message}, else stones do not interlock", "block")
        diagonal = math.hypot(*self.extent)
        if length > diagonal * (1.0 + 1e-9):
            message = f"a length of {length:g} is not allowed; must be at most {diagonal:.4g}, the diagonal of the wall"
            raise KeyProblem(message, "block")
        if self.bond == "interlocked":  # each stone is so many squares in a row
            check_count(self.extent[0] * self.extent[1] / height**2, "block")
        count = self.extent[0] * self.extent[1] / (length * height)
        if count > MOST_STONES:
            raise KeyProblem(f"makes {count:.3g} stones; at most {MOST_STONES:,}", "block")
        return self


def build(wall: HerringboneWall) -> list[Block]:
    """Generate the blocks of a herringbone wall: the base first, lintels last."""
    panel = wall.panel
    length, height = np.ptp(panel.outline, axis=0).tolist()
    tiling = {"interlocked": _interlocked, "rows": _rows}[wall.bond](wall, length, height)
    return masonry(wall, fitted(within(tiling, panel.outline), panel, wall.block[0] * wall.block[1], SHORTEST))


def _interlocked(wall: HerringboneWall, length: float, height: float) -> Tiling:
    """Lay stones of n unit squares, n whole, alternately along both axes of the grid."""
    n, side = round(wall.block[0] / wall.block[1]), wall.block[1]
    reach = math.ceil((length + height) / side) + 2 * n
    angle = math.radians(wall.angle_deg)
    along = side * np.array([math.cos(angle), math.sin(angle)])
    up = side * np.array([-math.sin(angle), math.cos(angle)])
    margin, far = wall.block[0], np.array([length, height]) + wall.block[0]
    numbers: dict[tuple[int, int], int] = {}
    stones: list[Loop] = []
    for i in range(-reach, reach + 1):
        for j in _columns(i, n, reach, (along / side).tolist(), (-margin / side, *((far / side).tolist()))):
            where = (i - j) % (2 * n)
            wide, high = (n, 1) if where == 0 else (1, n)
            middle = (i + wide / 2.0) * along + (j + high / 2.0) * up
            if (middle < -margin).any() or (middle > far).any():
                continue
            cells = [(i + k, j) for k in range(wide)] + [(i + wide, j + k) for k in range(high)]
            cells += [(i + wide - k, j + high) for k in range(wide)] + [(i, j + high - k) for k in range(high)]
            stones.append(tuple(numbers.setdefault(cell, len(numbers)) for cell in cells))
    corners = product(np.array(list(numbers)), np.array([along, up]))
    return Tiling(corners, stones, [0] * len(stones))


def _columns(i: int, n: int, reach: int, axis: Sequence[float], ends: tuple[float, float, float]) -> Iterator[int]:
    """Yield the places j of row i of the grid, at most `reach` from its origin, at which stones may begin in the wall.

    n: squares of a stone; axis: direction of rows (cos, sin), of which neither is 0; ends: the least coordinate of
    the middle of a stone and the largest ones along and up [squares].
    """
    (c, s), (least, right, top) = axis, ends
    low = math.floor(max(-reach, (i * c - right) / s - 2 * n, (least - i * s) / c - 2 * n))
    high = math.ceil(min(reach, (i * c - least) / s + 2 * n, (top - i * s) / c + 2 * n))
    for begin in range(low + (i - low) % (2 * n) - 2 * n, high + 1, 2 * n):  # a level one, then an upright one
        yield from (j for j in (begin, begin + 1) if low <= j <= high)


def _rows(wall: HerringboneWall, length: float, height: float) -> Tiling:
    """Lay rows of parallelograms that lean right and left in turn, as high as a stone times the sine of its angle."""
    angle = math.radians(wall.angle_deg)
    rise, run = wall.block[0] * math.sin(angle), wall.block[0] * math.cos(angle)
    width = wall.block[1] / math.sin(angle)
    rows = math.ceil(height / rise - 1e-9)
    count = math.ceil((length + run) / width) + 2
    corners = [(i * width - run * (1 - k % 2), k * rise) for k in range(rows + 1) for i in range(-1, count + 1)]
    stones: list[Loop] = []
    for k in range(rows):
        for i in range(count + 1):
            low, high = k * (count + 2) + i, (k + 1) * (count + 2) + i
            stones.append((low, low + 1, high + 1, high))
    return Tiling(np.array(corners), stones, [k + 1 for k in range(rows) for _ in range(count + 1)])


def loose_ends(wall: HerringboneWall) -> str:
    """Return the key by which stones may slide out at free ends; "": none."""
    return "angle_deg" if wall.has_free_ends else ""
