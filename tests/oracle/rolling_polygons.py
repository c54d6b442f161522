"""Blocks that stand on each other on polygonal feet: statics of rolling, with finite rotations and nothing elastic.

A block stands on a side of its foot while the resultant of all above it passes between the ends of that side, and
rolls on to the next where it does not. Nothing of dem_cli is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

JUST = 1e-12  # of a load: a block that is at its limit rolls


class Column(NamedTuple):
    """Equal blocks with equal feet."""

    blocks: int
    height: float  # of a block [m]
    foot: np.ndarray  # corners from left to right, the side that rests at the start on y = 0, (n + 1, 2) [m]
    rest: int  # number of that side


class Stage(NamedTuple):
    """Equilibria on the same sides."""

    begins: float  # load multiplier
    ends: float
    sides: tuple[int, ...]  # that the blocks stand on, from below, counted from the one at rest
    top: np.ndarray  # middle of the top [m], (2,)
    turned: float  # rotation of the top, clockwise [rad]


def column(blocks: int, height: float, lengths: Sequence[float], aperture: float) -> Column:
    """A column on polygons inscribed in a circle, all sides long beside the aperture (thesis 7.3.1).

    Rests on the middle side; where a corner is in the middle, on the side left of it.
    """
    x = np.concatenate([[0.0], np.cumsum(lengths)]) - 0.5 * np.sum(lengths)
    y = aperture * x**2 / (x[0] ** 2 - (x[1:-1] ** 2).min())
    rest = (len(lengths) - 1) // 2
    slope = (y[rest + 1] - y[rest]) / (x[rest + 1] - x[rest])
    return Column(blocks, height, np.column_stack([x, y - y[rest] - slope * (x - x[rest])]), rest)


def standing(made: Column, sides: Sequence[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Centroids (n, 2), both ends of the sides that carry (n, 2, 2), middle of the top (2,) [m] and its turn [rad]."""
    steps = np.diff(made.foot, axis=0)
    slopes, lengths = np.arctan2(steps[:, 1], steps[:, 0]), np.hypot(*steps.T)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    arc += made.foot[made.rest, 0] - arc[made.rest]  # corners laid down one after the other, as the foot rolls
    below, turned = np.zeros(2), 0.0
    centroids, ends = [], []
    for side in sides:
        k = made.rest + side
        along = np.array([np.cos(turned), -np.sin(turned)])
        ends.append([below + arc[k] * along, below + arc[k + 1] * along])
        turned += slopes[k]
        turn = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
        origin = ends[-1][0] - turn @ made.foot[k]
        centroids.append(origin + turn @ [0.0, 0.5 * made.height])
        below = origin + turn @ [0.0, made.height]
    return np.array(centroids), np.array(ends), below, turned


def limits(made: Column, sides: Sequence[int]) -> np.ndarray:
    """Loads below and above which each block, with all above it, rolls to the left and to the right, (n, 2)."""
    centroids, ends, _, _ = standing(made, sides)
    counts = np.arange(len(centroids), 0, -1)[:, None]
    above = np.cumsum(centroids[::-1], axis=0)[::-1] / counts
    arms = ends - above[:, None]
    return -arms[..., 0] / arms[..., 1]


def raised(made: Column) -> list[Stage]:
    """All stages of a load that is raised slowly from 0; the column falls where the last one ends."""
    stages, load, sides, last = [], 0.0, [0] * made.blocks, len(made.foot) - 2 - made.rest
    while True:
        right = limits(made, sides)[:, 1]
        if right.min() > load:
            _, _, top, turned = standing(made, sides)
            stages.append(Stage(load, float(right.min()), tuple(sides), top, turned))
            load = float(right.min())
        rolling = np.flatnonzero(right <= load + JUST)
        if any(sides[i] == last for i in rolling):
            return stages
        for i in rolling:
            sides[i] += 1


def most_turned(made: Column, load: float) -> list[int] | None:
    """Sides of the equilibrium under this load that is turned farthest; None where there is none."""
    last = len(made.foot) - 2 - made.rest
    sides = [last] * made.blocks
    while True:
        left, right = limits(made, sides).T
        back = [i for i in range(made.blocks) if load < left[i] and sides[i] > 0]
        if not back:
            falls = any(load >= right[i] and sides[i] == last for i in range(made.blocks))
            return None if falls else sides
        sides[back[-1]] -= 1


def closed(blocks: int, height: float, base: float, angle: float) -> float:
    """Share of the load of plane joints that is lost with all joints closed, to first order (thesis eq. 7-24)."""
    return height / base * angle * (blocks**2 / 3 + blocks / 2 + 1 / 6)


def weakest(blocks: int, height: float, base: float, angle: float) -> tuple[float, int]:
    """Load at which a column with all joints closed turns about the foot of its upper m blocks, and that m.

    To first order: the least of b/(m h) (1 − ζ_m) − (n − m) φ; eq. 7-24 has m = n alone.
    """
    loads = [
        (base / (m * height) * (1.0 - closed(m, height, base, angle)) - (blocks - m) * angle, m)
        for m in range(1, blocks + 1)
    ]
    return min(loads)
