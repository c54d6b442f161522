"""Panels: regions of a wall that a pattern of stones fills, with holes, and the stones as blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import polygon
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.patterns.cut import without_holes
from dem_cli.masonry.structures.patterns.short_edges import collapsed, drawn_onto, sides_of
from dem_cli.masonry.structures.patterns.tiling import SAME, Tiling, merged

LEAST_SHARE = 0.25  # of the mean stone: what is smaller becomes part of a neighbour
NEAR = 0.1  # of the mean side: corners so close to a hole are moved onto its sides
NARROWEST = 0.25  # of the mean side: narrower lips along a hole as well


class WallPanel(NamedTuple):
    """Panel of a wall to be filled with stones.

    outline  convex, counter-clockwise, its lowest side level [m], (n, 2)
    holes    convex, counter-clockwise: what is left out, openings, lintels, stones that others lay [m], each (n, 2)
    """

    outline: np.ndarray
    holes: tuple[np.ndarray, ...] = ()

    @property
    def area(self) -> float:
        """Area including the holes [m2]."""
        return polygon.area(self.outline)


def rectangular(length: float, height: float, boxes: Sequence[Sequence[float]] = ()) -> WallPanel:
    """Create the panel of a wall from its lower left corner, with rectangular holes [left, bottom, right, top] [m]."""
    return WallPanel(polygon.rectangle(0.0, 0.0, length, height), tuple(_rectangle(box) for box in boxes))


def _rectangle(box: Sequence[float]) -> np.ndarray:
    x0, y0, x1, y1 = box
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], float)


def fitted(tiling: Tiling, panel: WallPanel, mean: float, shortest: float) -> Tiling:
    """Cut stones around the holes of a panel; pieces below a quarter of a mean stone [m2] join a neighbour.

    shortest: edges along the holes below this share of the mean side collapse.
    """
    if not panel.holes:
        return merged(tiling, LEAST_SHARE * mean)
    side = mean**0.5
    tiling = drawn_onto(tiling, panel.holes, max(shortest, NEAR) * side, sides_of([panel.outline]))
    tiling = without_holes(tiling, panel.holes, NARROWEST * side)
    if not tiling.stones:
        return tiling
    tiling = collapsed(tiling, shortest * side, sides_of([panel.outline, *panel.holes]))
    return merged(tiling, LEAST_SHARE * mean, NARROWEST * side)


def blocks_of(tiling: Tiling, thickness: float = 1.0, prefix: str = "") -> list[Block]:
    """Create the blocks of a panel with local names, from the lowest up and from left to right.

    "<course>-<number>" where there are courses, else "<number>"; a prefix goes before.
    """
    parts = [tiling.parts(k) for k in range(len(tiling.stones))]
    middles = _middles(parts)
    step = SAME * polygon.size(tiling.corners)
    sideways, up = np.rint(middles / step).T
    courses = np.array(tiling.courses)
    order = np.lexsort((sideways, np.where(courses > 0, 0.0, up), courses))
    found, numbers = [], dict.fromkeys(tiling.courses, 0)
    for k in order.tolist():
        course = tiling.courses[k]
        numbers[course] += 1
        name = f"{prefix}{course}-{numbers[course]}" if course else f"{prefix}{numbers[course]}"
        found.append(Block(name, parts[k], "", thickness, course=course))
    return found


def _middles(stones: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """Compute the centroids of stones of some parts each [m], (n_stones, 2)."""
    parts = [part for each in stones for part in each]
    found = polygon.properties_of_all(np.concatenate(parts), np.cumsum([0, *map(len, parts)]))
    first = np.cumsum([0, *map(len, stones)])
    middles = found.area[first[:-1], None] * found.centroid[first[:-1]] / found.area[first[:-1], None]
    for k in np.flatnonzero(np.diff(first) > 1).tolist():
        own = slice(first[k], first[k + 1])
        middles[k] = product(found.area[own], found.centroid[own]) / found.area[own].sum()
    return middles
