"""Sides of a wall in 3D: fixed columns or slabs behind its whole length or in strips at its ends."""

from __future__ import annotations

from typing import Literal, NamedTuple

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Positive
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block


class Side(CaseModel):
    """structure.sides: a fixed support behind a face of a wall; the wall touches it and may leave it."""

    face: Literal["-y", "+y", "-x", "+x"] = Field(
        description="the face that is supported, before the wall is turned; -y, +y: a long one; -x, +x: an end",
        examples=["-y"],
    )
    strip: Positive | None = Field(
        default=None,
        description="of a long face: width of the columns behind its ends [m]; default: the whole length",
        examples=[0.8],
    )
    ends: Literal["both", "left", "right"] = Field(
        default="both", description="with strip: behind which ends of the wall, left is x = 0"
    )
    reach: Positive | None = Field(
        default=None,
        description="how far they reach away from the face [m]; default: strip, else the wall's thickness",
        examples=[0.8],
    )
    height: Positive | None = Field(
        default=None, description="height above the foot of the wall [m]; default: that of the wall", examples=[8.0]
    )
    material: str = Field(default="", description="a name in [materials]; default: that of the wall", examples=["rock"])

    @model_validator(mode="after")
    def _strips_of_long_faces(self) -> Side:
        if self.strip is None and "ends" in self.model_fields_set:
            raise KeyProblem("not used without strip, the width of the columns", "ends")
        if self.strip is not None and not self.long:
            raise KeyProblem(f"not allowed with face = '{self.face}': an end is supported as a whole", "strip")
        return self

    @property
    def long(self) -> bool:
        """Tell whether the side is behind a long face of the wall."""
        return self.face[1] == "y"

    def widest(self, length: float) -> float:
        """Return the largest possible width of the strips [m]."""
        return length / 2.0 if self.ends == "both" else length


class SupportedWall(NamedTuple):
    """Dimensions of a wall with fixed sides [m]."""

    length: float
    height: float
    thickness: float
    foot: float  # where sides begin: as deep as a base that has no margin, else at the foot of the wall


def side_blocks(sides: tuple[Side, ...], wall: SupportedWall) -> list[Block]:
    """Create the fixed blocks behind the faces of a wall, in local places."""
    return [block for i, side in enumerate(sides) for block in _behind(side, i, wall)]


def _behind(side: Side, i: int, wall: SupportedWall) -> list[Block]:
    reach, height = side.reach or side.strip or wall.thickness, (side.height or wall.height) - wall.foot
    sign = -1.0 if side.face[0] == "-" else 1.0
    if not side.long:
        start = -reach if sign < 0.0 else wall.length
        shape = rectangle(start, wall.foot, reach, height)
        return [Block(f"side-{i + 1}", (shape,), side.material, wall.thickness, fixed=True)]
    low, high = sorted([sign * wall.thickness / 2.0, sign * (wall.thickness / 2.0 + reach)])
    width = side.strip or wall.length
    strips = {"left": 0.0, "right": wall.length - width}
    named = {f"side-{i + 1}": 0.0}
    if side.strip is not None:
        named = {f"side-{i + 1}-{end}": x for end, x in strips.items() if side.ends in (end, "both")}
    return [
        Block(name, (rectangle(x, wall.foot, width, height),), side.material, fixed=True, across=(low, high))
        for name, x in named.items()
    ]
