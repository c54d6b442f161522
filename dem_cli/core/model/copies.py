"""Copies of a structure as one: rows of arrays one copy behind the other, blocks and joints numbered through."""

from __future__ import annotations

import numpy as np


def repeated(rows: np.ndarray, copies: int) -> np.ndarray:
    """Repeat rows (n, ...) for so many copies, (copies · n, ...)."""
    return rows if copies == 1 else np.tile(rows, (copies, *[1] * (rows.ndim - 1)))


def numbered_through(numbers: np.ndarray, count: int, copies: int) -> np.ndarray:
    """Number entries through for so many copies, (copies · n, ...), from numbers (n, ...) below `count` of one
    structure."""
    if copies == 1:
        return numbers
    firsts = np.repeat(count * np.arange(copies), len(numbers))
    return repeated(numbers, copies) + firsts.reshape(-1, *[1] * (numbers.ndim - 1))
