"""Sample the values of a swept key: at even distances, or by Latin hypercube from a distribution."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.arithmetic import functions
from dem_cli.errors import CaseError, CaseProblem, KeyPath
from dem_cli.input_limits import MOST_RUNS

EVEN_KEYS = frozenset(("from", "to", "count", "log"))
Fractions = np.ndarray  # (n,), in (0, 1)


def _normal(mean: float, deviation: float, q: Fractions) -> np.ndarray:
    from scipy.special import ndtri

    return mean + deviation * ndtri(q)


def _lognormal(median: float, deviation: float, q: Fractions) -> np.ndarray:
    from scipy.special import ndtri

    return median * functions.exp(deviation * ndtri(q))


QUANTILES: dict[str, Callable[[float, float, Fractions], np.ndarray]] = {  # quantile functions
    "uniform": lambda low, high, q: low + (high - low) * q,
    "loguniform": lambda low, high, q: low * functions.power(high / low, q),
    "integers": lambda first, last, q: np.minimum(first + np.floor((last - first + 1) * q), last).astype(np.int64),
    "normal": _normal,
    "lognormal": _lognormal,
}


def even(path: KeyPath, form: Mapping[str, Any]) -> list[float]:
    """Return evenly spaced values `{ from = 0.5, to = 1.0, count = 6 }`, both ends included. Raises CaseError."""
    for key in form.keys() - EVEN_KEYS:
        raise _wrong((*path, key), "unknown key; values at even distances have 'from', 'to', 'count' and 'log'")
    for key in ("from", "to"):
        if not _is_number(form.get(key)):
            raise _wrong(path, f"'{key}' is missing" if key not in form else f"{key} = {show(form[key])} is no number")
    low, high, count, log = form["from"], form["to"], form.get("count"), form.get("log", False)
    if not isinstance(count, int) or isinstance(count, bool) or count < 2:
        raise _wrong(path, "'count' must be a whole number ≥ 2")
    if count > MOST_RUNS:
        raise _wrong(path, f"count = {count} is not allowed; at most {MOST_RUNS:,}")
    if not isinstance(log, bool):
        raise _wrong(path, f"log = {show(log)} is not allowed; must be true or false")
    if log and not (low > 0 and high > 0):
        raise _wrong(path, "even ratios (log = true) need positive ends")
    values = functions.geometric(low, high, count) if log else np.linspace(low, high, count)
    return [float(f"{value:.12g}") for value in values]  # 0.3, not 0.30000000000000004


def drawn(path: KeyPath, form: Mapping[str, Any], fractions: Fractions) -> list[float | int]:
    """Return the values at fractions of a distribution such as `{ uniform = [0.5, 0.7] }`. Raises CaseError."""
    if len(form) > 1:
        raise _wrong(path, f"one distribution, not {len(form)} keys: {', '.join(map(str, form))}")
    ((name, numbers),) = form.items()
    if not (isinstance(numbers, (list, tuple)) and len(numbers) == 2 and all(map(_is_number, numbers))):
        raise _wrong((*path, name), f"{show(numbers)} is not allowed; must be two numbers")
    a, b = numbers
    if name in ("normal", "lognormal"):
        if b <= 0 or (name == "lognormal" and a <= 0):
            raise _wrong((*path, name), "the deviation (and the median of lognormal) must be > 0")
    elif b <= a or (name == "loguniform" and a <= 0):
        raise _wrong((*path, name), "the second must be larger than the first" + (
            ", and both > 0" if name == "loguniform" else ""))  # fmt: skip
    if name == "integers" and not all(isinstance(number, int) for number in numbers):
        raise _wrong((*path, name), "must be two whole numbers")
    return QUANTILES[name](a, b, fractions).tolist()


def latin_hypercube(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Sample points in the unit cube (count, dimensions): one in each of `count` slices of every axis (McKay 1979)."""
    from scipy.stats.qmc import LatinHypercube

    return LatinHypercube(dimensions, rng=seed).random(count)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _wrong(path: KeyPath, message: str) -> CaseError:
    return CaseError([CaseProblem(path, message)])
