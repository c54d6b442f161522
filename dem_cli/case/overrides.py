"""Overrides of one value of a case, `--set KEY=VALUE` or `set={KEY: value}`, applied before validation."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import tomli
from pydantic import BaseModel

from dem_cli.case.scanner import parsed
from dem_cli.case.wording import listing, show, unknown_name
from dem_cli.errors import CaseProblem, KeyPath, UsageError, dotted

NAMED = ("materials", "joints")  # tables of named tables: a new name is taken for a slip


class Override(NamedTuple):
    """Override of one value of a case: key path as typed and resolved, value, and place in a sweep; () is --set."""

    text: str
    path: KeyPath
    value: Any
    place: KeyPath = ()
    origin: str = "--set"  # what messages call it where it stands in no file


def parse(text: str) -> Override:
    """Parse an override `joints.dry.friction=0.6`. The value is a TOML literal; any other text is a string."""
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not key:
        raise UsageError(f"--set {text}: must be KEY=VALUE, such as joints.dry.friction=0.6")
    path = key_path(key)
    if not path:
        raise UsageError(f"--set {text}: '{key}' is not a key path, such as structure.0.courses")
    return Override(key, path, literal(value.strip()))


def override_of(key: str, value: Any) -> Override:
    """Create an override from a key path and a Python value. Raises UsageError for an invalid path or value."""
    path = key_path(key) if isinstance(key, str) else ()
    if not path:
        raise UsageError(f"set: {key!r} is not a key path, such as 'joints.dry.friction' or 'structure.0.courses'")
    return Override(key, path, plain_value(value, f"set {key}"), origin="set")


def plain_value(value: Any, where: str) -> Any:
    """Convert a Python value to TOML types: arrays to lists, paths to text. Raises UsageError where it cannot."""
    if isinstance(value, Mapping):
        return {str(key): plain_value(item, f"{where}.{key}") for key, item in value.items()}
    if hasattr(value, "tolist"):  # an array or a number of numpy
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain_value(item, where) for item in value]
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, (bool, int, float, str)):
        return value
    raise UsageError(f"{where}: {value!r} is no value of a case file: give a number, truth, text, list or table")


@lru_cache(maxsize=64)  # a sweep asks for the same one in each of its runs
def key_path(text: str) -> KeyPath:
    """Split `joints.dry.friction` into its keys; () for a text that is no key path."""
    try:
        return single_path(parsed(f"{text} = 0"))
    except tomli.TOMLDecodeError:
        return ()


def value_at(table: Any, path: KeyPath) -> Any:
    """Return the value at a key path of a case or of one of its tables; None where there is none."""
    try:
        for key in path:
            table = below(table, str(key))
    except KeyError:
        return None
    return table if path else None


def below(table: Any, key: str) -> Any:
    """Return the value under one key of a table or list of a validated case. Raises KeyError where there is none."""
    if isinstance(table, BaseModel) and key in type(table).model_fields:
        return getattr(table, key)
    if isinstance(table, Mapping) and key in table:
        return table[key]
    if isinstance(table, tuple) and key.isdigit() and int(key) < len(table):
        return table[int(key)]
    raise KeyError(key)


def single_path(table: dict[str, Any]) -> KeyPath:
    """Return the keys of nested tables with one key each."""
    path: KeyPath = ()
    node: Any = table
    while isinstance(node, dict):
        key = next(iter(node))
        path, node = (*path, key), node[key]
    return path


def literal(text: str) -> Any:
    """Parse a TOML value; a text that is no TOML value is taken as a string."""
    try:
        table = parsed(f"value = {text}")
    except tomli.TOMLDecodeError:
        return text
    return table["value"] if len(table) == 1 else text


Outcome = tuple[Override, CaseProblem | None]


def apply(data: dict[str, Any], override: Override, tables: Collection[str]) -> Outcome:
    """Apply an override to `data` in place; returns it with resolved indices and any problem of its path.

    A missing table is made if the format has it (`tables`: keys of the file's top level).
    """
    node: Any = data
    path: KeyPath = ()
    for i, key in enumerate(override.path):
        last = i == len(override.path) - 1
        name: str | int = key
        if isinstance(node, list):
            if not str(key).isdigit() or int(key) >= len(node):
                numbers = f" (allowed: {listing(range(len(node)))})" if node else ""
                return failed(override, (*path, key), f"no such [[{dotted(path)}]]{numbers}")
            name = int(key)
        elif not isinstance(node, dict):
            return failed(override, path, f"{show(node)} is not a table; it has no '{key}'")
        elif key not in node and not last:
            if i == 0 and key not in tables:
                return failed(override, (key,), unknown_name("table", key, list(tables)))
            if i == 1 and path[0] in NAMED:
                return failed(override, (*path, key), unknown_name(str(path[0])[:-1], key, list(node)))
            node[key] = {}
        path = (*path, name)
        if last:
            node[name] = override.value
        else:
            node = node[name]
    return override._replace(path=path), None


def failed(override: Override, path: KeyPath, message: str) -> Outcome:
    """Return the outcome of an override that cannot be applied."""
    return override._replace(path=path), CaseProblem(path, message)
