"""Upright boxes: structures in space as arrays that other programs take."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from dem_cli.core.model.model import Model

OFF_CORNER = 1e-9  # × size: a vertex farther from every corner makes a block no box


class Boxes(NamedTuple):
    """Blocks of one density whose edges lie along x, y and z."""

    centres: np.ndarray  # m, (n, 3)
    sizes: np.ndarray  # m, (n, 3)
    fixed: np.ndarray  # bool, (n,)

    @property
    def smallest_edge(self) -> float:
        """Shortest edge of the free blocks [m]."""
        return float(self.sizes[~self.fixed].min())


def boxes_of(model: Model) -> Boxes:
    """The blocks of a model. Raises ValueError where one is no box."""
    centres, sizes = np.empty((model.n_blocks, 3)), np.empty((model.n_blocks, 3))
    if model.n_parts != model.n_blocks:
        raise ValueError("a block of several parts is no box")
    for p, i in enumerate(model.part_blocks.tolist()):
        corners = model.vertices[model.part_starts[p] : model.part_starts[p + 1]]
        low, high = corners.min(axis=0), corners.max(axis=0)
        off = np.minimum(corners - low, high - corners).max()
        if len(corners) != 8 or off > OFF_CORNER * (high - low).max():
            raise ValueError(f"block '{model.block_ids[i]}' is no upright box")
        centres[i], sizes[i] = model.centroids[i] + 0.5 * (low + high), high - low
    return Boxes(centres, sizes, np.asarray(model.fixed, dtype=bool))
