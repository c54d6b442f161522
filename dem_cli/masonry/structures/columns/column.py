"""Generate columns and piers: one block per course, straight or tapered, with or without a cap."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.bases import base_block


class Drum(CaseModel):
    """Drum of a column: one block, symmetric about the axis."""

    width: Positive = Field(description="width at its foot [m]", examples=[0.5])
    height: Positive = Field(description="height [m]", examples=[0.6])
    top_width: Positive | None = Field(
        None, description="width at its top [m]; default: as at its foot", examples=[0.45]
    )


class Cap(CaseModel):
    """Cap of a column: a rectangular block on top, as a capital or a weight."""

    width: Positive = Field(description="width [m]", examples=[0.7])
    height: Positive = Field(description="height [m]", examples=[0.2])
    material: str = Field("", description="a name in [materials]; default: that of the column", examples=["marble"])


class Column(StructureBase):
    """Column of blocks on top of each other. Local origin: on the axis of the column, at its foot, on top of the base;
    in 3D half of the thickness lies to either side of it.

    Block names: "<id>-<number>" from below, from 1; "<id>-base"; "<id>-cap".
    Shape: `block` and `courses` (tapered with `top_width`), or `drums` one by one.
    """

    kind: Literal["column"] = "column"
    block: tuple[Positive, Positive] | None = Field(
        None,
        description="width at the foot and height of a block, in 3D its thickness may follow [m]",
        examples=[[0.5, 0.4]],
    )
    courses: int | None = Field(None, ge=1, le=10_000, description="number of blocks", examples=[8])
    top_width: Positive | None = Field(
        None,
        description="width at the top of the column [m], tapered from block[0]; default: not tapered",
        examples=[0.4],
    )
    drums: tuple[Drum, ...] = Field(
        (),
        description="the blocks from below, instead of block and courses",
        examples=[[{"width": 0.5, "height": 0.6}, {"width": 0.5, "height": 0.5, "top_width": 0.45}]],
    )
    cap: Cap | None = Field(
        None, description="a block on top of all; default: none", examples=[{"width": 0.7, "height": 0.2}]
    )
    thickness: Positive = Field(1.0, description="depth out of plane [m]")
    base: bool = Field(True, description="a fixed block below, as wide as the lowest block")
    base_height: Positive | None = Field(
        None, description="height of the base [m]; default: as lowest block", examples=[0.3]
    )
    base_extension: NonNegative = Field(
        0.0, description="how far the base goes beyond each side, in 3D also beyond each face [m]", examples=[0.5]
    )

    @model_validator(mode="after")
    def _one_shape(self) -> Column:
        if self.drums:
            for key in ("block", "courses", "top_width"):
                if getattr(self, key) is not None:
                    raise KeyProblem("not allowed beside drums; give drums, or block and courses", key)
            return self
        for key, other in (("block", "courses"), ("courses", "block")):
            if getattr(self, key) is None:
                given = "nothing is given" if getattr(self, other) is None else f"only {other} is given"
                raise KeyProblem(f"a column needs block and courses, or drums; {given}", key)
        return self

    @property
    def profile(self) -> list[Drum]:
        """Drums of the column from below, whichever way they were given."""
        if self.block is None or self.courses is None:
            return list(self.drums)
        width, height = self.block
        widths = np.linspace(width, self.top_width or width, self.courses + 1)
        ends = zip(widths[:-1].tolist(), widths[1:].tolist(), strict=True)
        return [Drum(width=foot, height=height, top_width=top) for foot, top in ends]


def build(column: Column) -> list[Block]:
    """Generate the blocks of a column from below, the base first, the cap last."""
    drums = column.profile
    levels = _levels(column, drums)
    blocks = []
    if column.base:
        half = drums[0].width / 2.0 + column.base_extension
        height = column.base_height or drums[0].height
        shape = rectangle(-half, -height, 2.0 * half, height)
        blocks.append(base_block("base", shape, column.thickness, column.base_extension))
    for k, drum in enumerate(drums):
        foot, head = drum.width / 2.0, (drum.top_width or drum.width) / 2.0
        low, high = levels[k : k + 2]
        shape = np.array([[-foot, low], [foot, low], [head, high], [-head, high]])
        blocks.append(Block(f"{k + 1}", (shape,), "", column.thickness, course=k + 1))
    if column.cap:
        cap = column.cap
        shape = rectangle(-cap.width / 2.0, levels[-1], cap.width, cap.height)
        blocks.append(Block("cap", (shape,), cap.material, column.thickness))
    return blocks


def _levels(column: Column, drums: list[Drum]) -> np.ndarray:
    """Return the heights of the joints [m], (n + 1,)."""
    if column.block is None or column.courses is None:
        return np.concatenate([[0.0], np.cumsum([drum.height for drum in drums])])
    return np.arange(column.courses + 1) * column.block[1]
