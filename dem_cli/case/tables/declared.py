"""Tables of case files generated from the declared parameters of laws, links and motions.

A law says what its parameters are (declarations.py); here that becomes a strict table with the same names, types,
limits, descriptions and examples, whose instances are such records too.
"""

from __future__ import annotations

from functools import cache
from types import GenericAlias, UnionType
from typing import Annotated, Any, Self, Union, get_args, get_origin

from pydantic import Field, create_model, model_validator

from dem_cli.case.base import CaseModel
from dem_cli.case.vector import VectorLength
from dem_cli.declarations import Limits, Parameter, Parameters, SpaceLength

MADE: dict[type[Parameters], type[Any]] = {}  # the table of each class, made once


class DeclaredTable(CaseModel):
    """Base class of tables generated from declared parameters, which checks the relations between keys."""

    def __init_subclass__(cls, **options: Any) -> None:
        """Register no declaration: the fields of the subclass are those of a table."""

    @model_validator(mode="after")
    def _relations(self: Any) -> Any:
        self.check()
        return self

    @property
    def names_given(self) -> set[str]:
        """Names of the keys that the case gives explicitly."""
        return self.model_fields_set

    def with_values(self, **values: Any) -> Self:
        """Return a copy of the table with some values replaced, unvalidated."""
        return self.model_copy(update=values)


def table_of(declaring: type[Parameters]) -> type[Any]:
    """Create the table class of a case file from declared parameters; a subclass with the same name."""
    if declaring not in MADE:
        MADE[declaring] = _made(declaring)
    return MADE[declaring]


def _made(declaring: type[Parameters]) -> type[Any]:
    fields: dict[str, Any] = {name: _field(one) for name, one in declaring.declared.items()}
    bases: Any = (DeclaredTable, declaring)
    return create_model(
        declaring.__name__,
        __base__=bases,
        __module__=declaring.__module__,
        __doc__=declaring.__doc__,
        **fields,
    )


def _field(one: Parameter) -> tuple[Any, Any]:
    """Return annotation and field of a declared parameter."""
    options: dict[str, Any] = {**one.words, **one.limits.named}
    return _in_a_case(one.kind), Field(default=one.default, **options)


@cache
def _in_a_case(kind: Any) -> Any:
    """Convert an annotated type for a case file: records become tables, vectors get the length of the dimension."""
    origin, parts = get_origin(kind), get_args(kind)
    if isinstance(kind, type) and issubclass(kind, Parameters):
        return table_of(kind)
    if origin is Annotated:
        return Annotated[(_in_a_case(parts[0]), *map(_limit, parts[1:]))]
    if origin in (Union, UnionType):
        return Union[tuple(map(_in_a_case, parts))]  # noqa: UP007 (a tuple of members)
    if origin is tuple:
        return GenericAlias(tuple, tuple(map(_in_a_case, parts)))
    return kind


def _limit(limit: Limits | SpaceLength) -> Any:
    """Convert a declared limit to a limit of a table field."""
    return VectorLength(*limit) if isinstance(limit, SpaceLength) else Field(**limit.named)
