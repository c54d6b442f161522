"""Initial state of a time history: blocks that start tilted, displaced or moving."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.contact.start import TOUCHING_GAP
from dem_cli.core.engine import measures
from dem_cli.core.engine.placement import moves
from dem_cli.core.geometry.rotation import swept
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.requests import InitialRequest


def set_initial(initial: Sequence[InitialRequest], sim: Simulation) -> None:
    """Move the blocks of all requests, one after the other."""
    rest = measures.largest_overlap(sim)
    for one in initial:
        chosen = chosen_blocks(sim.model, one)
        if any(one.turn):
            moves.turn(sim, chosen, np.array(one.turn), pivot_of(sim, chosen, np.array(one.turn)))
        moves.displace(sim, chosen, np.array(one.displacement))
        moves.throw(sim, chosen, np.array(one.velocity))
        moves.find_faces(sim)
    _check_apart(initial, sim, rest)


def chosen_blocks(model: Model, one: InitialRequest) -> np.ndarray:
    """Numbers of the blocks that a request moves, each once."""
    found = np.concatenate([model.chosen(name, False) for name in one.names])
    return found[np.sort(np.unique(found, return_index=True)[1])]


def tilt(sim: Simulation, chosen: np.ndarray, turn: np.ndarray | float) -> None:
    """Turn blocks as one about the corner or edge on which they then stand.

    turn: counter-clockwise, in space axis times angle (3,) [rad].
    """
    turn = np.atleast_1d(turn)
    moves.turn(sim, chosen, turn, pivot_of(sim, chosen, turn))
    moves.find_faces(sim)


def _check_apart(initial: Sequence[InitialRequest], sim: Simulation, rest: float) -> None:
    """Raises CaseError where a block that was moved is inside another, deeper than joints gave before [m]."""
    model = sim.model
    faces = sim.tracking.faces_within(sim.bodies, 0.0)
    for number in np.flatnonzero(faces.separation < -2.0 * rest - sim.settings.history.inside * sim.smallest):
        pair = model.part_blocks[faces.parts[number]].tolist()
        tables = [i for i, t in enumerate(initial) if set(chosen_blocks(model, t).tolist()) & set(pair)]
        if not tables:
            continue
        a, b = (model.block_ids[i] for i in pair)
        message = (
            f"puts blocks '{a}' and '{b}' {-faces.separation[number]:.3g} m into each other; move what is in the way "
            "as well (blocks = [...])"
        )
        raise CaseError([CaseProblem(("initial", tables[-1]), message)])


def pivot_of(sim: Simulation, chosen: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Find the point about which chosen blocks tilt (d,). It touches other blocks, outermost on the side to which
    they tilt: to the left in the plane the leftmost one.
    """
    record = measures.contact_record(sim)
    ours = np.isin(record.blocks, chosen)
    between = (ours.sum(axis=1) == 1) & (record.gap <= TOUCHING_GAP * sim.smallest)
    points = record.points[between] - sim.origin
    if not len(points):  # nothing holds them: about their lowest corner on that side
        mine = np.isin(sim.shape.corner_blocks, chosen)
        corners = sim.bodies.corners[mine]
        points = corners[corners[:, -1] <= corners[:, -1].min() + 1e-9]
    towards = swept(turn, np.eye(sim.model.dimension)[-1])  # where what is above goes
    return points[product(points, towards / norm(towards)).argmax()]
