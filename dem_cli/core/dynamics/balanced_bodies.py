"""Bodies in balance on a corner or an edge: blocks that press flush on each other turn as one body, and a body whose
contact with all others lies on one line in space, or in one point in the plane, is at rest only for the moment.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.connected_groups import connected_groups
from dem_cli.core.arithmetic.products import product
from dem_cli.core.engine.measures import contact_record

if TYPE_CHECKING:
    from dem_cli.core.engine.dynamic import DynamicSimulation


def balances(sim: DynamicSimulation) -> bool:
    """Test whether a block, or several flush on each other, stand on a corner alone, or in space on an edge."""
    record, model, least = contact_record(sim), sim.model, sim.settings.history.edge * sim.smallest
    pressing = np.flatnonzero(record.normal_force > 0.0)
    blocks, points = record.blocks[pressing], record.points[pressing]
    bodies = bodies_of(blocks, points, least, model.n_blocks)
    held = {int(body) for body in bodies[model.held.any(axis=1)]}
    held |= {int(bodies[b]) for link in sim.links for b in np.unique(link.outline()[1])}
    ends = bodies[blocks]
    outside = ends[:, 0] != ends[:, 1]
    ends, points = ends[outside], points[outside]
    return any(
        _on_an_edge(points[(ends == body).any(axis=1)], least) for body in np.unique(ends) if int(body) not in held
    )


def bodies_of(blocks: np.ndarray, points: np.ndarray, least: float, n_blocks: int) -> np.ndarray:
    """Number the bodies that blocks make which press flush on each other, (n_blocks,); a block alone is one.

    blocks (n, 2) and points (n, d) [m] of the contacts that press; least: what counts as one place or line [m].
    """
    pairs, number = np.unique(blocks, axis=0, return_inverse=True)
    flush = [k for k in range(len(pairs)) if not _on_an_edge(points[number == k], least)]
    return connected_groups(pairs[flush], n_blocks)


def _on_an_edge(places: np.ndarray, least: float) -> bool:
    """Test whether points (n, d) are no farther than `least` [m] from one place, or in space from one line."""
    arms = places - places[0]
    lengths = np.sqrt(np.square(arms).sum(axis=1))
    longest = float(lengths.max())
    if longest <= least or arms.shape[1] == 2:
        return longest <= least
    way = arms[lengths.argmax()] / longest
    aside = arms - product(arms, way)[:, np.newaxis] * way
    return bool(np.square(aside).sum(axis=1).max() <= least**2)
