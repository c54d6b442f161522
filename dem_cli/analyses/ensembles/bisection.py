"""Bisection between standing and failing values of one number, until the two are close."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.static_settings import SafetySettings


class Scale(NamedTuple):
    """Range of the values that may be tried, and the middle between two of them."""

    low: float
    high: float
    ratio: bool  # by ratios, as for factors; else by differences
    whole: bool = False  # whole numbers only
    nothing: float = DEFAULT.safety.nothing  # of the range, below which a relative resolution makes no sense

    def middle(self, a: float, b: float) -> float:
        """Return the middle between two values, geometric for ratios."""
        if self.whole:
            return float((int(a) + int(b)) // 2)
        return math.sqrt(a * b) if self.ratio else 0.5 * (a + b)

    def close(self, a: float, b: float, resolution: float) -> bool:
        """Test whether two values are within the resolution of each other."""
        if self.whole:
            return abs(a - b) <= 1.0
        return abs(a - b) <= resolution * max(abs(a), abs(b), self.nothing * (self.high - self.low))

    def towards(self, start: float, end: float, step: float) -> float:
        """Step from `start` by a relative `step` towards `end`, which is not passed."""
        sign = 1.0 if end > start else -1.0
        value = start * (1.0 + step) ** sign if self.ratio else start + sign * step * max(abs(start), 1e-9 * abs(end))
        if self.whole:
            value = round(value) if abs(value - start) >= 1.0 else start + sign
        return min(value, end) if sign > 0 else max(value, end)

    def parts(self, n: int) -> list[float]:
        """Divide the whole range into n equal parts, n + 1 values; whole numbers come once."""
        share = [i / n for i in range(1, n)]
        if self.ratio:
            inner = [self.low * (self.high / self.low) ** s for s in share]
        else:
            inner = [self.low + s * (self.high - self.low) for s in share]
        inner = [float(round(v)) for v in inner] if self.whole else inner
        return sorted({self.low, *inner, self.high})


class Ends(NamedTuple):
    """Bracket of the change from standing to failing; None: not found."""

    stands: float | None
    fails: float | None


Stands = Callable[[float], bool]


def search(
    stands: Stands,
    scale: Scale,
    resolution: float,
    guess: Ends | None,
    scan: int,
    start: float | None,
    settings: SafetySettings = DEFAULT.safety,
) -> Ends:
    """Search the change from standing to failure by bisection, until its two values are `resolution` apart.

    guess: values next to which the change should be; scan: equal parts that are tried first; start: from where to go
    outwards, without either. A change that is nowhere leaves one of the two None.
    """
    if scan:
        found = first_change([(value, stands(value)) for value in scale.parts(scan)])
    elif guess is not None:
        found = _around(stands, scale, resolution, guess, settings)
    elif start is not None:
        found = _outwards(stands, scale, start, settings)
    else:
        found = first_change([(scale.low, stands(scale.low)), (scale.high, stands(scale.high))])
    good, bad = found
    if good is None or bad is None:
        return found
    while not scale.close(good, bad, resolution):
        middle = scale.middle(good, bad)
        good, bad = (middle, bad) if stands(middle) else (good, middle)
    return Ends(good, bad)


def first_change(tried: list[tuple[float, bool]]) -> Ends:
    """Return the first change, seen from the end that stands (where both do, or none, from the lower one).

    tried: values, increasing, and whether each stands.
    """
    if tried[-1][1] and not tried[0][1]:
        tried = tried[::-1]
    for (value, stands), (following, also) in zip(tried, tried[1:]):
        if stands != also:
            return Ends(value, following) if stands else Ends(following, value)
    return Ends(tried[-1][0], None) if tried[-1][1] else Ends(None, tried[0][0])


def changes(tried: dict[float, bool]) -> int:
    """Count the changes between neighbours among the values tried."""
    answers = [tried[value] for value in sorted(tried)]
    return sum(a != b for a, b in zip(answers, answers[1:]))


def _around(stands: Stands, scale: Scale, resolution: float, guess: Ends, settings: SafetySettings) -> Ends:
    """Search from a guess to both sides, by growing steps."""
    assert guess.stands is not None
    assert guess.fails is not None
    up = guess.fails > guess.stands
    to_stand, to_fail = (scale.low, scale.high) if up else (scale.high, scale.low)
    middle = guess.stands if scale.whole else scale.middle(guess.stands, guess.fails)
    last: Ends = Ends(None, None)
    for value in _steps(scale, middle, to_stand, resolution, settings):
        if stands(value):
            last = last._replace(stands=value)
            break
        last = last._replace(fails=value)
    if last.stands is None or last.fails is not None:
        return last
    for value in _steps(scale, guess.fails if scale.whole else middle, to_fail, resolution, settings):
        if not stands(value):
            return last._replace(fails=value)
        last = last._replace(stands=value)
    return last


def _steps(scale: Scale, start: float, end: float, resolution: float, settings: SafetySettings) -> Iterator[float]:
    """Yield values that leave `start` with growing steps, up to `end`; of whole numbers, `start` first."""
    step, value = settings.first * resolution, start
    if scale.whole:
        yield value
    while value != end:
        value = scale.towards(start, end, step)
        yield value
        step *= settings.growth


def _outwards(stands: Stands, scale: Scale, start: float, settings: SafetySettings) -> Ends:
    """Search from `start` towards higher values where it stands there, towards lower ones where it fails."""
    value, stride = start, settings.stride
    first = stands(value)
    end = scale.high if first else scale.low
    while value != end:
        following = scale.towards(value, end, stride - 1.0)
        if stands(following) != first:
            return Ends(value, following) if first else Ends(following, value)
        value, stride = following, stride * settings.stride
    return Ends(value, None) if first else Ends(None, value)
