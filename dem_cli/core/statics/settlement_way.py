"""Settlement of supports and the stage at which a structure stands: the settlement at collapse, by bisection."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.state import SavedState
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.ports import stage
from dem_cli.core.statics.equilibrium import check_finite, settle_or_fail
from dem_cli.core.statics.post_peak import soften_falls


@dataclass
class _Ends:
    """Bracket of looks between which the structure falls."""

    low: int  # it stands
    high: int  # it falls


class SettlementWay:
    """Settlement path: supports move evenly, look by look; saved stations on the way allow to go back.

    motion    whole movement of every block, zero but for the settling supports [m, rad], (n_blocks, n_dof)
    buckles   whether a state at rest does
    path      movement at a share of the way, where it is not that share of the whole: of supports that turn together
    done      looks so far, of `rows`
    standing, failing   where it was last seen to come to rest, and to fail, with the supports held
    """

    LASTING = frozenset(("sim", "path", "buckles"))

    def __init__(
        self,
        sim: Simulation,
        motion: np.ndarray,
        path: Callable[[float], np.ndarray] | None = None,
        buckles: Callable[[Simulation], bool] = lambda sim: False,
    ):
        self.sim, self.path, self.buckles, settlement = sim, path, buckles, sim.settings.settlement
        self.rows, self.done = settlement.rows, 0
        d, n_turns = sim.model.dimension, sim.model.inertias.shape[1]
        reach = np.column_stack([np.ones((len(motion), d)), *[sim.shape.radii] * n_turns])
        self.largest = float(np.abs(motion * reach).max())
        elastic = max(measures.largest_elastic(sim), 1e-9 * sim.smallest)
        steps = max(self.largest / (settlement.per_step * elastic), settlement.fewest)
        self.chunk = max(int(np.ceil(steps / self.rows)), 1)
        self.rate = motion / (self.chunk * self.rows)
        self.stations: dict[int, SavedState] = {}
        self.standing = self.failing = sim.save()

    def begin(self) -> None:
        """Begin the settlement from rest under the dead loads."""
        self.sim.use_combined_damping()
        self.sim.set_load(0.0)
        soften_falls(self.sim, self.largest, self.chunk * self.rows)
        self.sim.move_supports(self.rate)
        self.stations[0] = self.sim.save()

    def go_on(self, budget: Budget) -> None:
        """Move the supports on until the next look."""
        if self.path is not None:
            way = self.path((self.done + 1) / self.rows) - self.path(self.done / self.rows)
            self.sim.move_supports(way / self.chunk)
        self.sim.advance(self.chunk, slot.HOLD_LOAD)
        budget.spend(self.chunk, "moving the supports")
        check_finite(self.sim)
        self.done += 1
        if self.done % self.sim.settings.settlement.station == 0:
            self.stations[self.done] = self.sim.save()

    def stands(self, budget: Budget) -> bool:
        """Test whether the structure comes to rest with the supports fixed where they are."""
        self.sim.move_supports(np.zeros_like(self.rate))
        verdict = settle_or_fail(self.sim, 0.0, budget, measures.dead_scale(self.sim))
        found = verdict.state == "equilibrium" and not self.buckles(self.sim)
        if found:
            self.standing = self.sim.save()
        else:
            self.failing = self.sim.save()
        return found

    @stage
    def go_to(self, number: int, budget: Budget) -> None:
        """Return to an earlier look, on the same way."""
        self.done = max(station for station in self.stations if station <= number)
        self.sim.restore(self.stations[self.done])
        soften_falls(self.sim, self.largest, self.chunk * self.rows)
        while self.done < number:
            self.go_on(budget)

    @stage
    def bracket(self, budget: Budget) -> tuple[int, int]:
        """Find by bisection the last look at which it stands, and the first at which it falls: it does in the end."""
        ends = _Ends(0, self.rows)
        self.sim.stages.resumed(ends)
        while ends.high - ends.low > 1:
            self.sim.stages.offer(ends)
            middle = (ends.low + ends.high) // 2
            self.go_to(middle, budget)
            if self.stands(budget):
                ends.low = middle
            else:
                ends.high = middle
        return ends.low, ends.high
