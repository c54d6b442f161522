"""Structure of rigid blocks as arrays: their corners, densities and supports, and the load that acts on them.

The first line of the core's own door: docs/core.md goes from here to failure loads and motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dem_cli.core.geometry import polygon, polyhedron
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.model import Model

SHAPES: dict[int, Callable[[Any], Any]] = {2: polygon.in_order, 3: polyhedron.hull}


class Structure:
    """Rigid, convex blocks that touch where their faces lie on each other, under their weight.

    vertices   corners of each block in any order, one (n, 2) or (n, 3) array of each [m]; the last coordinate is height
    density    of all blocks, or of each [kg/m³]
    fixed      numbers of the blocks that cannot move
    thickness  of all blocks, or of each, out of the plane; in space without a meaning [m]
    gravity    [m/s²]

    Raises ValueError where a block has no area or volume or is not convex, where there are none, and for numbers that
    are not positive.
    """

    def __init__(
        self,
        vertices: Sequence[Any],
        density: float | Sequence[float] = 2000.0,
        fixed: Sequence[int] = (),
        thickness: float | Sequence[float] = 1.0,
        gravity: float = 9.81,
    ) -> None:
        corners = [np.asarray(block, float) for block in vertices]
        dimensions = {block.shape[1] if block.ndim == 2 else 0 for block in corners}
        if len(dimensions) != 1 or not dimensions <= SHAPES.keys():
            raise ValueError("vertices: one array (n, 2) or (n, 3) of each block is wanted, the same way for all")
        (dimension,) = dimensions
        n = len(corners)
        if not all(np.isfinite(block).all() for block in corners):
            raise ValueError("vertices: all coordinates must be finite")
        given = [np.asarray(each, float) for each in (density, thickness, gravity)]
        if any(each.shape not in ((), (n,)) for each in given[:2]):
            raise ValueError(f"density and thickness: one number, or one of each of the {n} blocks, is wanted")
        if not all(np.all(np.isfinite(each) & (each > 0.0)) for each in given):
            raise ValueError("density, thickness and gravity must be positive and finite")
        densities, depths = (np.broadcast_to(each, n) for each in given[:2])
        if not all(0 <= number < n for number in fixed):
            raise ValueError(f"fixed: numbers of blocks are wanted, from 0 to {n - 1}")
        held = np.zeros(n, bool)
        held[list(fixed)] = True
        parts = [(_shape(dimension, k, block),) for k, block in enumerate(corners)]
        depths = depths.copy() if dimension == 2 else np.ones(n)
        bodies = bodies_of(dimension, parts, densities.copy(), depths)
        dead = np.zeros((n, dimension + bodies.inertias.shape[1]))
        dead[:, dimension - 1] = -gravity * bodies.masses
        self.gravity = gravity
        self.model = Model(
            **bodies._asdict(),
            block_ids=tuple(f"{k}" for k in range(n)),
            material_names=("stone",),
            block_material=np.zeros(n, np.int64),
            fixed=held,
            thickness=depths,
            dead_loads=dead,
            live_loads=np.zeros_like(dead),
        )

    def under(self, load: Sequence[float] | np.ndarray) -> Model:
        """Return arrays of the structure with a load that a multiplier acts on.

        load: a direction (d,), along which each block is pushed by its weight (an earthquake as a static force), or a
        force on the centroid of each block (n_blocks, d) [N]. Raises ValueError for other shapes and for no load.
        """
        model, given, d = self.model, np.asarray(load, float), self.model.dimension
        if not np.isfinite(given).all():
            raise ValueError("load: all numbers must be finite")
        if given.shape == (d,) and given.any():
            length = np.sqrt((given * given).sum())
            forces = self.gravity * model.masses[:, None] * given / length
        elif given.shape == (model.n_blocks, d) and given[~model.fixed].any():
            forces = given
        else:
            raise ValueError(f"load: a direction ({d},) or forces ({model.n_blocks}, {d}) are wanted, not all zero")
        live = np.zeros_like(model.live_loads)
        live[:, :d] = np.where(model.fixed[:, None], 0.0, forces)
        return model._replace(live_loads=live)


def _shape(dimension: int, number: int, corners: np.ndarray) -> Any:
    try:
        return SHAPES[dimension](corners)
    except ValueError as error:
        raise ValueError(f"block {number}: {error}") from None
