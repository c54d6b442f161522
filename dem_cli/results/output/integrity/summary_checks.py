"""Check summary.json: keys are of their types, and those that go together agree (summary_keys.py)."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.errors import DamagedResults, dotted
from dem_cli.results.output.integrity.summary_keys import RunSummary, SummaryTable

KINDS = {  # of errors of pydantic -> what the value is not
    "float_type": "a number", "int_type": "a whole number", "string_type": "text", "bool_type": "true or false",
    "list_type": "a list", "too_short": "two numbers", "too_long": "two numbers", "dict_type": "a table",
    "model_type": "a table",
    "finite_number": "finite", "greater_than_equal": "in its range", "less_than_equal": "in its range",
    "greater_than": "above 0", "int_from_float": "a whole number",
}  # fmt: skip


def check_summary(found: Any) -> dict[str, Any]:
    """Check a summary and return it. Raises DamagedResults where it is no summary of a run."""
    if not isinstance(found, dict):
        raise DamagedResults("summary.json is not a table")
    try:
        read = RunSummary.model_validate(found)
    except ValidationError as error:
        raise DamagedResults(_words(error, found)) from None
    _check_together(read, ())
    for name, table in (found.get("monitors") or {}).items():
        if table.get("unit", "m") not in MONITOR_UNITS.values():
            raise DamagedResults(f"summary.json: {dotted(('monitors', name, 'unit'))} is {table['unit']!r}, no unit")
    return found


def _words(error: ValidationError, found: Any) -> str:
    """Describe the first validation error: its place and what is wrong."""
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    path: list[str | int] = []
    for key in first["loc"]:  # pydantic names the choice that it tried as well
        inside = key in found if isinstance(found, dict) else isinstance(found, list) and key in range(len(found))
        if not inside and first["type"] != "missing":
            break
        path.append(key)
        found = found[key] if inside else None
    what = f"summary.json: {dotted(tuple(path))}"
    if first["type"] == "missing":
        return f"{what} is missing"
    kind = KINDS.get(first["type"])
    return f"{what} is not {kind}" if kind and len(path) == len(first["loc"]) else f"{what} is not what it must be"


def _check_together(table: SummaryTable, path: tuple[str | int, ...]) -> None:
    """Raise DamagedResults where a key has a value, and its companion has none or not as many."""
    for key, others in table.TOGETHER.items():
        for other in others if getattr(table, key) else ():
            if getattr(table, other) is None:
                raise DamagedResults(f"summary.json: {dotted((*path, other))} is missing")
    for key, others in table.AS_LONG.items():
        for other in others if getattr(table, key) is not None else ():
            _check_length(getattr(table, other), len(getattr(table, key)), (*path, other), key)
    for name in type(table).model_fields:
        value = getattr(table, name)
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, SummaryTable):
                _check_together(each, (*path, name))


def _check_length(found: Any, length: int, path: tuple[str | int, ...], of: str) -> None:
    """Raise DamagedResults where a list, or one of a table of lists, is not as long as the list `of`."""
    for name, each in found.items() if isinstance(found, dict) else [(None, found)]:
        if isinstance(each, list) and len(each) != length:
            what = dotted(path if name is None else (*path, name))
            raise DamagedResults(f"summary.json: {what} has {len(each)} values, {of} {length}")
