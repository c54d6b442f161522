"""[[initial]]: blocks that start tilted, displaced or moving; 2D."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.contact.detect import find_joints, world_corners
from dem_cli.contact.start import TOUCH
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.geometry.rotation import turned_as_one

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.engine.simulation import Simulation


INSIDE = 1e-3  # of the smallest edge: deeper than joints give when they close


def set_initial(case: Case, sim: Simulation) -> None:
    """Moves the blocks of all [[initial]] tables, one after the other."""
    names, rest = sim.model.numbers, sim.largest_overlap()
    for table in case.initial:
        chosen = np.array([names[name] for name in table.names])
        if table.tilt:
            _turn(sim, chosen, table.tilt, _pivot(sim, chosen, table.tilt))
        sim.bodies.positions[chosen] += table.displacement
        sim.bodies.velocities[chosen] = table.velocity
        _find_faces(sim)
    _check_apart(case, sim, rest)


def tilt(sim: Simulation, chosen: np.ndarray, angle: float) -> None:
    """Turns blocks as one about the corner on which they then stand, counter-clockwise [rad]."""
    _turn(sim, chosen, angle, _pivot(sim, chosen, angle))
    _find_faces(sim)


def _find_faces(sim: Simulation) -> None:
    """Corners and faces where the blocks are now."""
    bodies = sim.bodies
    bodies.corners[:] = world_corners(sim.shape, bodies.positions, bodies.orientations)
    bodies.travel[:] = np.inf  # wherever they are now, faces are found anew
    sim.detect()


def _check_apart(case: Case, sim: Simulation, rest: float) -> None:
    """Raises CaseError where a block that was moved is inside another, deeper than joints gave before [m]."""
    model, names = sim.model, sim.model.numbers
    faces = find_joints(model, sim.bodies.corners, 0.0, sim.inner)
    for number in np.flatnonzero(faces.separation < -2.0 * rest - INSIDE * sim.smallest):
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


def _pivot(sim: Simulation, chosen: np.ndarray, tilt: float) -> np.ndarray:
    """Where the chosen blocks touch others, the leftmost point for a tilt to the left, else the rightmost (d,)."""
    record = sim.contact_record()
    ours = np.isin(record.blocks, chosen)
    between = (ours.sum(axis=1) == 1) & (record.gap <= TOUCH * sim.smallest)
    points = record.points[between] - sim.origin
    if not len(points):  # nothing holds them: about their lowest corner on that side
        mine = np.isin(sim.shape.corner_blocks, chosen)
        corners = sim.bodies.corners[mine]
        points = corners[corners[:, 1] <= corners[:, 1].min() + 1e-9]
    return points[(points[:, 0] * np.sign(tilt)).argmin()]


def _turn(sim: Simulation, chosen: np.ndarray, angle: float, about: np.ndarray) -> None:
    """Turns the chosen blocks as one."""
    arms = sim.bodies.positions[chosen] - about
    sim.bodies.positions[chosen] = about + turned_as_one(arms, angle)
    sim.bodies.orientations[chosen] += angle
