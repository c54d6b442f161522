"""Displacement control: equilibria at prescribed displacements of the live load, and the capacity curve that they make.

The displacement is that of the live load itself, q·u over the sum of its forces: of one force that of its point along
it, of shares of the weight the mean one, weighted by mass. It grows by an increment in a smooth ramp, then stays until
all forces balance; the multiplier is the reaction in its direction. Between both, velocities are steered towards the
forces (FIRE, Bitzek et al. 2006) without changing that displacement (kernels/advance.py). Every point is a state at
rest under its multiplier, reached from gravity on that way; where another way leads is for the analysis to find out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.engine import measures
from dem_cli.statics.equilibrium import check_finite, limit_falls

if TYPE_CHECKING:
    from dem_cli.engine.budget import Budget
    from dem_cli.engine.simulation import Simulation
    from dem_cli.engine.state import SavedState


class DisplacementControl:
    """Moves a structure at rest to displacements of its live load, each a state at rest.

    first: increment that a ramp of the shortest length belongs to [m] of `displacement`; watch: called now and then.
    """

    def __init__(
        self, sim: Simulation, budget: Budget, compliance: float, watch: Callable[[], None] = lambda: None
    ) -> None:
        self.sim, self.budget, self.settings, self.watch = sim, budget, sim.settings.displacement_control, watch
        self.forces = measures.live_force(sim)  # of the live load [N]
        self.origin = measures.live_travel(sim)
        self.first = self.settings.first * compliance / self.forces

    @property
    def displacement(self) -> float:
        """Of the live load since gravity [m]."""
        return measures.live_travel(self.sim) - self.origin

    def go(self, distance: float) -> bool:
        """On by a distance [m], to rest: in parts where that is not found. Whether all forces balance there."""
        self.sim.use(self.sim.settings.relaxation.fire_safety, damping=0.0)
        limit_falls(self.sim)
        return self._go(distance, self.settings.tries)

    def _go(self, distance: float, tries: int) -> bool:
        sim, settings = self.sim, self.settings
        before = sim.save()
        self._ramp(distance)
        if self._rests():
            return True
        if not tries:
            return False
        sim.restore(before)
        return all(self._go(distance / settings.shares, tries - 1) for _ in range(settings.shares))

    def _ramp(self, distance: float) -> None:
        sim, settings = self.sim, self.settings
        stairs = settings.stairs
        length = max(1, math.ceil(settings.ramp * math.sqrt(max(abs(distance) / self.first, 1.0)) / stairs))
        sim.restart_relaxation()
        for stair in range(stairs):
            share = (stair + 0.5) / stairs
            sim.prescribe_rate(distance * self.forces * 6.0 * share * (1.0 - share) / (stairs * length))
            sim.advance(length, sim.guided_mode)
        sim.prescribe_rate(0.0)
        self.watch()
        self.budget.spend(stairs * length, "moving the live load")
        check_finite(sim)

    def _rests(self) -> bool:
        sim, settings, calm = self.sim, self.settings, 0
        for _ in range(settings.most // settings.look):
            sim.advance(settings.look, sim.guided_mode)
            self.watch()
            self.budget.spend(settings.look, "holding a displacement of the live load")
            calm = calm + 1 if sim.unbalanced < settings.tolerance else 0
            if calm == settings.looks_at_rest:
                return True
        check_finite(sim)
        return False


class CurvePoint(NamedTuple):
    """A state at rest on a capacity curve."""

    displacement: float  # of the live load since gravity [m]
    load: float  # internal multiplier
    largest: float  # displacement of a block [m]


class CapacityCurve:
    """The points of a capacity curve from gravity on, and the state at its highest one.

    whole: whether it came as far as was asked for; else its last point is where nothing rests any more, or, where
    stopped says why, where the run ended.
    """

    def __init__(self) -> None:
        self.points: list[CurvePoint] = []
        self.peak, self.at_peak, self.at_first, self.whole, self.stopped = 0, None, None, False, None

    peak: int
    at_peak: SavedState | None
    at_first: SavedState | None  # after the first increment
    whole: bool
    stopped: str | None

    def add(self, point: CurvePoint, sim: Simulation) -> None:
        """One more point; its state is kept where it is the highest so far."""
        self.points.append(point)
        if len(self.points) == 2:
            self.at_first = sim.save()
        if self.at_peak is None or point.load > self.points[self.peak].load:
            self.peak, self.at_peak = len(self.points) - 1, sim.save()

    @property
    def highest(self) -> CurvePoint:
        """The point of the highest load."""
        return self.points[self.peak]

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacements of the live load [m] and internal multipliers, (n,) each."""
        values = np.array(self.points)
        return values[:, 0], values[:, 1]

    def first_within(self, share: float) -> CurvePoint:
        """The first point whose load is less than a share below the highest one."""
        least = self.highest.load - share * abs(self.highest.load)
        return next(point for point in self.points if point.load >= least)


def trace(
    control: DisplacementControl,
    curve: CapacityCurve,
    until: float,
    longest: float,
    seen: Callable[[CurvePoint], None] = lambda point: None,
    coarser: float = 1.0,
) -> None:
    """The curve from where the structure rests under its dead loads until a block moved by `until` [m], into `curve`.

    longest: by how much blocks move in an increment at most [m]; they begin as elastic ones and grow. coarser: all are
    so many times as long.
    Raises SolverError where the budget ends; the points up to there are kept.
    """
    sim, settings = control.sim, control.settings
    distance, longest = coarser * control.first, coarser * longest
    last = CurvePoint(0.0, 0.0, measures.largest_displacement(sim))
    curve.add(last, sim)
    start = last.largest
    while last.largest - start < until:
        if not control.go(distance):
            return
        point = CurvePoint(control.displacement, sim.load, measures.largest_displacement(sim))
        curve.add(point, sim)
        seen(point)
        moved = abs(point.largest - last.largest)
        steeper = max(moved / distance, 1e-3)
        distance = min(settings.growth * distance, longest / steeper)
        last = point
    curve.whole = True
