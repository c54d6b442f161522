"""Select cases with a [reference]: named files, and all in named folders."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fnmatch import fnmatch
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.case.reader import near_file, parse_toml, read_text
from dem_cli.case.tolerance_rules import kind_of
from dem_cli.errors import DemError, UsageError

SHELVES = {  # [reference] kind -> its shelf
    "exact": "verification",
    "bounded": "bounds",
    "experiment": "validation",
    "code": "cross-code",
    "inference": "inference",
    "blind": "blind",
}
APART = "inference"  # a shelf that proves nothing: counted by itself, in no summary


class CaseSelection(NamedTuple):
    """Selected cases, and those left out."""

    cases: list[Path]
    without: list[Path]  # cases without [reference]


def find(paths: Sequence[Path], pattern: str = "", shelves: Sequence[str] = ()) -> CaseSelection:
    """Find case files with a [reference] whose path matches, on given shelves; every file once.

    pattern: a part of the path, with wildcards as in a shell. shelves: values of SHELVES; none: all.
    A file that is no TOML is among them: it fails. Raises UsageError for a path that does not exist.
    """
    found = CaseSelection([], [])
    for path in dict.fromkeys(chain.from_iterable(map(files_at, paths))):
        if pattern and not fnmatch(path.as_posix().lower(), f"*{pattern.lower()}*"):
            continue
        kinds = kinds_of(path)
        if not kinds:
            found.without.append(path)
        elif kinds == ["?"] or not shelves or any(SHELVES.get(kind) in shelves for kind in kinds):
            found.cases.append(path)
    return found


def files_at(path: Path) -> list[Path]:
    """Return a file itself, or all TOML files below a folder, by name."""
    if path.is_dir():
        return sorted(path.rglob("*.toml"))
    if not path.exists():
        raise UsageError(f"{path}: no such file or folder{near_file(path)}")
    return [path]


def kinds_of(path: Path) -> list[str]:
    """Return the kinds of the references of a case; empty where it has none, `?` where it cannot be read."""
    try:
        table = parse_toml(path, read_text(path)).get("reference", [])
    except DemError:
        return ["?"]
    tables: list[Any] = table if isinstance(table, list) else [table]
    return [_kind(one) if isinstance(one, dict) else "?" for one in tables]


def _kind(table: dict[str, Any]) -> str:
    """Return the kind of a [reference] table as it is read."""
    interval = isinstance(table.get("value"), list) and "displacements" not in table
    return kind_of(str(table.get("kind", "exact")), interval)


def longest_first(cases: Sequence[Path], cost: Callable[[Path], float | None]) -> list[Path]:
    """Sort cases of unknown cost first, then from the dearest to the cheapest, for parallel runs."""
    costs = {case: cost(case) for case in cases}
    return sorted(cases, key=lambda case: (costs[case] is not None, -(costs[case] or 0.0)))
