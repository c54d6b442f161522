"""Self-check of the package's own way on a small kernel: compiled code must give what Python gives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.kernels.compilation import machine_code
from dem_cli.core.kernels.compilation.switch import Surprise

__all__ = ["check_small_kernel"]


class Sample(NamedTuple):
    """Sample record of an array with a row for each number, and a number."""

    rows: np.ndarray
    share: float


def _scaled(sample, row, column):
    return sample.share * sample.rows[row, column]


def _summed(sample, row):
    total = 0.0
    for column in range(sample.rows.shape[1]):
        total += _scaled(sample, row, column)
    return total


def _sums(sample, given, found):
    """Sum numbers of a record, a tuple and an array by the calls that kernels use."""
    for row in range(found.size):
        found[row] = _summed(sample, row) / given[0] + given[1]
    return found[0] > 0.0


def check_small_kernel() -> None:
    """Run a small kernel; raises Surprise where compiled code gives something else than Python."""
    machine_code.declare_callee(_scaled, True)
    machine_code.declare_callee(_summed, False)
    sample, given = Sample(np.arange(6.0).reshape(3, 2) - 0.3, 1.7), (3.0, 0.1)
    expected, found = np.zeros(3), np.zeros(3)
    answers = _sums(sample, given, expected), machine_code.compiled(_sums)(sample, given, found)
    if answers[0] != answers[1] or expected.tobytes() != found.tobytes():
        raise Surprise("a small kernel gives another answer than Python")
