"""[[initial]]: blocks that start tilted, displaced or moving; 2D."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.contact.start import TOUCHING_GAP
from dem_cli.engine import measures
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.engine.simulation import Simulation


def set_initial(case: Case, sim: Simulation) -> None:
    """Moves the blocks of all [[initial]] tables, one after the other."""
    names, rest = sim.model.numbers, measures.largest_overlap(sim)
    for table in case.initial:
        chosen = np.array([names[name] for name in table.names])
        if table.tilt:
            sim.turn(chosen, table.tilt, _pivot(sim, chosen, table.tilt))
        sim.displace(chosen, np.array(table.displacement))
        sim.throw(chosen, np.array(table.velocity))
        sim.find_faces()
    _check_apart(case, sim, rest)


def tilt(sim: Simulation, chosen: np.ndarray, angle: float) -> None:
    """Turns blocks as one about the corner on which they then stand, counter-clockwise [rad]."""
    sim.turn(chosen, angle, _pivot(sim, chosen, angle))
    sim.find_faces()


def _check_apart(case: Case, sim: Simulation, rest: float) -> None:
    """Raises CaseError where a block that was moved is inside another, deeper than joints gave before [m]."""
    model, names = sim.model, sim.model.numbers
    faces = sim.tracking.faces_within(sim.bodies, 0.0)
    for number in np.flatnonzero(faces.separation < -2.0 * rest - sim.settings.history.inside * sim.smallest):
        pair = model.part_blocks[faces.parts[number]].tolist()
        tables = [i for i, t in enumerate(case.initial) if {names[name] for name in t.names} & set(pair)]
        if not tables:
            continue
        a, b = (model.block_ids[i] for i in pair)
        message = (
            f"puts blocks '{a}' and '{b}' {-faces.separation[number]:.3g} m into each other; move what is in the way "
            "as well (blocks = [...])"
        )
        raise CaseError([CaseProblem(("initial", tables[-1]), message)])


def _pivot(sim: Simulation, chosen: np.ndarray, angle: float) -> np.ndarray:
    """Where the chosen blocks touch others, the leftmost point for a tilt to the left, else the rightmost (d,)."""
    record = measures.contact_record(sim)
    ours = np.isin(record.blocks, chosen)
    between = (ours.sum(axis=1) == 1) & (record.gap <= TOUCHING_GAP * sim.smallest)
    points = record.points[between] - sim.origin
    if not len(points):  # nothing holds them: about their lowest corner on that side
        mine = np.isin(sim.shape.corner_blocks, chosen)
        corners = sim.bodies.corners[mine]
        points = corners[corners[:, 1] <= corners[:, 1].min() + 1e-9]
    return points[(points[:, 0] * np.sign(angle)).argmin()]
