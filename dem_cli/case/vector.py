"""Vectors of a case file: points, directions and forces with as many components as the case has dimensions."""

from __future__ import annotations

from typing import Any, NamedTuple

from pydantic import GetCoreSchemaHandler, ValidationInfo, WrapValidator

from dem_cli.case.wording import show

OTHER_DIMENSION = "dimension = 3"  # how the message about a vector of another dimension ends


class VectorLength(NamedTuple):
    """Annotation of a tuple of numbers: how many there are, in the plane and in space.

    The dimension is that of the case that is read, in the context of the validation; without one both lengths will do.
    """

    planar: int
    spatial: int

    def in_dimension(self, dimension: int) -> int:
        """Numbers of a vector in so many dimensions."""
        return {2: self.planar, 3: self.spatial}[dimension]

    def check(self, value: Any, handler: Any, info: ValidationInfo) -> Any:
        """Raises ValueError, with what is allowed, for what is no list of so many."""
        dimension = (info.context or {}).get("dimension")
        wanted = self if dimension is None else (self.in_dimension(dimension),)
        if not isinstance(value, tuple) or len(value) not in wanted:
            raise ValueError(f"{show(value)} is not allowed; must be {self._here(dimension, value)}")
        return handler(value)

    def _here(self, dimension: int | None, value: Any) -> str:
        """What is allowed in a case of so many dimensions."""
        if dimension == 3:
            return f"a list of {self.spatial} numbers in a case with {OTHER_DIMENSION}"
        of_space = isinstance(value, tuple) and len(value) == self.spatial
        return f"a list of {self.planar} numbers" + (f" in a case without {OTHER_DIMENSION}" if of_space else "")

    def allowed(self, many: bool = False) -> str:
        """What is allowed in a case of any dimension."""
        return f"{'lists' if many else 'a list'} of {self.planar} numbers (3D: {self.spatial})"

    def padded(self, value: tuple[float, ...]) -> tuple[float, ...]:
        """A default that is given for the plane, in space."""
        return (*value, *(0.0,) * (self.spatial - self.planar))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return WrapValidator(self.check).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {**handler(schema), "minItems": self.planar, "maxItems": self.spatial}
