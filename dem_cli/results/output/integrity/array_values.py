"""Check the values of a dataset: numbers are finite, and indices exist."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dem_cli.errors import DamagedResults
from dem_cli.results.output.layout import NUMBERS, ONE_MORE, WHOLE, Described

MODEL = "/dem/model/"  # what was computed, as the case has it
PARTS = f"{MODEL}part_blocks"
OVERFLOWS = 1e150  # whose square is hardly a number; a case has nothing beyond the fifth power of its largest number
SINGLE = float(np.finfo(np.float32).max)  # pictures and ParaView have single precision
ENDLESS = ("row", "sample")  # axes of what a run that ended in nonsense kept of it: values need not be finite


def checked(path: str, values: np.ndarray, said: Described, sizes: Mapping[str, int]) -> np.ndarray:
    """Return the values of a dataset after checking them. sizes: of all axes. Raises DamagedResults."""
    if said.kind == NUMBERS and said.axes[:1] not in [(axis,) for axis in ENDLESS]:
        if not np.isfinite(values).all():
            raise DamagedResults(f"{path} is not finite")
        _check_sizes(path, values)
    elif said.kind == WHOLE and len(values):
        _check_numbers(path, values, said, sizes)
    return values


def _check_sizes(path: str, values: np.ndarray) -> None:
    """Raise DamagedResults where numbers are so large that what is made of them is not finite."""
    largest = float(np.abs(values, dtype=np.float64).max(initial=0.0))
    if path.startswith(MODEL) and largest > OVERFLOWS:
        raise DamagedResults(f"{path} holds {largest:.3g}; products of such numbers are not finite")
    if largest > SINGLE:
        raise DamagedResults(f"{path} holds {largest:.3g}; pictures show no such numbers")


def _check_numbers(path: str, values: np.ndarray, said: Described, sizes: Mapping[str, int]) -> None:
    """Raise DamagedResults where whole numbers are indices of nothing that exists."""
    low, high = int(values.min()), int(values.max())
    of = f"of {said.counts} " if said.counts else ""
    if path == PARTS and len(np.unique(values)) < sizes[said.counts]:
        raise DamagedResults(f"{path} leaves a block without any part")
    starts = said.axes[0].endswith(ONE_MORE)
    most = sizes[said.counts] - (not starts) if said.counts else high
    if low < said.least or high > most:
        wrong = low if low < said.least else high
        raise DamagedResults(f"{path} holds the number {of}{wrong}; {said.least} to {most} are there")
    if starts and (low != values[0] or values[0] != 0 or values[-1] != most or (np.diff(values) < 0).any()):
        raise DamagedResults(f"{path} does not count from 0 up to {most}")
