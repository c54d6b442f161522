"""Detection of crowded parts: convex parts that lie in the same place by the hundred, found without comparing all
pairs.
"""

from __future__ import annotations

import numpy as np

from dem_cli.input_limits import MOST_TOGETHER

CELL = 0.5  # of the median extent: side of a cell in which middles of parts that only touch are few
INSIDE = 0.05  # of its extent: by so much a box is made smaller on each side, so that neighbours lie apart
LOOKED_AT = 10 * MOST_TOGETHER  # parts of the fullest cell that are compared


def crowd(corners: np.ndarray, starts: np.ndarray) -> np.ndarray | None:
    """Find more than MOST_TOGETHER parts whose bounding boxes all overlap that of the first; None where there are none.

    corners: of all parts in place [m], (n_vertices, d); part p has starts[p]:starts[p + 1].
    """
    if len(starts) <= MOST_TOGETHER + 1:
        return None
    low = np.minimum.reduceat(corners, starts[:-1], axis=0)
    high = np.maximum.reduceat(corners, starts[:-1], axis=0)
    middles, extents = 0.5 * (low + high), high - low
    cells = np.floor((middles - middles.min(axis=0)) / (CELL * np.median(extents.max(axis=1))))
    _, numbers, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    if counts.max() <= MOST_TOGETHER:
        return None
    inside = np.flatnonzero(numbers.ravel() == counts.argmax())[:LOOKED_AT]
    low, high = low[inside] + INSIDE * extents[inside], high[inside] - INSIDE * extents[inside]
    together: np.ndarray = np.all((low[:, None] < high) & (low < high[:, None]), axis=2)
    fullest = int(together.sum(axis=1).argmax())
    if together[fullest].sum() <= MOST_TOGETHER:
        return None
    others = np.flatnonzero(together[fullest])
    return inside[np.concatenate([[fullest], others[others != fullest]])]
