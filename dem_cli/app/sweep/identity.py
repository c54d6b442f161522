"""Identity of a run for comparing runs: the case, its files, and the program."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dem_cli.results.output.provenance import provenance

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

PACKAGE = Path(__file__).resolve().parents[2]
NAME_DIGITS = 12  # of a name: two of a million runs meet with a chance of one in 500


@cache
def program() -> str:
    """Return versions of everything that computes, with a hash of this package's sources."""
    return " ".join([*(f"{name} {version}" for name, version in provenance().items()), hash_of_sources(PACKAGE)])


def hash_of_sources(package: Path) -> str:
    """Hash all Python files below a folder, by name and content."""
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        digest.update(f"{source.relative_to(package).as_posix()}\n".encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def facts(case: Case, text: str) -> dict[str, str]:
    """Return what must be the same for runs to be comparable, in words for users. text: the effective case."""
    drawn = _digest(case.structure)
    return {
        "the case": hashlib.sha256(text.encode()).hexdigest(),
        "a record": _digest(case.motion),
        **({"an imported file": drawn} if drawn != _digest(()) else {}),
        "the program": program(),
    }


def _digest(tables: Iterable[Any]) -> str:
    """Hash all files that tables name."""
    named = [getattr(each, "file", None) for table in tables for each in (table, getattr(table, "outline", None))]
    files = [Path(file) for file in named if file]
    return hashlib.sha256(b"".join(hashlib.sha256(file.read_bytes()).digest() for file in files)).hexdigest()


def name_of(found: Mapping[str, str]) -> str:
    """Return a short name for a run with these facts: the same for the same run, on any machine."""
    return hashlib.sha256("\n".join(found.values()).encode()).hexdigest()[:NAME_DIGITS]
