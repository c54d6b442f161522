"""Broad phase in space: pairs of parts with close bounding boxes, at a cost linear in the number of parts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.neighbours import enter_cells, pairs_in_cells, pairs_of_large
from dem_cli.core.model.block_measures import median

CELL = 1.5  # of the median extent: side of a cell
LARGE = 4.0  # of the same: larger parts (a base, a beam) are compared with all others
MOST_CELLS = 1 << 20  # along one axis


def near_boxes(
    corners: np.ndarray, part_starts: np.ndarray, part_blocks: np.ndarray, fixed: np.ndarray, reach: float
) -> np.ndarray:
    """Find pairs of parts a < b of different blocks, not both fixed, with boxes closer than `reach` [m], (n, 2),
    sorted.

    corners: of all parts in place [m], (n_vertices, 3); part p has part_starts[p]:part_starts[p + 1].
    """
    n = len(part_blocks)
    if n < 2:
        return np.zeros((0, 2), np.int64)
    low = np.minimum.reduceat(corners, part_starts[:-1], axis=0)
    high = np.maximum.reduceat(corners, part_starts[:-1], axis=0)
    boxes = np.ascontiguousarray(np.stack([low, high], axis=1))
    extents = (high - low).max(axis=1)
    typical = median(extents)
    is_large = extents > LARGE * typical
    large, small = np.flatnonzero(is_large), np.flatnonzero(~is_large)
    origin, cell = low[small].min(axis=0) - reach, CELL * typical + 2.0 * reach
    span = high[small].max(axis=0) - origin
    cell = max(cell, float(span.max()) / MOST_CELLS)
    grid = (origin, 1.0 / cell, np.maximum(np.ceil(span / cell), 1.0).astype(np.int64))
    cells, entries = _filled(
        lambda cells, entries: enter_cells(boxes, small, *grid, reach, cells, entries), [(8 * n,), (8 * n,)]
    )
    order = np.argsort(cells, kind="stable")
    cells, entries = cells[order], entries[order]
    (pairs,) = _filled(
        lambda out: pairs_in_cells(boxes, cells, entries, part_blocks, fixed, grid, reach, out), [(16 * n, 2)]
    )
    (wide,) = _filled(lambda out: pairs_of_large(boxes, large, part_blocks, fixed, is_large, reach, out), [(4 * n, 2)])
    found = np.concatenate([pairs, wide])
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def _filled(fill: Callable[..., int], shapes: list[tuple[int, ...]]) -> list[np.ndarray]:
    """Fill arrays of whole numbers by a kernel, again with more room where it was not enough."""
    while True:
        arrays = [np.empty(shape, np.int64) for shape in shapes]
        count = fill(*arrays)
        if count <= len(arrays[0]):
            return [array[:count] for array in arrays]
        shapes = [(count, *shape[1:]) for shape in shapes]
