"""JSON behind the generated pages, docs/data/NAME.json: one run per line, numbers with the digits that are shown."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from studies.places import DATA


def read(name: str) -> dict[str, Any]:
    """What is kept of a study; nothing where there is no file."""
    file = DATA / f"{name}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def write(name: str, table: Mapping[str, Any]) -> None:
    """Keep it."""
    DATA.mkdir(exist_ok=True)
    (DATA / f"{name}.json").write_text(text_of(table) + "\n", encoding="utf-8")


def text_of(value: Any, depth: int = 0) -> str:
    """JSON text in which every run, and every other record, has a line of its own."""
    if is_line(value):
        return json.dumps(value, ensure_ascii=False)
    inner = "\n" + (depth + 1) * " "
    if isinstance(value, dict):
        parts = (f"{json.dumps(key, ensure_ascii=False)}: {text_of(item, depth + 1)}" for key, item in value.items())
        return "{" + inner + f",{inner}".join(parts) + "\n" + depth * " " + "}"
    return "[" + inner + f",{inner}".join(text_of(item, depth + 1) for item in value) + "\n" + depth * " " + "]"


def is_line(value: Any) -> bool:
    """Whether it stands on one line: a run, a record without runs in it, numbers."""
    if isinstance(value, dict):
        scalar = any(not isinstance(item, (dict, list)) for item in value.values())
        return not value or "command" in value or "run" in value or (scalar and not has_run(value))
    return not isinstance(value, list) or not any(map(has_dict, value))


def has_run(value: Any) -> bool:
    """Whether there is a run in it."""
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return (isinstance(value, dict) and "command" in value) or any(map(has_run, items))


def has_dict(value: Any) -> bool:
    """Whether there is a record in it."""
    return isinstance(value, dict) or (isinstance(value, list) and any(map(has_dict, value)))


def rounded(value: Any, places: int = 6) -> Any:
    """The same as plain JSON, with so many digits behind the point; what is not finite is null."""
    if isinstance(value, dict):
        return {key: rounded(item, places) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return rounded(value.tolist(), places)
    if isinstance(value, (list, tuple)):
        return [rounded(item, places) for item in value]
    if isinstance(value, (float, np.floating)):
        return round(float(value), places) if math.isfinite(value) else None
    return value.item() if isinstance(value, np.generic) else value
