"""A column of rigid blocks on polygonal feet, pushed until it falls: statics of rolling, with finite rotations.

No contact stiffness, no friction, no time: a block stands on a side of its foot while the resultant of all above
passes between the two ends of that side, and else rolls on to the next. Nothing of dem_cli is used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Fall(NamedTuple):
    """How the column fails."""

    load: float  # multiplier of the weights, horizontally
    top: float  # displacement of the middle of the top before [m]
    sides: tuple[int, ...]  # side of the foot that each block stands on then, from below


def foot(lengths: list[float], aperture: float) -> np.ndarray:
    """Corners of a polygon inscribed in a circle, its middle side (of an odd number) on y = 0, (n + 1, 2)."""
    lengths = np.asarray(lengths, float)

    def corners(radius: float) -> np.ndarray:
        angles = 2.0 * np.arcsin(lengths / (2.0 * radius))
        around = np.concatenate([[0.0], np.cumsum(angles)]) - 0.5 * angles.sum()
        return radius * np.column_stack([np.sin(around), 1.0 - np.cos(around)])

    flat, round_ = 1e7 * lengths.sum(), lengths.sum()
    while flat / round_ > 1.0 + 1e-13:
        radius = np.sqrt(flat * round_)
        y = corners(radius)[:, 1]
        flat, round_ = (radius, round_) if y[0] - y.min() < aperture else (flat, radius)
    found = corners(round_)
    return found - [0.0, found[:, 1].min()]


def fall(blocks: int, height: float, feet: np.ndarray) -> Fall:
    """The load at which a column of equal blocks turns over to the right, raised slowly from zero."""
    steps = np.diff(feet, axis=0)
    slopes, lengths = np.arctan2(steps[:, 1], steps[:, 0]), np.hypot(*steps.T)
    middle = len(slopes) // 2
    arc = np.concatenate([[0.0], np.cumsum(lengths)])  # corners as they are laid down one after the other, rolling
    arc += feet[middle, 0] - arc[middle]
    sides = np.full(blocks, middle)
    load = 0.0
    while True:
        standing = _places(sides, feet, arc, slopes, height)
        limits = _limits(standing)
        load = max(load, limits.min())
        before = Fall(load, float(standing[2][0]), tuple(sides.tolist()))
        while limits.min() <= load:  # one that rolls may take others along
            rolling = int(limits.argmin())
            if sides[rolling] == len(slopes) - 1:
                return before
            sides[rolling] += 1
            limits = _limits(_places(sides, feet, arc, slopes, height))


Places = tuple[np.ndarray, np.ndarray, np.ndarray]


def _places(sides: np.ndarray, feet: np.ndarray, arc: np.ndarray, slopes: np.ndarray, height: float) -> Places:
    """Centroids of all blocks, the corners about which they would roll on to the right, and the top [m]."""
    below, angle = np.zeros(2), 0.0  # middle of the surface below, and its turn
    centroids, pivots = [], []
    for side in sides:
        along = np.array([np.cos(angle), np.sin(angle)])
        angle -= slopes[side]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        origin = below + arc[side] * along - turn @ feet[side]
        pivots.append(below + arc[side + 1] * along)
        centroids.append(origin + turn @ [0.0, height / 2])
        below = origin + turn @ [0.0, height]
    return np.array(centroids), np.array(pivots), below


def _limits(places: Places) -> np.ndarray:
    """Load at which each block, with all above, rolls about its pivot, (n,)."""
    centroids, pivots, _ = places
    limits = []
    for k, pivot in enumerate(pivots):
        arms = (centroids[k:] - pivot).sum(axis=0)
        limits.append(-arms[0] / arms[1])
    return np.array(limits)
