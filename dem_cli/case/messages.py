"""Translate validation errors into messages about the case file: value found, what is allowed, the nearest name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel, ValidationError

from dem_cli.case.base import KeyProblem
from dem_cli.case.vector import OTHER_DIMENSION
from dem_cli.case.wording import (
    DeclaredType,
    allowed,
    either,
    is_table,
    kind_of,
    listing,
    literals,
    nearest,
    not_allowed,
    show,
    unknown_name,
)
from dem_cli.errors import CaseProblem, KeyPath
from dem_cli.input_limits import MOST_MISTAKES


class ErrorLocation(NamedTuple):
    """Location of a validation error in the case file.

    kinds: what may stand there; owner: the table around; union, choices: path and members of the union above;
    kin: tables of other kinds or laws, of which a word in the case chose this one.
    """

    path: KeyPath
    kinds: tuple[DeclaredType, ...]
    owner: type[BaseModel] | None
    union: KeyPath | None
    choices: tuple[DeclaredType, ...] = ()
    kin: tuple[DeclaredType, ...] = ()


def problems_from(error: ValidationError, model: type[BaseModel], data: dict[str, Any]) -> list[CaseProblem]:
    """Convert validation errors to one problem per mistake; a value that fits no member of a union is one mistake."""
    found: list[CaseProblem] = []
    unions: dict[KeyPath, list[tuple[ErrorLocation, Any]]] = {}
    errors = error.errors(include_url=False)[:MOST_MISTAKES]
    within = {item["loc"][:k] for item in errors for k in range(len(item["loc"]))}
    for item in errors:
        if item["type"] == "too_short" and item["loc"] in within:  # for want of items that are wrong themselves
            continue
        if item["type"] == "missing" and isinstance(item["loc"][-1], int):  # the list is too short
            item["type"], item["loc"] = "too_short", item["loc"][:-1]
        spot = follow(model, item["loc"], item["type"])
        if spot.union is not None:
            unions.setdefault(spot.union, []).append((spot, item))
        else:
            found.append(describe(spot, item, data))
    for path, members in unions.items():
        inside = [(spot, item) for spot, item in members if len(spot.path) > len(path)]
        deepest = max((len(spot.path) for spot, _ in inside), default=0)
        of_table = [
            (spot, item) for spot, item in members if item["type"] == "value_error" and not spot.path[len(path) :]
        ]
        if not inside and of_table and isinstance(value_at(data, path), dict):  # a table that says something impossible
            found += [describe(spot, item, data) for spot, item in of_table]
        elif inside:
            found += [describe(spot, item, data) for spot, item in inside if len(spot.path) == deepest]
        else:
            kinds = members[0][0].choices
            found.append(CaseProblem(path, not_allowed(value_at(data, path), kinds)))
    meant = {(*p.path[:-1], name) for p in found if p.at_key for name in re.findall("did you mean '(.*)'", p.message)}
    found = [p for p in found if p.path not in meant or not p.message.startswith("missing")]
    found = first_of_list(list(dict.fromkeys(found)))
    rest = error.error_count() - MOST_MISTAKES
    return [*found, CaseProblem((), f"and {rest:,} more mistakes")] if rest > 0 else found


def foremost(found: Sequence[CaseProblem]) -> list[CaseProblem]:
    """Keep the first mistakes of a long list and add how many more there are."""
    rest = len(found) - MOST_MISTAKES
    return [*found[:MOST_MISTAKES], CaseProblem((), f"and {rest:,} more mistakes")] if rest > 0 else [*found]


def first_of_list(found: Sequence[CaseProblem]) -> list[CaseProblem]:
    """Merge the errors of vectors in one list that all have the wrong dimension into the first of them."""
    alike: dict[KeyPath, list[CaseProblem]] = {}
    for problem in found:
        if isinstance(problem.path[-1] if problem.path else "", int) and problem.message.endswith(OTHER_DIMENSION):
            alike.setdefault(problem.path[:-1], []).append(problem)
    more = {several[0]: len(several) - 1 for several in alike.values()}
    left_out = {problem for several in alike.values() for problem in several[1:]}
    return [
        replace(problem, message=f"{problem.message} (and {more[problem]} more in this list)")
        if more.get(problem)
        else problem
        for problem in found
        if problem not in left_out
    ]


def describe(spot: ErrorLocation, item: Any, data: dict[str, Any]) -> CaseProblem:
    """Convert one error of the validator to a problem with key path and message."""
    path, kind = spot.path, item["type"]
    if kind == "extra_forbidden":
        return CaseProblem(path, unknown_key(str(path[-1]), spot.owner, spot.kin), at_key=True)
    if kind in ("value_error", "assertion_error"):
        cause = item["ctx"]["error"]
        keys = cause.keys if isinstance(cause, KeyProblem) else ()
        return CaseProblem(path + keys, str(cause))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        key = item["ctx"]["discriminator"].strip("'")
        tags = [member.type.model_fields[key].annotation for member in spot.choices]
        names = [name for tag in tags for name in get_args(tag)]
        value = value_at(data, (*path, key))
        if kind == "union_tag_not_found":
            return CaseProblem((*path, key), f"missing; must be {either(names)}")
        return CaseProblem((*path, key), unknown_name(key, value, names))
    if kind == "missing":
        meaning = spot.owner.model_fields[str(path[-1])].description if spot.owner else None
        note = f" ({meaning})" if meaning else ""
        return CaseProblem(path, f"missing; must be {allowed(spot.kinds)}{note}")
    value = value_at(data, path)
    names = literals(spot.kinds)
    if kind == "literal_error" and names and isinstance(value, str):
        return CaseProblem(path, unknown_name(str(path[-1]), value, names))
    message = not_allowed(value, spot.kinds)
    if message.endswith("must be a list of tables"):
        message += f", each headed [[{path[-1]}]]"
    return CaseProblem(path, message)


def follow(model: type[BaseModel], loc: Sequence[str | int], error: str) -> ErrorLocation:
    """Follow a validation error's location through the declared types, leaving out the members of unions."""
    path: KeyPath = ()
    kinds: tuple[DeclaredType, ...] = (DeclaredType(model),)
    owner: type[BaseModel] | None = None
    union: KeyPath | None = None
    choices: tuple[DeclaredType, ...] = ()
    kin: tuple[DeclaredType, ...] = ()
    for i, item in enumerate(loc):
        if len(kinds) == 1 and len(kinds[0].choices) > 1:
            members = kinds[0].choices
            tagged = tuple(member for member in members if has_tag(member.type, item))
            if not tagged:
                union, choices = path, members
            kinds, kin = tagged or members, members
            continue
        tables = [kind.type for kind in kinds if is_table(kind.type)]
        inner = tuple(part for kind in kinds for part in element(kind, item))
        last_unknown = error == "extra_forbidden" and i == len(loc) - 1
        if inner or last_unknown:
            path += (item,)
            kinds, owner = inner, tables[0] if tables else owner
    if len(kinds) == 1 and len(kinds[0].choices) > 1:
        choices, kinds = kinds[0].choices, kinds[0].choices
    return ErrorLocation(path, kinds, owner, union, choices, kin)


