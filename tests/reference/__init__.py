"""The data book: one TOML file per benchmark, with its source; tests read their numbers from here."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path


@cache
def book(name: str) -> dict:
    """The whole file `name`.toml."""
    return tomllib.loads((Path(__file__).parent / f"{name}.toml").read_text(encoding="utf-8"))


def result(name: str, result_id: str) -> dict:
    """One [[result]] of a file."""
    (row,) = [row for row in book(name)["result"] if row["id"] == result_id]
    return row


def value(name: str, result_id: str) -> float:
    """The value of one result."""
    return result(name, result_id)["value"]


@cache
def results(name: str) -> dict[str, dict]:
    """All [[result]] of a file by their id."""
    return {row["id"]: row for row in book(name)["result"]}
