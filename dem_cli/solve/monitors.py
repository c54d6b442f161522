"""[[monitor]]: numbers followed through a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.model.model import Model
from dem_cli.model.places import block_at

if TYPE_CHECKING:
    from dem_cli.case.schema import Case, Monitor
    from dem_cli.solve.simulation import Simulation


class Monitors:
    """Values of all monitors of a case at any time; 2D."""

    def __init__(self, case: Case, model: Model):
        from dem_cli.model.assemble import assembly

        self.tables = case.monitor
        names = assembly(case).block_map if any(m.block for m in self.tables) else {}
        self.places = [self._place(m, names, model) for m in self.tables]

    def _place(self, monitor: Monitor, names: dict[str, int], model: Model) -> tuple[int, np.ndarray]:
        """Block and arm of a monitor; that there is a block is checked with the model."""
        if monitor.block is not None:
            return names[monitor.block], np.zeros(2)
        point = np.array(monitor.point)
        block = block_at(model, point)
        assert block is not None  # model.validate
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
