"""[[monitor]]: numbers followed through a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.errors import CaseError, CaseProblem
from dem_cli.geometry import polygon
from dem_cli.model.model import Model

if TYPE_CHECKING:
    from dem_cli.case.schema import Case, Monitor
    from dem_cli.solve.simulation import Simulation


class Monitors:
    """Values of all monitors of a case at any time; 2D."""

    def __init__(self, case: Case, model: Model):
        from dem_cli.model.assemble import assembly

        self.tables = case.monitor
        names = assembly(case).block_map if any(m.block for m in self.tables) else {}
        self.places = [self._place(m, i, names, model) for i, m in enumerate(self.tables)]

    def _place(self, monitor: Monitor, i: int, names: dict[str, int], model: Model) -> tuple[int, np.ndarray]:
        """Block and arm of a monitor. Raises CaseError where no block is at its point."""
        if monitor.block is not None:
            return names[monitor.block], np.zeros(2)
        point = np.array(monitor.point)
        block = block_at(model, point)
        if block is None:
            raise CaseError([CaseProblem(("monitor", i, "point"), f"there is no block at {list(monitor.point)}")])
        return block, point - model.centroids[block]

    def values(self, sim: Simulation) -> tuple[float, ...]:
        """In the order of the case file; velocities per unit of the solver's time."""
        return tuple(self._value(sim, m, *place) for m, place in zip(self.tables, self.places, strict=True))

    @staticmethod
    def _value(sim: Simulation, monitor: Monitor, block: int, arm: np.ndarray) -> float:
        bodies = sim.bodies
        angle = float(bodies.orientations[block, 0])
        if monitor.quantity == "rotation":
            return angle
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.array([cosine * arm[0] - sine * arm[1], sine * arm[0] + cosine * arm[1]])
        if monitor.quantity == "displacement":
            vector = bodies.positions[block] - sim.reference_positions[block] + turned - arm
        else:
            source = bodies.velocities[block] if monitor.quantity == "velocity" else sim.accelerations(block)
            vector = source[:2] + source[2] * np.array([-turned[1], turned[0]])
        if monitor.component is None:
            return float(np.hypot(*vector))
        return float(vector["xy".index(monitor.component)])


def block_at(model: Model, point: np.ndarray) -> int | None:
    """Number of the block that contains a point of the undeformed structure (edges count), or None."""
    starts = model.part_starts
    owners = np.repeat(model.part_blocks, np.diff(starts))
    vertices = model.vertices + model.centroids[owners]
    edges, to_point = vertices[polygon.following(starts)] - vertices, point - vertices
    left = edges[:, 0] * to_point[:, 1] - edges[:, 1] * to_point[:, 0]
    size = np.hypot(*edges.T)
    inside = np.minimum.reduceat(left / size, starts[:-1]) >= -1e-9 * size.max()
    found = np.flatnonzero(inside)
    return int(model.part_blocks[found[0]]) if len(found) else None
