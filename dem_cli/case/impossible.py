"""Impossible values of a case file, whatever the key: dates, numbers beyond any computation, endless nesting."""

from __future__ import annotations

import datetime
from collections.abc import Iterator
from typing import Any

import tomli

from dem_cli.case.wording import show
from dem_cli.errors import CaseProblem, KeyPath

LARGEST = 1e30  # what is larger overflows in products (masses, inertias); nothing in a case is
DEEPEST = 20  # levels of lists and tables; the format has 6


def parsed(text: str) -> dict[str, Any]:
    """TOML as plain data. Raises tomli.TOMLDecodeError, for lists in lists without end and endless digits too."""
    try:
        return tomli.loads(text)
    except RecursionError:
        raise tomli.TOMLDecodeError("lists or tables are nested too deeply", text, 0) from None
    except tomli.TOMLDecodeError:
        raise
    except ValueError:  # of int(), which reads so many digits
        raise tomli.TOMLDecodeError("a number has too many digits", text, 0) from None


def impossible_values(value: Any, path: KeyPath = ()) -> Iterator[CaseProblem]:
    """What no key of a case takes. inf and nan are left to the keys, which have words for them."""
    if isinstance(value, (datetime.date, datetime.time)):
        yield CaseProblem(path, f"{value} is a date; no key takes one")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        size = abs(value)
        if LARGEST < size < float("inf"):
            said = show(value) if isinstance(value, float) or size < 10**50 else "a number of so many digits"
            message = f"{said} is not allowed; numbers are at most {LARGEST:g} in size"
            yield CaseProblem(path, message)
    elif isinstance(value, (dict, list)):
        if len(path) >= DEEPEST:
            yield CaseProblem(path, "nested too deeply: no key takes that")
            return
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from impossible_values(item, (*path, key))
