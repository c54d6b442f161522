"""Generate colonnades and temple fronts in 3D: drum columns, architrave, frieze, cornice and a pediment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase, check_count
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.bases import base_block
from dem_cli.masonry.structures.columns.drums import Shaft, stones_of


class Beam(CaseModel):
    """Architrave, frieze or cornice: a course of beams from end to end of a colonnade."""

    height: Positive = Field(description="height [m]", examples=[0.6])
    thickness: Positive | None = Field(
        None, description="across the front [m]; default: as what is below it", examples=[0.8]
    )
    projection: NonNegative = Field(
        0.0, description="how far it goes beyond the ends of what is below it [m]", examples=[0.25]
    )
    material: str = Field("", description="a name in [materials]; default: that of the structure", examples=["marble"])


class Pediment(CaseModel):
    """Pediment: a triangle on top, as long as the course below it."""

    rise: Positive = Field(description="height of its top over its foot [m]", examples=[1.4])
    thickness: Positive | None = Field(
        None, description="across the front [m]; default: as what is below it", examples=[0.6]
    )
    material: str = Field("", description="a name in [materials]; default: that of the structure", examples=["marble"])


class TempleFront(StructureBase):
    """Round columns in a row along x and what they carry, in 3D. Local origin: in the middle of the front, on the axes
    of the columns, on top of the base.

    Block names: "<id>-<column>-<drum>", columns from the left, drums from below, "<id>-<column>-capital",
    "<id>-<column>-plinth"; "<id>-architrave-<number>" from the left, and so frieze, cornice, pediment; "<id>-base".
    """

    only_in: ClassVar[int | None] = 3

    kind: Literal["temple-front"] = "temple-front"
    columns: int = Field(ge=2, le=1000, description="number of columns", examples=[4])
    spacing: Positive = Field(description="from axis to axis [m]", examples=[2.4])
    column: Shaft = Field(
        description="each of the columns",
        examples=[{"radius": 0.4, "top_radius": 0.32, "height": 4.0, "courses": 5}],
    )
    architrave: Beam = Field(
        description="beams from axis to axis of the columns, at the ends as far as their tops reach",
        examples=[{"height": 0.6, "thickness": 0.8}],
    )
    frieze: Beam | None = Field(
        None,
        description="a course above it, with joints over the middle of the bays; default: none",
        examples=[{"height": 0.5}],
    )
    cornice: Beam | None = Field(
        None,
        description="a course above these, with joints over the columns; default: none",
        examples=[{"height": 0.3, "projection": 0.25}],
    )
    pediment: Pediment | None = Field(
        None,
        description="a triangle on top of all, with joints over the middle of the bays; default: none",
        examples=[{"rise": 1.4}],
    )
    base: bool = Field(True, description="a fixed block below")
    base_height: Positive = Field(0.5, description="height of the base [m]")
    base_extension: NonNegative = Field(0.0, description="how far the base goes beyond the columns [m]", examples=[1.0])

    @property
    def axes(self) -> np.ndarray:
        """Places of the axes of the columns [m], (columns,)."""
        return self.spacing * (np.arange(self.columns) - (self.columns - 1) / 2.0)

    @model_validator(mode="after")
    def _columns_apart(self) -> TempleFront:
        check_count(self.columns * (self.column.courses or 1), "columns")
        widths = {"plinth": self.column.plinth, "capital": self.column.capital}
        widest = max([2.0 * float(self.column.profile.max()), *(part.width for part in widths.values() if part)])
        if self.spacing < widest * (1.0 - 1e-9):
            message = f"{self.spacing:g} is not allowed; must be at least {widest:g}, the width of a column"
            raise KeyProblem(message, "spacing")
        return self


def build(front: TempleFront) -> list[Block]:
    """Generate the blocks of a temple front: base, column by column from below, the courses above, the pediment."""
    axes, shaft = front.axes, front.column
    blocks = []
    if front.base:
        reach, extension = axes[-1] + shaft.foot, front.base_extension
        shape = rectangle(-reach - extension, -front.base_height, 2.0 * (reach + extension), front.base_height)
        blocks.append(base_block("base", shape, 2.0 * shaft.foot, extension))
    for i, x in enumerate(axes.tolist(), 1):
        blocks += stones_of(shaft, x, f"{i}-")
    top = shaft.capital.width if shaft.capital else 2.0 * float(shaft.profile[-1])
    level, end, thickness = shaft.whole_height, float(axes[-1]) + top / 2.0, top
    between = 0.5 * (axes[:-1] + axes[1:])
    courses = (("architrave", front.architrave, axes[1:-1]), ("frieze", front.frieze, between),
               ("cornice", front.cornice, axes[1:-1]))  # fmt: skip
    for name, beam, joints in courses:
        if beam is None:
            continue
        end, thickness = end + beam.projection, beam.thickness or thickness
        heads = [-end, *joints.tolist(), end]
        for k, (left, right) in enumerate(zip(heads[:-1], heads[1:], strict=True), 1):
            shape = rectangle(left, level, right - left, beam.height)
            blocks.append(Block(f"{name}-{k}", (shape,), beam.material, thickness))
        level += beam.height
    if front.pediment:
        thickness = front.pediment.thickness or thickness
        for k, shape in enumerate(_triangle([-end, *between.tolist(), end], level, front.pediment.rise), 1):
            blocks.append(Block(f"pediment-{k}", (shape,), front.pediment.material, thickness))
    return blocks


def _triangle(heads: Sequence[float], level: float, rise: float) -> list[np.ndarray]:
    """Divide a triangle by upright joints, (n, 2) each; `heads`: places of both ends and of the joints [m]."""
    end, shapes = heads[-1], []
    tops = [level + rise * (1.0 - abs(x) / end) for x in heads]
    tops[0] = tops[-1] = level
    for k in range(len(heads) - 1):
        left, right = heads[k : k + 2]
        corners = [[left, level], [right, level], [right, tops[k + 1]]]
        if left < 0.0 < right:
            corners.append([0.0, level + rise])
        corners.append([left, tops[k]])
        shapes.append(np.array(list(dict.fromkeys(map(tuple, corners)))))
    return shapes
