"""Voronoi patterns: rubble and polygonal masonry as cells of random seeds, relaxed (Lloyd 1982), in a convex shape."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Positive
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import polygon
from dem_cli.input_limits import MOST_STONES
from dem_cli.masonry.structures.patterns.panel import WallPanel, fitted
from dem_cli.masonry.structures.patterns.short_edges import collapsed, sides_of
from dem_cli.masonry.structures.patterns.tiling import SAME, Tiling

FEWEST_CELLS = 2
FLATTEST = 1e-4  # of the longer side of an outline: cells of flatter ones are lost in round-off
FAR = 10.0  # times the size of an outline: from the origin, where areas and Qhull lose digits


class VoronoiPattern(CaseModel):
    """Stones as the Voronoi cells of random points."""

    cells: int | None = Field(
        None, ge=FEWEST_CELLS, le=MOST_STONES, description="number of stones before openings are cut", examples=[200]
    )
    cell: Positive | None = Field(
        None, description="mean side of a stone, the root of its mean area [m], instead of cells", examples=[0.4]
    )
    relax: int = Field(
        3,
        ge=0,
        le=1000,
        description="Lloyd steps, each moves the points to the centroids of their cells; 0: irregular, as drawn at "
        "random; 3: rubble; 20: polygonal masonry of stones alike",
        examples=[3],
    )
    shortest: float = Field(
        0.05,
        ge=0.0,
        le=0.3,
        description="edges below this share of the mean side collapse, for all stones at once [-]",
        examples=[0.05],
    )
    stretch: float = Field(
        1.0, gt=0.1, lt=10.0, description="stones are so much longer than high, in the mean [-]", examples=[1.5]
    )

    @model_validator(mode="after")
    def _one_number_of_cells(self) -> VoronoiPattern:
        if (self.cells is None) == (self.cell is None):
            found = "found none" if self.cells is None else "found both"
            raise KeyProblem(f"needs either cells or cell; {found}", "cells" if self.cells is None else "cell")
        return self

    def count(self, area: float) -> int:
        """Return the number of stones of an area [m2]. Raises KeyProblem: too few, too many."""
        if self.cell is None:
            return self.cells or FEWEST_CELLS
        count = area / self.cell**2
        if not FEWEST_CELLS - 0.5 <= count <= MOST_STONES:
            few = count < FEWEST_CELLS
            side = (area / (FEWEST_CELLS if few else MOST_STONES)) ** 0.5
            limit = f"at most {side:.4g}" if few else f"at least {side:.4g}"
            many = "only one stone" if few else f"{count:.3g} stones, more than {MOST_STONES:,}"
            raise KeyProblem(f"{self.cell:g} makes {many}; must be {limit}", "cell")
        return round(count)


def stones_in(panel: WallPanel, pattern: VoronoiPattern, draws: np.random.Generator) -> Tiling:
    """Generate Voronoi stones that fill a panel; slivers at its holes join their neighbours.

    Stones that are not convex, because short edges collapsed or slivers were added, are compounds of convex parts.
    """
    count = pattern.count(panel.area)
    tiling = cells_in(panel.outline, count, pattern, draws)
    return fitted(tiling, panel, panel.area / count, pattern.shortest)


def cells_in(outline: np.ndarray, count: int, pattern: VoronoiPattern, draws: np.random.Generator) -> Tiling:
    """Generate Voronoi cells of `count` random seeds that fill a convex outline (n, 2) exactly."""
    low, (long, high) = outline.min(axis=0), np.ptp(outline, axis=0)
    if min(long, high) < FLATTEST * max(long, high):
        raise KeyProblem(f"needs sides that differ by less than 1 to {1 / FLATTEST:g}; found {long:g} by {high:g} m")
    origin = np.where(np.abs(low).max() > FAR * max(long, high), low, 0.0)
    scale = np.array([pattern.stretch**0.5, pattern.stretch**-0.5])
    flat = (outline - origin) / scale  # where stones are as long as high
    seeds = _seeds(flat, count, draws)
    for _ in range(pattern.relax):
        cells = _voronoi(flat, seeds)
        loops = np.concatenate([cells.corners[list(loop)] for loop in cells.stones])
        seeds = polygon.properties_of_all(loops, np.cumsum([0, *map(len, cells.stones)])).centroid
    cells = _voronoi(flat, seeds)
    side = (polygon.area(flat) / count) ** 0.5
    cells = collapsed(cells, pattern.shortest * side, sides_of([flat]))
    return Tiling(_on_outline(cells.corners * scale + origin, outline), cells.stones, cells.courses)


def _seeds(outline: np.ndarray, count: int, draws: np.random.Generator) -> np.ndarray:
    """Draw random points, uniform in a convex outline, (count, 2)."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    edges = np.roll(outline, -1, axis=0) - outline
    found: list[np.ndarray] = []
    while sum(map(len, found)) < count:
        points = low + draws.random((count, 2)) * (high - low)
        arms = points[:, None] - outline
        inside = (edges[:, 0] * arms[:, :, 1] - edges[:, 1] * arms[:, :, 0]).min(axis=1) > 0.0
        found.append(points[inside])
    return np.concatenate(found)[:count]


def _voronoi(outline: np.ndarray, seeds: np.ndarray) -> Tiling:
    """Compute Voronoi cells within a convex outline: mirrored seeds make its sides edges of cells."""
    from scipy.spatial import Voronoi

    images = []
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        normal = np.array([end[1] - start[1], start[0] - end[0]]) / np.hypot(*(end - start))
        images.append(seeds - 2.0 * product(seeds - start, normal)[:, None] * normal)
    found = Voronoi(np.concatenate([seeds, *images]))
    loops = [np.array(found.regions[found.point_region[k]]) for k in range(len(seeds))]
    used = np.unique(np.concatenate(loops))
    corners = _on_outline(found.vertices[used], outline)
    same = _first_of_same(corners, SAME * polygon.size(outline))
    stones = []
    for loop in loops:
        around = list(dict.fromkeys(same[np.searchsorted(used, loop)].tolist()))
        stones.append(tuple(around if polygon.signed_area(corners[around]) > 0.0 else around[::-1]))
    return Tiling(corners, stones, [0] * len(stones))


def _first_of_same(points: np.ndarray, gap: float) -> np.ndarray:
    """Return for each point the first one in the same place: Qhull repeats corners of four cells."""
    from scipy.spatial import cKDTree

    names = np.arange(len(points))
    for i, j in sorted(cKDTree(points).query_pairs(gap)):
        names[j] = min(names[i], names[j])
    return names


def _on_outline(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Snap points within round-off to the corners and the upright or level sides of an outline."""
    points, gap = points.copy(), SAME * polygon.size(outline)
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        for axis in (0, 1):
            if start[axis] == end[axis]:
                points[np.abs(points[:, axis] - start[axis]) <= gap, axis] = start[axis]
        points[np.hypot(*(points - start).T) <= gap] = start
    return points
