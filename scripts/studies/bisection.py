"""Bisection of a load or an amplitude at which something begins."""

from __future__ import annotations

import math
from collections.abc import Callable

PLACES = 9  # digits kept


def bisect(low: float, high: float, width: float, beyond: Callable[[float], bool]) -> list[float]:
    """[low, high] round the load where `beyond` begins, no wider than `width` of it."""
    while high - low > width * high:
        load = 0.5 * (low + high)
        low, high = (low, load) if beyond(load) else (load, high)
    return [round(low, PLACES), round(high, PLACES)]


def bisect_ratio(low: float, high: float, tolerance: float, beyond: Callable[[float], bool]) -> tuple[float, float]:
    """Both sides of the amplitude where `beyond` begins, their ratio within 1 + tolerance; by geometric means."""
    while high / low > 1.0 + tolerance:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return low, high
