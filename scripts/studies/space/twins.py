"""Planar twins: plane models in space, prisms pushed in their plane, which fail at the load of the plane ones."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.polyhedron import prisms
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.model import Model


def twin(model: Model) -> Model:
    """A plane model in space: prisms of its polygons, half of their thickness to either side, with the same loads.

    A moment about z of the plane, from x to its y, is one about −y in space.
    """
    starts = model.part_starts
    corners = model.vertices + model.centroids[model.vertex_blocks]
    outlines = [corners[first:after] for first, after in zip(starts, starts[1:])]
    half = 0.5 * model.thickness[model.part_blocks]
    solids = prisms(outlines, -half, half)
    parts = [[solids[p] for p in np.flatnonzero(model.part_blocks == i)] for i in range(model.n_blocks)]
    density = model.masses / (model.shapes.volumes * model.thickness)
    bodies = bodies_of(3, parts, density, np.ones(model.n_blocks))
    same = {
        name: getattr(model, name) for name in ("block_ids", "material_names", "block_material", "fixed", "aliases")
    }
    dead, live = (_lifted(loads) for loads in (model.dead_loads, model.live_loads))
    ones = np.ones(model.n_blocks)
    return Model(**bodies._asdict(), **same, thickness=ones, dead_loads=dead, live_loads=live)


def _lifted(loads: np.ndarray) -> np.ndarray:
    found = np.zeros((len(loads), 6))
    found[:, 0], found[:, 2], found[:, 4] = loads[:, 0], loads[:, 1], -loads[:, 2]
    return found
