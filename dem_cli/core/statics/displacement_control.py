"""Displacement control: equilibria at prescribed displacements of the live load, and the capacity curve that they make.

The displacement is that of the live load itself, q·u over the sum of its forces: of one force that of its point along
it, of shares of the weight the mean one, weighted by mass; of couples alone that of the far ends of their blocks. It
grows by an increment in a smooth ramp, then stays until all forces balance; the multiplier is the reaction in its
direction. Between both, velocities are steered towards the forces (FIRE, Bitzek et al. 2006) without changing that
displacement (kernels/advance.py). Every point is a state at rest under its multiplier, reached from gravity on that
way; where another way leads is for the analysis to find out.

Where another displacement is controlled, a monitor, that of the live load is chosen so that the monitor comes to where
it should: nothing but the live load pushes the structure there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.ports import stage
from dem_cli.core.statics.equilibrium import check_finite, limit_falls
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.state import SavedState

WATCHED = 8  # looks: where a displacement is held, every so many of them is reported


class Followed(NamedTuple):
    """Displacement of a monitor that is controlled instead of that of the live load."""

    name: str  # of its monitor
    value: Callable[[], float]  # at this instant [m]


class DisplacementControl:
    """Displacement control: moves a structure at rest to displacements of its live load, each a state at rest.

    first: increment that a ramp of the shortest length belongs to [m] of the live load; watch: called now and then;
    of: what displacements are counted of; None: of the live load itself.
    """

    LASTING = frozenset(("sim", "budget", "settings", "watch", "of"))

    def __init__(
        self,
        sim: Simulation,
        budget: Budget,
        compliance: float,
        watch: Callable[[], None] = lambda: None,
        of: Followed | None = None,
    ) -> None:
        self.sim, self.budget, self.settings, self.watch, self.of = (
            sim,
            budget,
            sim.settings.displacement_control,
            watch,
            of,
        )
        self.forces = measures.live_force(sim)  # of the live load [N]
        self.first = self.settings.first * compliance / self.forces
        self.growth = 1.0  # of all forces, at most so far (engine/loads.py)
        self.largest = measures.largest_displacement(sim)  # at the origin
        self.origin = self._place
        self.slope: float | None = None  # of the displacement of the live load over that of the monitor

    @property
    def _place(self) -> float:
        return measures.live_travel(self.sim) if self.of is None else self.of.value()

    @property
    def displacement(self) -> float:
        """Displacement of the live load, or of the monitor, since gravity [m]."""
        return self._place - self.origin

    @property
    def way(self) -> float:
        """Largest displacement of a block since gravity, or that of the monitor [m]."""
        if self.of is None:
            return measures.largest_displacement(self.sim) - self.largest
        return abs(self.displacement)

    @stage
    def go(self, distance: float) -> bool:
        """Move on by a distance of the live load [m], to rest: in parts where that is not found. Whether all
        forces balance.

        Raises SolverError where the live load does not move the monitor, or where the budget ends.
        """
        self.sim.use(self.sim.settings.relaxation.fire_safety, damping=0.0)
        limit_falls(self.sim)
        before, largest = self.displacement, measures.largest_displacement(self.sim)
        rests = self._go(distance, self.settings.tries)
        if self.of is not None and rests:
            moved = self.displacement - before
            if self.slope is None:
                self._require_driven(moved, measures.largest_displacement(self.sim) - largest)
            self.slope = distance / moved if moved else self.slope
        return rests

    def go_to(self, displacement: float, near: float) -> bool:
        """Move to a displacement, of a monitor within `near` of it [m]. Whether all forces balance there."""
        if self.of is None:
            return self.go(displacement - self.displacement)
        if self.slope is None and not self.go(self.first):
            return False
        for share in self.settings.approach:
            left = displacement - self.displacement
            if abs(left) <= near:
                break
            assert self.slope is not None
            if not self.go(share * left * self.slope):
                return False
        return True

    def _require_driven(self, moved: float, largest: float) -> None:
        if abs(moved) <= self.settings.driven * abs(largest):
            assert self.of is not None
            raise SolverError(
                f"the live load does not move monitor '{self.of.name}': it went {moved:.2g} m while blocks went "
                f"{largest:.2g} m; control another one (analysis.of)"
            )

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

    def _steps(self, distance: float) -> float:
        """Length of a ramp: beside the forces that act, blocks that move in a step must not make joints slip."""
        live = float(self.sim.control[slot.LIVE_FACTOR])
        self.growth = max(self.growth, self.sim.acting.growth(live))
        return self.settings.ramp * math.sqrt(max(abs(distance) / (self.growth * self.first), 1.0))

    def _ramp(self, distance: float) -> None:
        sim, stairs = self.sim, self.settings.stairs
        length = max(1, math.ceil(self._steps(distance) / stairs))
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
        for number in range(settings.most // settings.look):
            sim.advance(settings.look, sim.guided_mode)
            if number % WATCHED == 0:
                self.watch()
            self.budget.spend(settings.look, "holding a displacement of the live load")
            calm = calm + 1 if sim.unbalanced < settings.tolerance else 0
            if calm == settings.looks_at_rest:
                return True
        check_finite(sim)
        return False


class CurvePoint(NamedTuple):
    """State at rest on a capacity curve."""

    displacement: float  # of the live load since gravity, or of the monitor that is controlled, as it began [m]
    load: float  # internal multiplier
    largest: float  # displacement of a block [m]
    way: float  # DisplacementControl.way [m]


class CapacityCurve:
    """Points of a capacity curve from gravity on, and the state at its highest one.

    whole: whether it came as far as requested; else its last point is where nothing rests any more, or, where
    stopped says why, where the run ended.
    """

    LASTING = frozenset[str]()

    def __init__(self) -> None:
        self.points: list[CurvePoint] = []
        self.peak, self.at_peak, self.at_first, self.whole, self.stopped = 0, None, None, False, None

    peak: int
    at_peak: SavedState | None
    at_first: SavedState | None  # after the first increment
    whole: bool
    stopped: str | None

    def add(self, point: CurvePoint, sim: Simulation) -> None:
        """Add a point; its state is stored where it is the highest so far."""
        self.points.append(point)
        if len(self.points) == 2:
            self.at_first = sim.save()
        if self.at_peak is None or point.load > self.points[self.peak].load:
            self.peak, self.at_peak = len(self.points) - 1, sim.save()

    @property
    def highest(self) -> CurvePoint:
        """Point of the highest load."""
        return self.points[self.peak]

    @property
    def farthest(self) -> int:
        """Number of the point of the largest displacement: the last one, unless a monitor turns back."""
        return int(np.argmax(self.arrays()[0]))

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacements [m] and internal multipliers, (n,) each."""
        values = np.array(self.points)
        return values[:, 0], values[:, 1]

    def first_within(self, share: float) -> CurvePoint:
        """Return the first point whose load is less than a share below the highest one, which may be infinite."""
        highest = self.highest.load
        least = highest - share * abs(highest) if np.isfinite(highest) else highest
        return next(point for point in self.points if point.load >= least)