def element(kind: DeclaredType, item: str | int) -> tuple[DeclaredType, ...]:
    """Return the declared types at a key or index of a value; empty where there is no such part."""
    arguments = get_args(kind.type)
    origin = get_origin(kind.type)
    if is_table(kind.type):
        field = kind.type.model_fields.get(item)
        return (kind_of(field.annotation, field.metadata),) if field is not None else ()
    if origin is dict:
        return (kind_of(arguments[1]),) if item != "[key]" else ()
    if origin in (tuple, list) and isinstance(item, int):
        variable = origin is list or arguments[-1] is Ellipsis
        return (kind_of(arguments[0] if variable else arguments[min(item, len(arguments) - 1)]),)
    return ()


def has_tag(declared: Any, tag: str | int) -> bool:
    """Test whether a table is the member of a discriminated union that `tag` names."""
    fields = declared.model_fields if is_table(declared) else {}
    return any(tag in get_args(fields[key].annotation) for key in ("kind", "law") if key in fields)


def tag_of(table: type[BaseModel]) -> tuple[str, str] | None:
    """Return the key and value that select a table among its alternatives, such as ("law", "fracture")."""
    fields = table.model_fields
    return next(((key, str(get_args(fields[key].annotation)[0])) for key in ("kind", "law") if key in fields), None)


def unknown_key(name: str, owner: type[BaseModel] | None, kin: Sequence[DeclaredType] = ()) -> str:
    """Return the message for a key that the table does not have; kin: tables of other kinds, which may have it."""
    names = list(owner.model_fields) if owner else []
    tables = [member.type for member in kin if is_table(member.type)]
    tags = [tag_of(table) for table in tables if name in table.model_fields] if owner in tables else []
    own = tag_of(owner) if owner and tags else None
    if own:
        others = listing(tag[1] for tag in tags if tag)
        return f"unknown key of {own[0]} = {show(own[1])}; found in {own[0]} = {others}"
    hint = nearest(name, names)
    return f"unknown key, {hint}" if hint else f"unknown key (allowed: {listing(names)})"


def value_at(data: Any, path: KeyPath) -> Any:
    """Return the value at a key path of the case file; None where there is none."""
    for key in path:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return None
    return data
