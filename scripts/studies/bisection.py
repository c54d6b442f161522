"""Bisection of a load at which something begins."""

from __future__ import annotations

from collections.abc import Callable

PLACES = 9  # digits kept


def bisect(low: float, high: float, width: float, beyond: Callable[[float], bool]) -> list[float]:
    """[low, high] round the load where `beyond` begins, no wider than `width` of it."""
    while high - low > width * high:
        load = 0.5 * (low + high)
        low, high = (low, load) if beyond(load) else (load, high)
    return [round(low, PLACES), round(high, PLACES)]
