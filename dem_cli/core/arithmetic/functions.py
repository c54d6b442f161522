"""Elementary functions of arrays by the C library, whatever NumPy has for a processor; and rounding to agreed digits.

NumPy's sine, cosine, square root, square and hypot are the same on all processors and need no other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

LARGEST = 709.782712893384  # logarithm of the largest number
DIGITS = 9  # far more than an answer has, far fewer than round-off touches


def _each(function: Callable[..., float], n_arguments: int = 1) -> Callable[..., Any]:
    """Make a function of a number apply to all numbers of arrays."""
    of_all = np.frompyfunc(function, n_arguments, 1)

    def of(*values: Any) -> Any:
        with np.errstate(all="ignore"):  # Python's own functions raise what is wrong
            return np.asarray(of_all(*values), float)[()]

    return of


def _exp(x: float) -> float:
    return math.inf if x > LARGEST else math.exp(x)


def _log(x: float) -> float:
    return math.log(x) if x > 0.0 else -math.inf if x == 0.0 else math.nan


arccos, arcsin, arctan, tan = (_each(function) for function in (math.acos, math.asin, math.atan, math.tan))
exp, log, expm1, log1p, log10 = (_each(function) for function in (_exp, _log, math.expm1, math.log1p, math.log10))
arctan2, power = _each(math.atan2, 2), _each(math.pow, 2)


def geometric(low: float, high: float, count: int) -> np.ndarray:
    """Make a geometric series of `count` numbers from low to high; the ends are exact, (count,)."""
    found = low * power(high / low, np.linspace(0.0, 1.0, count))
    found[-1:] = high
    found[:1] = low
    return found


def agreed(values: Any, digits: int = DIGITS) -> Any:
    """Round numbers to so many significant digits, so that results of LAPACK agree on all processors.

    Two results that are 1e-15 apart, in parts of themselves, still round to different numbers once in a million times.
    """
    if np.ndim(values) == 0:
        return float(f"{float(values):.{digits - 1}e}")
    return np.array([agreed(value, digits) for value in np.ravel(values)], float).reshape(np.shape(values))


def agreed_beside(values: np.ndarray, largest: float) -> np.ndarray:
    """Round numbers to the last of the agreed digits of the largest of them."""
    unit = agreed(largest)
    return np.round(values / unit, DIGITS) * unit + 0.0 if unit else values  # no −0.0