@dataclass
class _NextIncrement:
    """Next increment of a capacity curve: its length and direction."""

    distance: float  # of the live load [m]
    along: float = 1.0  # which way the monitor went first
    way: float = 0.0  # so far, as DisplacementControl.way [m]


@stage
def trace(
    control: DisplacementControl,
    curve: CapacityCurve,
    until: float,
    longest: float,
    seen: Callable[[CurvePoint], None] = lambda point: None,
    coarser: float = 1.0,
) -> None:
    """Trace the capacity curve from rest under dead loads until it has gone `until` [m], into `curve`.

    That and longest, the most of an increment [m], are of DisplacementControl.way; increments begin as elastic ones and
    grow. coarser: all are so many times as long. A monitor that first moves against its axis counts against it.
    Raises SolverError where the budget ends, and where a monitor does not move; the points up to there are kept.
    """
    sim, settings = control.sim, control.settings
    longest, ahead = coarser * longest, _NextIncrement(coarser * control.first)
    if not sim.stages.resumed(ahead):
        curve.add(CurvePoint(0.0, 0.0, control.largest, 0.0), sim)
    while ahead.way < until:
        sim.stages.offer(ahead)
        if not control.go(ahead.distance):
            return
        if len(curve.points) == 1:
            ahead.along = math.copysign(1.0, control.displacement)
        largest = measures.largest_displacement(sim)
        point = CurvePoint(ahead.along * control.displacement, sim.load, largest, control.way)
        curve.add(point, sim)
        seen(point)
        steeper = max(abs(point.way - ahead.way) / ahead.distance, 1e-3)
        ahead.distance, ahead.way = min(settings.growth * ahead.distance, longest / steeper), point.way
    curve.whole = True
