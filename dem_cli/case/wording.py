"""Phrases of messages about a case: what is allowed, the value found, the nearest name."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

import annotated_types as limits
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from dem_cli.declarations import show

MOST_NAMES = 27  # names beyond this are not listed
NUMBER_WORDS = {float: ("a number", "numbers"), int: ("an integer", "integers")}
TEXT_WORDS = {str: ("a string", "strings"), bool: ("true or false", "true or false")}
LIMIT_SIGNS = {limits.Gt: ("gt", ">"), limits.Ge: ("ge", "≥"), limits.Lt: ("lt", "<"), limits.Le: ("le", "≤")}


class DeclaredType(NamedTuple):
    """Declared type of a key without Annotated and None, with the limits on its value."""

    type: Any
    limits: tuple[Any, ...] = ()

    @property
    def choices(self) -> tuple[DeclaredType, ...]:
        """Members of a union type; any other type alone."""
        if get_origin(self.type) not in (Union, UnionType) or any(hasattr(limit, "allowed") for limit in self.limits):
            return (self,)
        return tuple(choice for member in get_args(self.type) for choice in kind_of(member).choices)


def kind_of(declared: Any, metadata: Iterable[Any] = ()) -> DeclaredType:
    """Remove Annotated and None from a declared type, keeping the limits."""
    found = list(metadata)
    while True:
        arguments = get_args(declared)
        if get_origin(declared) is Annotated:
            declared = arguments[0]
            found += arguments[1:]
        elif NoneType in arguments and get_origin(declared) in (Union, UnionType):
            members = tuple(member for member in arguments if member is not NoneType)
            declared = Union[members]  # noqa: UP007 (a tuple of members)
        else:
            parts = [item.metadata if isinstance(item, FieldInfo) else (item,) for item in found]
            return DeclaredType(declared, tuple(part for some in parts for part in some))


def is_table(declared: Any) -> bool:
    """Test whether a declared type is a table of the case file."""
    return isinstance(declared, type) and issubclass(declared, BaseModel)


def allowed(kinds: Iterable[DeclaredType], many: bool = False) -> str:
    """Describe the allowed types and limits in words: `a number > 0 or 'auto'`."""
    choices = [choice for kind in kinds for choice in kind.choices]
    return " or ".join(dict.fromkeys(allowed_one(choice, many) for choice in choices))


def allowed_one(kind: DeclaredType, many: bool = False) -> str:
    """Describe one allowed type in words; `many` for the plural."""
    declared, arguments, origin = kind.type, get_args(kind.type), get_origin(kind.type)
    pairs = [(limit, sign) for sign in LIMIT_SIGNS for limit in kind.limits if isinstance(limit, sign)]
    bounds = [f"{LIMIT_SIGNS[sign][1]} {show(getattr(limit, LIMIT_SIGNS[sign][0]))}" for limit, sign in pairs]
    least = next((limit.min_length for limit in kind.limits if isinstance(limit, limits.MinLen)), 0)
    if declared in NUMBER_WORDS:
        return " ".join([NUMBER_WORDS[declared][many], " and ".join(bounds)]).strip()
    if declared is str and least:
        return "non-empty strings" if many else "a non-empty string"
    if declared in TEXT_WORDS:
        return TEXT_WORDS[declared][many]
    if origin is Literal:
        return either(arguments)
    if origin is dict or is_table(declared):
        return "tables" if many else "a table" + (" with at least one entry" if least else "")
    own_words = next((limit.allowed for limit in kind.limits if hasattr(limit, "allowed")), None)
    if own_words is not None:  # an annotation such as VectorLength
        return str(own_words(many))
    if origin in (tuple, list):
        variable = origin is list or arguments[-1] is Ellipsis
        most = next((limit.max_length for limit in kind.limits if isinstance(limit, limits.MaxLen)), 0)
        range_ = " and ".join([f"at least {least}"] * bool(least) + [f"at most {most:,}"] * bool(most))
        count = (f"{range_} " if range_ else "") if variable else f"{len(arguments)} "
        return f"{'lists' if many else 'a list'} of {count}{allowed((kind_of(arguments[0]),), many=True)}"
    return "something else"


def literals(kinds: Iterable[DeclaredType]) -> list[str]:
    """List the literal names that the types allow."""
    choices = [choice.type for kind in kinds for choice in kind.choices]
    return [name for choice in choices if get_origin(choice) is Literal for name in get_args(choice)]


def not_allowed(value: Any, kinds: Iterable[DeclaredType]) -> str:
    """Return the message for a value that is not allowed, with a hint for a nearly right name."""
    kinds = tuple(kinds)
    hint = nearest(value, literals(kinds)) if isinstance(value, str) else ""
    must = f"must be {allowed(kinds)}"
    return f"{show(value)} is not allowed" + (f", {hint} ({must})" if hint else f"; {must}")


def unknown_name(what: str, value: Any, names: Sequence[str]) -> str:
    """Return the message for an unknown name, with the nearest and all allowed ones."""
    hint = nearest(value, names)
    return f"unknown {what} {show(value)}{hint and ', ' + hint} (allowed: {listing(names)})"


def nearest(value: Any, names: Iterable[Any]) -> str:
    """Suggest the nearest name, `did you mean 'x'?`; empty where none is near."""
    known = {str(name): name for name in names}
    close = difflib.get_close_matches(str(value), known, 1, 0.6)
    return f"did you mean {show(known[close[0]])}?" if close else ""


def listing(names: Iterable[Any]) -> str:
    """List names to choose from; of very many only the first few."""
    words = [show(name) for name in names]
    if len(words) > MOST_NAMES:
        return f"{', '.join(words[:6])}, ... {len(words)} in all"
    return ", ".join(words) or "none"


def either(names: Sequence[Any]) -> str:
    """Join names with commas and "or": 'a', 'b' or 'c'."""
    words = [show(name) for name in names]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
