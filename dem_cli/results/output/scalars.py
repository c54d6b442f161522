"""Plain values of a summary: strict JSON, and every single number by its path."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Convert values to strict JSON; not-a-number and infinity become null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def scalars(summary: Mapping[str, Any]) -> dict[str, float | int | str | bool | None]:
    """Collect every single number, text and truth value of a summary by its path, such as "peaks.top displacement.max".

    Items of lists have their number in it: "failure_load_bracket.0".
    """
    found: dict[str, float | int | str | bool | None] = {}

    def walk(path: str, value: Any) -> None:
        if isinstance(value, Mapping):
            for key, item in value.items():
                walk(f"{path}.{key}" if path else str(key), item)
        elif isinstance(value, list):
            for i, item in enumerate(value):
                walk(f"{path}.{i}", item)
        else:
            found[path] = value

    walk("", plain(summary))
    return found
