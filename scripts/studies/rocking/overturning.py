"""One-sine pulses: at which amplitudes Housner's block overturns, and where dem has these bounds.

Overturning is not monotone in the amplitude. The oracle is asked along a fine grid of amplitudes; every change of its
answer is a bound, bisected. dem is asked 3 % below and above each: with the oracle's answers there the bound
is bisected in between, else it is missed. Bounds closer than 6 % to each other are judged as a band.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from oracle.base_motion import pulse
from oracle.housner import Block, overturns

from studies.bisection import bisect_ratio
from studies.rocking.single_block import fallen_angle, one_block, pulse_table, solve

BLOCK = Block(0.5, 2.0)
RATIOS = (1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0)  # ω/p
HIGHEST, GRID = 16.0, 0.01  # x = A / (g tan α); steps of log x
APART, TOLERANCE = 0.03, 2e-4
AFTER = 8.0  # [1/p]: how long a block is followed after the pulse


def unit(block: Block) -> float:
    return block.gravity * math.tan(block.alpha)


def frequency(block: Block, ratio: float) -> float:
    return ratio * block.p / (2.0 * math.pi)


def exact(block: Block, ratio: float, x: float) -> bool:
    f = frequency(block, ratio)
    return overturns(block, pulse(x * unit(block), f), 1.0 / f + AFTER / block.p, bound=fallen_angle())


def dem(block: Block, ratio: float, x: float, **how: Any) -> bool:
    f = frequency(block, ratio)
    return solve(one_block(block, pulse_table(x * unit(block), f), 1.0 / f + AFTER / block.p, **how)).overturned


def bounds(block: Block, ratio: float) -> list[float]:
    """All x at which the oracle's answer changes, ascending."""
    grid = np.exp(np.arange(0.0, math.log(HIGHEST), GRID))
    answers = [exact(block, ratio, x) for x in grid]
    changes = [k for k in range(len(grid) - 1) if answers[k] != answers[k + 1]]
    return [
        bisected(lambda x, k=k: exact(block, ratio, x) == answers[k + 1], grid[k], grid[k + 1], 1e-6) for k in changes
    ]


class OverturningBound(NamedTuple):
    """A change of the oracle's answer, and amplitudes around it at which dem is asked."""

    x: float
    overturns_above: bool
    low: float
    high: float

    def met(self, answer: Callable[[float], bool]) -> bool:
        """Whether somebody else has the oracle's answers at both amplitudes."""
        return (answer(self.low), answer(self.high)) == (not self.overturns_above, self.overturns_above)


def around(found: Sequence[float]) -> list[OverturningBound]:
    """The bounds x, with amplitudes APART below and above, or half way to the next bound where that is nearer."""
    made = []
    for number, x in enumerate(found):
        closest = min((abs(math.log(x / other)) for other in found if other != x), default=math.inf)
        apart = min(APART, 0.5 * closest)
        made.append(OverturningBound(x, number % 2 == 0, x * math.exp(-apart), x * math.exp(apart)))
    return made


def compared(block: Block, ratio: float, **how: Any) -> list[dict[str, Any]]:
    """One row per bound of the oracle; error None: dem does not have its answers around it."""
    rows = []
    for bound in around(bounds(block, ratio)):
        error = None
        if bound.met(lambda x: dem(block, ratio, x, **how)):
            above = bound.overturns_above
            found = bisected(lambda x, f=above: dem(block, ratio, x, **how) == f, bound.low, bound.high, TOLERANCE)
            error = found / bound.x - 1.0
        rows.append({"ratio": ratio, "bound": bound.x, "overturns_above": bound.overturns_above, "error": error})
    return rows


def bisected(beyond: Callable[[float], bool], low: float, high: float, tolerance: float) -> float:
    """The geometric mean of both sides."""
    return math.sqrt(math.prod(bisect_ratio(low, high, tolerance, beyond)))
