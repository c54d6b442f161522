"""Write a case as TOML text with defaults filled in; reading and writing it again gives the same bytes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import tomli_w
from pydantic import ValidationError

from dem_cli.case import dimensions
from dem_cli.case.base import CaseModel
from dem_cli.case.overrides import plain_value
from dem_cli.case.schema import Case
from dem_cli.version import __version__

HEADER = "# The case as it was solved: defaults filled in, overrides applied.\n\n"
NUMBER_LISTS = re.compile(r"\[\n((?: +[-+0-9.e]+,\n)+) *\]")  # no string of TOML holds such lines
LEADING_KEYS = ("kind", "law", "id")  # keys that tell what a table is
SEVERAL = (
    "materials", "joints", "structure", "block", "interface", "imperfection", "load", "strain", "settlement", "motion",
    "monitor", "reference", "groups", "pressure", "fill",
    "alternative", "prediction", "inferred_from", "chosen_by",
)  # fmt: skip


def case_text(case: Case) -> str:
    """Return the TOML text of a case without its sweep."""
    data: dict[str, Any] = {}
    for key in type(case).model_fields:
        value = getattr(case, key)
        if key == "dem":
            data[key] = {"version": __version__}
        elif value is None or key == "sweep" or (key in SEVERAL and not value):
            continue
        elif isinstance(value, CaseModel):
            data[key] = effective(value)
        elif isinstance(value, dict):
            data[key] = {name: _plain(item) for name, item in value.items()}
        elif isinstance(value, tuple):
            data[key] = _plain(value)
        else:
            data[key] = value
    dimensions.leave_out(data)
    return HEADER + on_one_line(tomli_w.dumps(data))


def _plain(item: Any) -> Any:
    """Convert a table, or a list of tables and names, to plain values."""
    if isinstance(item, tuple):
        return [_plain(one) for one in item]
    return effective(item) if isinstance(item, CaseModel) else item


def text_of_tables(tables: Mapping[str, Any]) -> str:
    """Return the TOML text of a case given as tables, as a case file would have them. Raises UsageError."""
    return on_one_line(tomli_w.dumps(plain_value(tables, "case")))


def on_one_line(text: str) -> str:
    """Put each list of numbers on one line; tomli-w gives every number its own."""
    return NUMBER_LISTS.sub(lambda lines: f"[{', '.join(lines[1].replace(',', '').split())}]", text)


def effective(table: CaseModel) -> dict[str, Any]:
    """Return all keys of a table except defaults that may not be written out (`bond` beside `offset`)."""
    data = table.model_dump(exclude_none=True)
    data = {key: data[key] for key in (*LEADING_KEYS, *data) if key in data}
    if accepted(table, data):
        return data
    kept = {key: value for key, value in data.items() if key in table.model_fields_set}
    for key in data:
        if key not in kept and accepted(table, {**kept, key: data[key]}):
            kept[key] = data[key]
    return {key: value for key, value in data.items() if key in kept}


def accepted(table: CaseModel, data: dict[str, Any]) -> bool:
    """Test whether `data` is valid as a table of that kind and has the same values."""
    try:
        read = type(table).model_validate(data)
    except ValidationError:
        return False
    return read.model_dump() == table.model_dump()  # by keys: tables keep arrays beside them, which are not compared
