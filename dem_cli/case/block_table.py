"""Table [[block]]: blocks drawn by hand, by their corners; in 3D by corners, faces, convex parts, or as a prism."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, ValidationInfo, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Name, Pair, Positive, Vector
from dem_cli.case.wording import show
from dem_cli.input_limits import MOST_CORNERS

Corners = Annotated[tuple[Vector, ...], Field(min_length=3, max_length=MOST_CORNERS)]
Face = Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(min_length=3, max_length=MOST_CORNERS)]
Faces = Annotated[tuple[Face, ...], Field(min_length=4)]
TETRAHEDRON = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
TETRAHEDRON_FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
SHAPES = ("vertices", "parts", "polygon")  # ways to draw a block


class BlockPart(CaseModel):
    """block.parts: one convex piece of a block in 3D."""

    vertices: Corners = Field(description="corners, in any order [m]", examples=[TETRAHEDRON])
    faces: Faces | None = Field(
        default=None,
        description="of each face the numbers of its corners, from 0, around it; default: those of the hull",
        examples=[TETRAHEDRON_FACES],
    )


class BlockTable(CaseModel):
    """[[block]]: one block, drawn by hand.

    In 3D by `vertices` (of their hull), by `vertices` and `faces`, by `parts`, or by `polygon` and `y` (a prism).
    """

    id: Name = Field(description="name of the block", examples=["lintel"])
    vertices: Corners | None = Field(
        default=None,
        description="corners of a convex block, in any order [m]",
        examples=[[[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.0, 0.3]]],
    )
    faces: Faces | None = Field(
        default=None,
        description="of each face the numbers of its corners, from 0, around it; default: those of the hull",
        examples=[TETRAHEDRON_FACES],
    )
    polygon: Annotated[tuple[Pair, ...], Field(min_length=3, max_length=MOST_CORNERS)] | None = Field(
        default=None,
        description="instead of vertices: corners [x, z] of a prism, convex, in any order [m]",
        examples=[[[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.0, 0.3]]],
    )
    y: Pair | None = Field(
        default=None, description="with polygon: from where to where it goes [m]", examples=[[0.0, 0.4]]
    )
    parts: Annotated[tuple[Corners | BlockPart, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="instead of vertices: convex pieces of a concave block, which move as one; in 3D also as tables "
        "with vertices and faces [m]",
        examples=[[[[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]], [[0.4, 0.0], [0.4, 0.4], [0.0, 0.4]]]],
    )
    material: str = Field(
        default="", description="a name in [materials]; may be left out when there is only one", examples=["stone"]
    )
    thickness: Positive = Field(default=1.0, description="depth out of plane [m]")
    fixed: bool = Field(default=False, description="cannot move (base, support)", examples=[True])

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> BlockTable:
        given = [key for key in SHAPES if getattr(self, key) is not None]
        if len(given) > 1:
            listed = " and ".join(f"'{key}'" for key in given)
            raise ValueError(f"{listed} are given; a block has one of them")
        if not given:
            raise ValueError("neither 'vertices' nor 'parts' is given; a block has one of them")
        if self.faces is not None and self.vertices is None:
            raise KeyProblem(f"not allowed with '{given[0]}'; faces are those of vertices", "faces")
        in_plane = (info.context or {}).get("dimension") == 2  # which is refused for what it is
        if (self.polygon is None) != (self.y is None) and not in_plane:
            raise KeyProblem("missing; a prism has a polygon in x and z, and goes from y[0] to y[1]",
                             "polygon" if self.polygon is None else "y")  # fmt: skip
        if self.y is not None and not self.y[0] < self.y[1]:
            raise KeyProblem(f"{show(self.y)} is not allowed; the second value is the larger one", "y")
        return self
