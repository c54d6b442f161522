"""Generate columns of round drums in 3D: straight, tapered or with entasis, on a plinth, with a capital."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase
from dem_cli.core.geometry.frusta import frustum, regular
from dem_cli.core.geometry.polyhedron import Polyhedron, box
from dem_cli.core.model.blocks import Block


class Capital(CaseModel):
    """Capital of one stone: an echinus that widens from the shaft, and a square abacus on it."""

    width: Positive = Field(description="of the abacus [m]", examples=[1.1])
    height: Positive = Field(description="of the abacus [m]", examples=[0.2])
    echinus: Positive = Field(description="height of the echinus below it [m]", examples=[0.2])
    material: str = Field("", description="a name in [materials]; default: that of the column", examples=["marble"])


class Plinth(CaseModel):
    """Plinth: a square block below the shaft."""

    width: Positive = Field(description="width [m]", examples=[1.2])
    height: Positive = Field(description="height [m]", examples=[0.25])
    material: str = Field("", description="a name in [materials]; default: that of the column", examples=["marble"])


class Shaft(CaseModel):
    """Shaft of a round column, shared by kind "drums" and the columns of a temple front."""

    radius: Positive | None = Field(None, description="at the foot of the shaft, to the corners [m]", examples=[0.45])
    top_radius: Positive | None = Field(None, description="at its top [m]; default: as at the foot", examples=[0.36])
    height: Positive | None = Field(None, description="of the shaft [m]", examples=[4.5])
    courses: int | None = Field(None, ge=1, le=10_000, description="number of drums", examples=[5])
    entasis: NonNegative = Field(
        0.0, description="by how much it bulges half way up, a parabola over its height [m]", examples=[0.01]
    )
    radii: tuple[Positive, ...] = Field(
        (),
        description="at each joint from the foot to the top [m], instead of radius, top_radius and entasis",
        examples=[[0.45, 0.45, 0.42, 0.38]],
    )
    heights: tuple[Positive, ...] = Field(
        (), description="of each drum from below [m], instead of height and courses", examples=[[1.2, 1.1, 1.0]]
    )
    sides: int = Field(
        24, ge=3, le=360, description="of the polygon that a round drum is; its corners are on the circle"
    )
    plinth: Plinth | None = Field(
        None, description="a square block below the shaft; default: none", examples=[{"width": 1.2, "height": 0.25}]
    )
    capital: Capital | None = Field(
        None,
        description="on top of the shaft; default: none",
        examples=[{"width": 1.1, "height": 0.2, "echinus": 0.2}],
    )

    @model_validator(mode="after")
    def _one_shape(self) -> Shaft:
        _either(self, ("heights",), ("height", "courses"))
        _either(self, ("radii",), ("radius",), ("top_radius", "entasis"))
        if self.radii and len(self.radii) != len(self.joints):
            message = (
                f"{len(self.radii)} values; must be one for each of the {len(self.joints)} joints, foot and top too"
            )
            raise KeyProblem(message, "radii")
        narrow, wide = self.profile[0], self.profile[-1]
        if self.plinth and self.plinth.width < 2.0 * narrow * (1.0 - 1e-9):
            message = (
                f"{self.plinth.width:g} is not allowed; must be at least {2.0 * narrow:g}, as the foot of the shaft"
            )
            raise KeyProblem(message, "plinth", "width")
        if self.capital and self.capital.width < 2.0 * wide * (1.0 - 1e-9):
            message = f"{self.capital.width:g} is not allowed; must be at least {2.0 * wide:g}, as the top of the shaft"
            raise KeyProblem(message, "capital", "width")
        return self

    @property
    def joints(self) -> np.ndarray:
        """Heights of the joints of the shaft from its foot to its top [m], (drums + 1,)."""
        if self.heights:
            return np.concatenate([[0.0], np.cumsum(self.heights)])
        courses = self.courses or 1
        return (self.height or 0.0) * np.arange(courses + 1) / courses

    @property
    def profile(self) -> np.ndarray:
        """Radii at the joints [m], (drums + 1,)."""
        if self.radii or self.radius is None:
            return np.array(self.radii)
        up = self.joints / self.joints[-1]
        return (
            self.radius + up * ((self.top_radius or self.radius) - self.radius) + 4.0 * self.entasis * up * (1.0 - up)
        )

    @property
    def foot(self) -> float:
        """Half the width of the plinth or of the lowest drum [m]."""
        return self.plinth.width / 2.0 if self.plinth else float(self.profile[0])

    @property
    def whole_height(self) -> float:
        """Height from the ground to the top of the capital [m]."""
        capital = self.capital.height + self.capital.echinus if self.capital else 0.0
        return float(self.joints[-1]) + (self.plinth.height if self.plinth else 0.0) + capital


def _either(shaft: Shaft, one: tuple[str, ...], other: tuple[str, ...], others: tuple[str, ...] = ()) -> None:
    """Raise KeyProblem unless all keys of one of two alternatives are given, and none of the other."""
    given = [key for key in (*other, *others) if key in shaft.model_fields_set and getattr(shaft, key) is not None]
    if getattr(shaft, one[0]) and given:
        raise KeyProblem(f"not allowed beside {one[0]}; give {one[0]}, or {' and '.join(other)}", given[0])
    for key in other:
        if not getattr(shaft, one[0]) and getattr(shaft, key) is None:
            raise KeyProblem(f"missing: a shaft needs {' and '.join(other)}, or {one[0]}", key)


class DrumColumn(Shaft, StructureBase):
    """Column of round drums in 3D. Local origin: on the axis, at the foot, on top of the base.

    Block names: "<id>-<number>" from below, from 1; "<id>-plinth"; "<id>-capital"; "<id>-base".
    """

    only_in: ClassVar[int | None] = 3

    kind: Literal["drums"] = "drums"
    base: bool = Field(True, description="a fixed block below, as wide as the foot")
    base_height: Positive | None = Field(
        None, description="height of the base [m]; default: as the lowest block", examples=[0.3]
    )
    base_extension: NonNegative = Field(0.0, description="how far the base goes beyond each side [m]", examples=[0.5])


def build(column: DrumColumn) -> list[Block]:
    """Generate the blocks of a drum column from below: base, plinth, drums, capital."""
    blocks = stones_of(column, 0.0)
    if not column.base:
        return blocks
    height = column.base_height or (column.plinth.height if column.plinth else float(column.joints[1]))
    half = column.foot + column.base_extension
    return [Block("base", (box([-half, -half, -height], [half, half, 0.0]),), "", fixed=True), *blocks]


def stones_of(shaft: Shaft, x: float, prefix: str = "") -> list[Block]:
    """Generate the blocks of a column whose axis is at x [m], from below, without base."""
    blocks = []
    lift, radii, joints = 0.0, shaft.profile, shaft.joints
    if shaft.plinth:
        lift = shaft.plinth.height
        blocks.append(Block(f"{prefix}plinth", (_square(x, shaft.plinth.width, 0.0, lift),), shaft.plinth.material))
    rings = [_ring(shaft, x, float(r), float(z) + lift) for r, z in zip(radii, joints, strict=True)]
    for k, (low, high) in enumerate(zip(rings[:-1], rings[1:], strict=True), 1):
        blocks.append(Block(f"{prefix}{k}", (frustum(low, high),), "", course=k))
    if shaft.capital:
        capital, top = shaft.capital, float(joints[-1]) + lift
        level = top + capital.echinus
        echinus = frustum(rings[-1], _ring(shaft, x, capital.width / 2.0, level))
        abacus = _square(x, capital.width, level, level + capital.height)
        blocks.append(Block(f"{prefix}capital", (echinus, abacus), capital.material))
    return blocks


def _ring(shaft: Shaft, x: float, radius: float, height: float) -> np.ndarray:
    return regular(radius, shaft.sides, height) + np.array([x, 0.0, 0.0])


def _square(x: float, width: float, low: float, high: float) -> Polyhedron:
    return box([x - width / 2.0, -width / 2.0, low], [x + width / 2.0, width / 2.0, high])
