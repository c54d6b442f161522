"""Unique names of monitors and records in tables."""

from __future__ import annotations

from collections.abc import Iterable


def distinct(names: Iterable[str]) -> list[str]:
    """Make names unique by a number where one is repeated."""
    found: list[str] = []
    for name in names:
        count = 1 + sum(other == name or other.startswith(f"{name} #") for other in found)
        found.append(name if count == 1 else f"{name} #{count}")
    return found
