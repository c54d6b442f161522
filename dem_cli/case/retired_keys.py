"""Retired keys of the case file: at first still read, with a warning that names the new key, later refused.

What a version promises about keys stands in docs/versions.md.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Any, NamedTuple

from dem_cli.case.keys import NAME_PLACEHOLDER
from dem_cli.errors import CaseProblem, KeyPath


class RetiredKey(NamedTuple):
    """Key of the case file that was renamed or removed in a named version."""

    path: str  # as docs/case.md has it, without numbers: "analysis.step", "joints.NAME.kn", "structure.openings.width"
    version: str  # that retired it
    name: str = ""  # its name now; "": it has none, and its value is not looked at
    instead: str = ""  # what to write where there is no name
    refused: bool = False  # False: still read, with a warning


RETIRED: tuple[RetiredKey, ...] = ()


def rename(data: dict[str, Any], overridden: Collection[KeyPath] = ()) -> tuple[list[CaseProblem], list[CaseProblem]]:
    """Rename retired keys in `data` in place; returns the warnings and the problems.

    overridden: key paths of overrides; by an old name it counts more than the new one in the file.
    """
    warned: list[CaseProblem] = []
    refused: list[CaseProblem] = []
    for old in RETIRED:
        *above, key = old.path.split(".")
        for path, table in tables_at(data, above):
            if key not in table:
                continue
            value, twice = table.pop(key), old.name in table and (*path, key) not in overridden
            if old.name and not twice:
                table[old.name] = value
            found = refused if old.refused or twice else warned
            found.append(CaseProblem((*path, key), message(old, twice), at_key=True))
    return warned, refused


def retired(words: Sequence[str]) -> RetiredKey | None:
    """Find the retired key that a user means, by its path or by the key alone."""
    for old in RETIRED:
        table, *_, key = old.path.split(".") if "." in old.path else ("", old.path)
        if words[-1:] == [key] and (len(words) == 1 or words[0] == table):
            return old
    return None


def message(old: RetiredKey, twice: bool = False) -> str:
    """Return the message for a retired key; twice: its new name is given beside it."""
    if twice:
        return f"not allowed beside '{old.name}', which is its name since version {old.version}"
    now = f"its name is '{old.name}'" if old.name else old.instead or "nothing takes its place"
    return f"retired in version {old.version}: {now}" + ("" if old.refused else "; a later version will refuse it")


def tables_at(node: Any, steps: Sequence[str], path: KeyPath = ()) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """Find all tables at a path without indices, with their key paths; "NAME" stands for every name."""
    if isinstance(node, list):
        for i, item in enumerate(node):
            yield from tables_at(item, steps, (*path, i))
    elif isinstance(node, dict) and not steps:
        yield path, node
    elif isinstance(node, dict):
        for key in node if steps[0] == NAME_PLACEHOLDER else steps[:1]:
            yield from tables_at(node.get(key), steps[1:], (*path, key))
