"""Table [calibration]: measured values of a structure, and the joint profiles to try (thesis 7.4.1)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Positive, Vector
from dem_cli.case.tables.declared import table_of
from dem_cli.core.laws.profile import ProfileShape, pair

ShapeTable: Any = table_of(ProfileShape)


class NamedShape(ShapeTable):
    """[[calibration.shapes]]: a polygon but for its aperture."""

    name: Annotated[str, Field(min_length=1)] = Field(
        description="as the table and the picture call it", examples=["A"]
    )

    @property
    def share_in_the_middle(self) -> tuple[float, float] | None:
        """Lowest and highest share of the middle side; None where sides vary so that it is unknown."""
        low, high = self.number
        if self.central is not None:
            return pair(self.central)
        if low != high or low % 2 == 0:
            return None
        lengths = [length for length in self.lengths or () if not isinstance(length, tuple)]
        if len(lengths) < len(self.lengths or ()):
            return None
        if len(lengths) < 2:
            return 1.0 / low, 1.0 / low
        share = lengths[low // 2] / sum(lengths)
        return share, share


class Calibration(CaseModel):
    """[calibration]"""

    joint: str = Field(
        default="", description="a name in [joints]: its profile is sought; default: the first one", examples=["dry"]
    )
    failure_load: Positive = Field(description="measured load multiplier at failure [-]", examples=[0.13])
    displacement: Positive = Field(
        description="measured displacement before failure [m], whatever its sign", examples=[0.0115]
    )
    block: str | None = Field(
        default=None, description="id of the block whose centroid was watched", examples=["column-14"]
    )
    point: Vector | None = Field(
        default=None, description="instead of block: a point of the undeformed structure [m]", examples=[[0.0, 0.5]]
    )
    component: Literal["x", "y", "z"] | None = Field(
        default=None, description="of the displacement; default: the length of the vector", examples=["x"]
    )
    apertures: Annotated[tuple[Positive, ...], Field(min_length=1)] = Field(
        description="tried with each shape [m]", examples=[[5e-5, 1e-4]]
    )
    shapes: Annotated[tuple[NamedShape, ...], Field(min_length=1)] = Field(
        description="tried with each aperture", examples=[[{"name": "A", "sides": 3}]]
    )

    @model_validator(mode="after")
    def _one_place_and_different_names(self) -> Calibration:
        if (self.block is None) == (self.point is None):
            found = "'block' and 'point' are" if self.block else "neither 'block' nor 'point' is"
            raise ValueError(f"{found} given; the displacement is that of one of them")
        names = [shape.name for shape in self.shapes]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise KeyProblem(f"'{name}' is used twice, first at shapes.{names.index(name)}", "shapes", i, "name")
        return self
