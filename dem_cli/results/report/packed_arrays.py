"""Base64 arrays in a page: little-endian numbers as text."""

from __future__ import annotations

import base64
from typing import TypedDict

import numpy as np

_TYPES = {"f": "f4", "i": "u4", "u": "u4", "b": "u1"}  # by kind of number; what JavaScript has arrays for


class PackedArray(TypedDict):
    """Array in base64, as assets/page.js reads it back."""

    type: str  # "f4", "u4" or "u1"
    data: str


def pack(values: np.ndarray, kind: str | None = None) -> PackedArray:
    """Encode an array: float32 of real numbers, uint32 of whole ones, one byte of truth values or of `kind` "u1"."""
    kind = kind or _TYPES[values.dtype.kind]
    data = np.ascontiguousarray(values, dtype=f"<{kind}" if kind != "u1" else kind)
    return {"type": kind, "data": base64.b64encode(data.tobytes()).decode("ascii")}
