"""Vectors of a case file: points, directions, forces and turns with as many components as the case has dimensions."""

from __future__ import annotations

from typing import Any, NamedTuple

from pydantic import GetCoreSchemaHandler, ValidationInfo, WrapValidator

from dem_cli.case.wording import show

OTHER_DIMENSION = "dimension = 3"  # how the message about a vector of another dimension ends


class VectorLength(NamedTuple):
    """Annotation of a tuple of numbers: how many there are, in the plane and in space.

    The dimension is that of the case that is read, in the context of the validation; without one both lengths will do.
    One alone is a number, not a list of one.
    """

    planar: int
    spatial: int

    def in_dimension(self, dimension: int) -> int:
        """Number of components of a vector in the given dimension."""
        return {2: self.planar, 3: self.spatial}[dimension]

    def check(self, value: Any, handler: Any, info: ValidationInfo) -> Any:
        """Validate the number of components of a vector. Raises ValueError with what is allowed."""
        dimension = (info.context or {}).get("dimension")
        wanted = self if dimension is None else (self.in_dimension(dimension),)
        if _length(value) not in wanted:
            raise ValueError(f"{show(value)} is not allowed; must be {self._here(dimension, value)}")
        return handler(value)

    def _here(self, dimension: int | None, value: Any) -> str:
        """Return the allowed length of a vector in words for a case of this dimension."""
        if dimension == 3:
            return f"{_list_of(self.spatial)} in a case with {OTHER_DIMENSION}"
        of_space = _length(value) == self.spatial
        return _list_of(self.planar) + (f" in a case without {OTHER_DIMENSION}" if of_space else "")

    def allowed(self, many: bool = False) -> str:
        """Return the allowed length of a vector in words for both dimensions."""
        spatial = _list_of(self.spatial) if self.planar == 1 else self.spatial
        return f"{_list_of(self.planar, many)} (3D: {spatial})"

    def padded(self, value: float | tuple[float, ...]) -> tuple[float, ...]:
        """Extend a default vector of the plane with zeros to three dimensions."""
        planar = value if isinstance(value, tuple) else (value,)
        return (*planar, *(0.0,) * (self.spatial - self.planar))

    def is_planar(self, value: Any) -> bool:
        """Test whether a value has the length of a vector in the plane."""
        return _length(value) == self.planar

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return WrapValidator(self.check).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        if self.planar > 1:
            return {**handler(schema), "minItems": self.planar, "maxItems": self.spatial}
        number, several = handler(schema)["anyOf"]
        return {"anyOf": [number, {**several, "minItems": self.spatial, "maxItems": self.spatial}]}


def _length(value: Any) -> int:
    """Return the number of components: of a list its length, of a number 1, of anything else 0."""
    if isinstance(value, tuple):
        return len(value) if len(value) > 1 else 0
    return int(isinstance(value, (int, float)) and not isinstance(value, bool))


def _list_of(length: int, many: bool = False) -> str:
    """Describe a list of so many numbers in words."""
    if length == 1:
        return "numbers" if many else "a number"
    return f"{'lists' if many else 'a list'} of {length} numbers"
