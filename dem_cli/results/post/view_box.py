"""View box of an animation: the part of space that it shows, and whether the ground moves in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.reader import Results
from dem_cli.results.output.series import HistorySeries
from dem_cli.results.post import frame_measures

_FALLEN = 0.8  # of the size of the structure: what falls farther is not shown
_BELOW = 0.15  # of that: of what falls beside the ground, and below it
_CARRIED = 0.6  # of the width of the structure: a base that moves farther is drawn in its own frame
_GROUND = 0.06  # of the size of what is seen: half the ground that is shown beside it


def carried(results: Results, scale: float) -> bool:
    """Test whether blocks are drawn moving with the base, without leaving the picture or being exaggerated."""
    series = results.series
    if series is None or scale != 1.0 or not len(series.time):
        return False
    travel = float(np.ptp(series.base[:, 2], axis=0).max())
    return 0.0 < travel <= _CARRIED * frame_measures.size(results.model)


def ground(series: HistorySeries | None, frame: Frame) -> np.ndarray:
    """Return the ground displacement at a frame [m], (d,)."""
    if series is None:
        return np.zeros(frame.positions.shape[1])
    return np.array([np.interp(frame.time, series.time, path) for path in series.base[:, 2].T])


def corners(model: Model, frame: Frame, scale: float, moved: np.ndarray | float = 0.0) -> np.ndarray:
    """Compute the corners as drawn: displacements times `scale`, all `moved` along [m], (n_vertices, d)."""
    shown = frame_measures.scaled(model, frame, scale)
    return placed_vertices(model, shown.positions, shown.orientations) + moved


def window(model: Model, places: Sequence[np.ndarray], around: float = _GROUND) -> tuple[np.ndarray, np.ndarray]:
    """Compute the common limits of all pictures: all places of free blocks, not far away, and the nearby ground.

    around: empty space on all sides, over the size of what is seen.
    """
    free = ~model.fixed[model.vertex_blocks]
    shown = free if free.any() else ~free
    rest = rest_vertices(model)
    reach = _FALLEN * float(np.ptp(rest[shown], axis=0).max())
    nearest, farthest = rest[shown].min(axis=0) - reach, rest[shown].max(axis=0) + reach
    if not free.all():  # there is nothing to see below the ground
        down = model.dimension - 1
        nearest[down] = max(nearest[down], min(rest[~free, down].min(), rest[shown, down].min()) - _BELOW * reach)
    near = []
    for corners in places:
        ground = (corners - rest)[~free].mean(axis=0) if not free.all() else 0.0  # carries everything along
        inside = ((corners - ground >= nearest) & (corners - ground <= farthest)).all(axis=1)
        near.append(corners[shown & inside])
    everything, seen = np.concatenate(places), np.concatenate(near)
    seen = seen if len(seen) else rest[shown]
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = float((high - low).max())
    low = np.maximum(np.minimum(everything.min(axis=0), low), low - 2.0 * _GROUND * size)
    high = np.minimum(np.maximum(everything.max(axis=0), high), high + 2.0 * _GROUND * size)
    return low - around * size, high + around * size
