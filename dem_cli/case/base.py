"""Base classes of the tables of a case file, strict about key names and frozen after validation.

Sequences are tuples (`tuple[float, float]`, `tuple[float, ...]`); lists from TOML become tuples.
"""

from __future__ import annotations

import math
from types import GenericAlias
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, model_validator

from dem_cli.case.vector import VectorLength
from dem_cli.declarations import KeyProblem
from dem_cli.input_limits import MOST_BLOCKS

Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Name = Annotated[str, Field(min_length=1)]
Pair = tuple[float, float]  # two numbers, whatever the dimension of the case
Vector = Annotated[tuple[float, ...], VectorLength(2, 3)]  # a point, vector or force in the space of the case
Turn = Annotated[float | tuple[float, ...], VectorLength(1, 3)]  # about z; in space axis times angle
Twist = Annotated[tuple[float, ...], VectorLength(3, 6)]  # a vector, then turns: about z, in space about x, y and z


NOTHING = "none"  # joints.NAME.head: head joints are not filled


class CaseModel(BaseModel):
    """Base class of a table of the case file: unknown keys are errors, and values are not coerced between types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _lists_as_tuples(cls, table: Any) -> Any:
        return as_tuples(table)


class Crack(CaseModel):
    """structure.crack: where blocks can crack, and the bonded joint that holds their pieces together until then."""

    joint: Name = Field(description="a name in [joints]: of a law with tension, such as fracture", examples=["crack"])
    at: Annotated[tuple[Share, ...], Field(min_length=1, max_length=25)] = Field(
        default=(0.5,),
        description="where each block is cut across its length, in shares of it, ascending [-]",
        examples=[[0.33, 0.67]],
    )

    @model_validator(mode="after")
    def _in_order(self) -> Crack:
        if any(second <= first for first, second in zip(self.at, self.at[1:], strict=False)):
            raise KeyProblem(f"{list(self.at)} is not allowed; the shares ascend", "at")
        return self


class StructureBase(CaseModel):
    """Keys that every structure generator accepts; a subclass adds `kind: Literal["..."] = "..."` and its own keys.

    After reading, `material` and `id` are filled in; `id` is the prefix of the names of the blocks. `only_in`: the
    only dimension of cases in which there is this kind; None: both.
    """

    only_in: ClassVar[int | None] = None
    no_base: ClassVar[bool | str] = False  # what its key `base` says where it has none

    id: str = Field(
        default="", description="prefix of the block names; default: the kind, made unique", examples=["tower"]
    )
    material: str = Field(
        default="", description="a name in [materials]; may be left out when there is only one", examples=["stone"]
    )
    origin: Vector = Field(
        default=(0.0, 0.0), description="where the structure's own origin is placed [m]", examples=[[3.0, 0.0]]
    )
    rotation_deg: float = Field(
        default=0.0,
        description="turned about its origin, counter-clockwise; in 3D in plan, about the vertical [deg]",
        examples=[5.0],
    )

    crack: Name | Crack | None = Field(
        default=None,
        description="every block that can move is cut across its length into pieces that the joint of this name holds "
        "together: at mid length, or where a table says; default: blocks do not crack",
        examples=["crack"],
    )

    @model_validator(mode="before")
    @classmethod
    def _in_its_dimension(cls, table: Any, info: ValidationInfo) -> Any:
        dimension = (info.context or {}).get("dimension")
        if cls.only_in is not None and dimension is not None and dimension != cls.only_in:
            kind = cls.model_fields["kind"].default
            raise KeyProblem(f"'{kind}' is not allowed in {dimension}D; give dimension = {cls.only_in}", "kind")
        return table

    @model_validator(mode="before")
    @classmethod
    def _thickness_within_size(cls, table: Any, info: ValidationInfo) -> Any:
        """Split a three-number block size of a 3D case, [length, height, thickness], into size and thickness."""
        for key in ("block", "size"):
            size = table.get(key) if isinstance(table, dict) else None
            if isinstance(size, (list, tuple)) and len(size) == 3 and (info.context or {}).get("dimension") == 3:
                if "thickness" in table:
                    raise KeyProblem(f"{key} and thickness say the same; give one of them", "thickness")
                return {**table, key: size[:2], "thickness": size[2]}
        return table

    @property
    def rotation(self) -> float:
        """Angle of rotation of the structure about the origin [rad], counter-clockwise."""
        return math.radians(self.rotation_deg)

    @property
    def cracks(self) -> Crack | None:
        """Return where the blocks of the structure can crack; None: nowhere."""
        return Crack(joint=self.crack) if isinstance(self.crack, str) else self.crack

    @property
    def on_ground(self) -> bool:
        """Tell whether a [ground] block replaces the base of the structure."""
        return True

    def drawn_from(self, seed: int) -> StructureBase:
        """Return the structure with its missing random seed taken from the seed of the case."""
        return self


class RandomStructure(StructureBase):
    """Keys of a structure generator that draws random sizes or positions."""

    seed: int | None = Field(
        default=None, ge=0, description="makes what is random reproducible; default: that of the case", examples=[3]
    )

    def drawn_from(self, seed: int) -> RandomStructure:
        """Return the structure with the seed of the case where it has none of its own."""
        return self if self.seed is not None else self.model_copy(update={"seed": seed})


def check_count(count: float, *keys: str | int) -> None:
    """Raise KeyProblem at a key with which a structure would exceed the largest number of blocks."""
    if count > MOST_BLOCKS:
        raise KeyProblem(f"{count:.3g} blocks are too many; must be at most {MOST_BLOCKS:,}", *keys)


def as_tuples(value: Any) -> Any:
    """Convert every list in a value, at any depth, to a tuple."""
    if isinstance(value, (list, tuple)):
        return tuple(as_tuples(item) for item in value)
    if isinstance(value, dict):
        return {key: as_tuples(item) for key, item in value.items()}
    return value


def one_or_more(table: Any) -> Any:
    """Return the type of a tuple of tables for which one table may stand; `names.complete` makes that one a list."""
    return Annotated[sequence_of(table), OneOrMoreSchema()]


def sequence_of(table: Any) -> Any:
    """Return the type of a tuple of any number of tables of a class known only at run time."""
    return GenericAlias(tuple, (table, ...))


class OneOrMoreSchema:
    """JSON Schema of a list of tables for which a single table may stand."""

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> dict[str, Any]:
        several = handler(core_schema)
        return {"anyOf": [several["items"], several]}
