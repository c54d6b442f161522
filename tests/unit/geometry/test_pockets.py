"""Pockets: the hull less an outline, and the box less its hull, in convex pieces that fill them exactly."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.geometry import pockets, polygon
from dem_cli.masonry.structures.voids import overlap

OUTLINES = {
    "square": [[0, 0], [2, 0], [2, 1], [0, 1]],
    "gable": [[0, 0], [2, 0], [2, 1], [1, 2], [0, 1]],
    "battlements": [[0, 0], [5, 0], [5, 2], [4, 2], [4, 1], [3, 1], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]],
    "ruin": [[0.3, 0], [4, 0.2], [5, 1], [3.5, 1.1], [3.8, 2.5], [2, 1.5], [1.5, 3], [1.2, 1], [0, 1.7]],
}


@pytest.mark.parametrize("corners", OUTLINES.values(), ids=OUTLINES)
def test_outline_and_pockets_fill_the_box(corners):
    outline = np.array(corners, float)
    found = [*pockets.hull_pockets(outline), *pockets.box_pockets(pockets.hull(outline))]
    assert all(polygon.is_convex(piece) for piece in found)
    whole = np.prod(np.ptp(outline, axis=0))
    assert polygon.area(outline) + sum(map(polygon.area, found)) == pytest.approx(whole, rel=1e-13)
    assert all(overlap([piece], [*pockets.convex_pieces(outline), *found[:k]]) < 1e-12 for k, piece in enumerate(found))
