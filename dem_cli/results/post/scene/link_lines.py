"""Lines of ties and bars in pictures: over all blocks, thick where their axial force is large."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dem_cli.core.records.frames import Frame
from dem_cli.results.post import style

THICKEST, THINNEST = 4.0, 1.1  # points: where the force is largest, and where there is none


def draw_lines(axis: Any, frame: Frame, flat: Callable[[np.ndarray], np.ndarray]) -> None:
    """Draw each piece as thick as its force relative to the largest; nothing without links."""
    if frame.links is None:
        return
    from matplotlib.collections import LineCollection

    starts, sizes = frame.links.places.starts, np.abs(frame.links.forces)
    largest = float(sizes.max(initial=0.0)) or 1.0
    pieces, widths = [], []
    for line, a, b in zip(frame.links.lines(frame), starts, starts[1:], strict=False):
        points = flat(line)
        pieces += list(np.stack([points[:-1], points[1:]], axis=1))
        shares = 0.5 * (sizes[a : b - 1] + sizes[a + 1 : b]) / largest
        widths += (THINNEST + (THICKEST - THINNEST) * shares).tolist()
    axis.add_collection(LineCollection(pieces, colors=style.STEEL, linewidths=widths, capstyle="round", zorder=3.5))
