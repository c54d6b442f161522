"""Limit analysis of tables, and models that are the same structure in other clothes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import LimitLoads, limit_loads
from dem_cli.core.model.model import Model
from engine import block, rectangle, scene, tables


def solved(case, model: Model | None = None, overrides: Sequence[str] = (), **options) -> LimitLoads:
    """Limit analysis of a table or file, of another model of it where given; the associated load alone by default."""
    made = scene(case, *overrides)
    model = made.model if model is None else model
    properties = joint_properties(made.request, model)
    return limit_loads(model, properties, law_of(made.request), **{"associated_only": True} | options)


def on_a_base(*blocks: dict, width: float = 4.0, **more) -> dict:
    """A case of blocks on a wide fixed one with its top at y = 0."""
    return tables(block("base", rectangle(-width, -1.0, width, 0.0), fixed=True), *blocks, **more)


def tower(n: int, width: float = 0.4, height: float = 0.5) -> list[dict]:
    """n equal blocks on each other, the first on y = 0."""
    return [block(f"b{i}", rectangle(0.0, i * height, width, (i + 1) * height)) for i in range(n)]


def rotated(model: Model, angle: float) -> Model:
    """Structure and all loads turned together."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    loads = {name: getattr(model, name).copy() for name in ("dead_loads", "live_loads")}
    for values in loads.values():
        values[:, :2] = values[:, :2] @ turn
    return model._replace(
        centroids=np.ascontiguousarray(model.centroids @ turn),
        vertices=np.ascontiguousarray(model.vertices @ turn),
        **loads,
    )


def renumbered(model: Model, order: np.ndarray) -> Model:
    """The same blocks in another order; every block has one part."""
    spans = [np.arange(model.part_starts[i], model.part_starts[i + 1]) for i in order]
    fields = ("block_material", "fixed", "thickness", "masses", "inertias", "centroids", "dead_loads", "live_loads")
    return model._replace(
        block_ids=tuple(model.block_ids[i] for i in order),
        part_starts=np.concatenate([[0], np.cumsum([len(span) for span in spans])]),
        vertices=model.vertices[np.concatenate(spans)],
        **{name: getattr(model, name)[order] for name in fields},
    )


def mirrored_model(model: Model) -> Model:
    """The mirror image of blocks of one part each, and its loads mirrored too."""
    vertices, centroids = model.vertices.copy(), model.centroids * [-1.0, 1.0]
    for start, end in zip(model.part_starts, model.part_starts[1:]):
        vertices[start:end] = model.vertices[start:end][::-1] * [-1.0, 1.0]
    flip = np.array([-1.0, 1.0, -1.0])
    return model._replace(
        vertices=vertices, centroids=centroids, dead_loads=model.dead_loads * flip, live_loads=model.live_loads * flip
    )
