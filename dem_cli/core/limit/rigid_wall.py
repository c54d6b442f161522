"""Hand check of a running-bond wall: a rigid part turns about the toe (PhD thesis, MIT, about 2000, Appendix B3).

The wall is cut along the line through the toe that rises at the stagger of the blocks, tan α = 2h/b, and what
lies above it turns as one piece; with a heavy load on top the whole wall does (α = 0). Sliding and the breaking
up of the part above the line are left out: the figure is no bound, it says what the geometry would give.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry import polygon


class TopLoad(NamedTuple):
    """Weight on top of a wall that moves with it and is pushed in proportion."""

    weight: float  # [N], or any unit that the weight of the wall has
    from_toe: float  # horizontal distance from the toe [m]
    height: float  # above the foot of the wall [m]


def split_load(width: float, height: float, slope: float, weight: float = 1.0, top: Sequence[TopLoad] = ()) -> float:
    """Multiplier (horizontal over vertical load) at which the wall above the cut turns about its toe.

    width, height: of the wall [m]; slope: tan α of the cut, 0 for the whole wall; weight: of the whole wall.
    """
    corners = above_the_cut(width, height, slope)
    found = polygon.properties(corners)
    share = weight * found.area / (width * height)
    arms = [TopLoad(float(share), float(found.centroid[0]), float(found.centroid[1])), *top]
    return sum(t.weight * t.from_toe for t in arms) / sum(t.weight * t.height for t in arms)


def above_the_cut(width: float, height: float, slope: float) -> np.ndarray:
    """Return the corners of the part that turns, x from the toe into the wall [m], (n, 2)."""
    rise = width * slope
    if rise < height:
        return np.array([[0.0, 0.0], [width, rise], [width, height], [0.0, height]])
    return np.array([[0.0, 0.0], [height / slope, height], [0.0, height]])
