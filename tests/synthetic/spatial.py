"""Models of polyhedra without a case file: masses by density, gravity along −z, live load by direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dem_cli.core.geometry.polyhedron import Polyhedron, prisms
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.model import Model

Shape = Polyhedron | Sequence[Polyhedron]


def spatial_model(
    blocks: Sequence[Shape],
    fixed: Sequence[int] = (0,),
    direction: Sequence[float] = (1.0, 0.0, 0.0),
    density: float = 2000.0,
    gravity: float = 9.81,
) -> Model:
    """Blocks (polyhedra, or lists of them: compounds), numbers of the fixed ones; live load: weight × direction."""
    n = len(blocks)
    parts = [[block] if isinstance(block, Polyhedron) else list(block) for block in blocks]
    bodies = bodies_of(3, parts, np.full(n, density), np.ones(n))
    dead, live = np.zeros((n, 6)), np.zeros((n, 6))
    dead[:, 2] = -bodies.masses * gravity
    held = np.isin(np.arange(n), fixed)
    live[~held, :3] = -dead[~held, 2:3] * np.asarray(direction, float)
    return Model(
        **bodies._asdict(),
        block_ids=tuple(f"b{i}" for i in range(n)),
        material_names=("stone",),
        block_material=np.zeros(n, np.int64),
        fixed=held,
        thickness=np.ones(n),
        dead_loads=dead,
        live_loads=live,
    )


def extruded(polygons: Sequence[np.ndarray], depth: float = 1.0) -> list[Polyhedron]:
    """Prisms of polygons (x, z) from y = 0 to `depth`: a planar structure in space."""
    return prisms([np.asarray(each, float) for each in polygons], 0.0, depth)
