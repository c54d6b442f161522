"""Implicit history under load: from gravity to failure by overdamped steps at constant loads, every one committed.

A step is the contact problem of limit/interior.py with a viscosity C / Δt on its diagonal (backward Euler; C: the own
weight of a block per elastic displacement). Δt grows as long as blocks hardly move, so that a load that is carried
comes to rest in a few steps. At a load that fails blocks move on for ever, and the power of the viscosity says how much
less the structure resists with: λs = λ − Σ C v² / (q · v). Where λs grows no more while the displacement doubles, the
load fails.

It is a history under load: it steps over no plateau. Joints remember their slip from step to step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import cycle, islice
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.engine.static_settings import ImplicitHistorySettings
from dem_cli.core.limit.elastic import Elastic, State
from dem_cli.core.limit.interior import Increment
from dem_cli.core.limit.path import at_rest, compliance, first_products

HOLDS, FAILS, UNDECIDED = "holds", "fails", "undecided"  # verdicts


class Resisted(NamedTuple):
    """Resistance of a structure after a step."""

    displacement: float  # of the live load since gravity, over its elastic one at the multiplier 1
    load: float  # multiplier λs, as users know it


class _Step(NamedTuple):
    """Time step that was solved: its state, length and speed."""

    state: State  # at its end
    length: float
    speed: float  # largest displacement over its length


class Level(NamedTuple):
    """Load that was kept constant, with its verdict."""

    load: float  # multiplier, as users know it
    verdict: str  # HOLDS, FAILS or UNDECIDED
    steps: int
    resisted: float  # highest λs at it, as users know it


class HeldState(NamedTuple):
    """Equilibrium on an implicit history."""

    load: float  # multiplier, as users know it
    normal: np.ndarray  # [N], (n_points,)
    shear: np.ndarray  # [N], (n_points, d − 1)
    gaps: np.ndarray  # [m], (n_points,)
    displacements: np.ndarray  # of the free degrees of freedom since before gravity [m, rad], (n_free,)
    work: float  # of the live loads until then [J]


class LoadHistory(NamedTuple):
    """Implicit history from gravity to the lowest load that failed."""

    high: float  # that load, a multiplier as users know it
    held: list[HeldState]  # equilibria, upwards
    levels: list[Level]  # in the order in which they were tried

    @property
    def low(self) -> float:
        """Return the highest load that was carried."""
        return self.held[-1].load

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json about the implicit history."""
        return {
            "load": self.low,
            "fails": self.high,
            "loads": len(self.levels),
            "steps": sum(level.steps for level in self.levels),
        }


@dataclass
class ImplicitHistory:
    """Implicit history: loads that are carried and fail, in steps from gravity; multipliers as users know them.

    stop: whether to give up, asked before each step. The highest load that held is `low` with its `state`, the lowest
    that failed `high`.
    """

    problem: Elastic
    settings: ImplicitHistorySettings
    stop: Callable[[], bool] = lambda: False
    progress: Callable[[float, float], None] = lambda load, reached: None
    low: float = 0.0
    high: float | None = None
    state: State | None = None  # None: no equilibrium under dead loads was found
    work: float = 0.0  # of the live loads until then [J]
    held: list[HeldState] = field(default_factory=list)
    levels: list[Level] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._reached = 0.0  # displacement at `low`
        self._origin = self._elastic = self._first_step = 0.0
        self._stretched = 0.0  # displacement at which ties yield that cross what opens

    def search(self, bound: float, resolution: float, small: bool = False) -> LoadHistory | None:
        """Search for the load that fails, below a bound, to a relative width; None where it was not found.

        small: in small steps of the load, which meet what larger ones step over. Where a load in the bracket stays
        undecided the bracket may be wider than asked for.
        """
        closed = self._stand() and self._close_in(bound, resolution, small)
        if self.high is None or not self.held or not (closed or self.high < (1.0 + self.settings.widest) * self.low):
            return None
        return LoadHistory(self.high, self.held, self.levels)

    def _close_in(self, bound: float, resolution: float, small: bool) -> bool:
        """Try load after load, until the bracket is as narrow; False where one of them stays undecided.

        What failed after a jump may hold when it is reached in steps: from the last load that held these go on.
        """
        settings, loads = self.settings, self.settings.shares[:1] if small else self.settings.shares
        jumps = [share * bound for share in loads]
        while jumps and self._tried(jumps.pop(0)) == HOLDS:
            pass
        if self.levels[-1].verdict == UNDECIDED:
            return False
        self.high, growth = None, settings.small if small else settings.growth
        while self.high is None:
            if self.low >= (1.0 - resolution) * bound:
                self.high = bound
                return True
            load = min(growth * self.low, 0.5 * (self.low + (1.0 + settings.beyond) * bound))
            if self.stop() or not self.low or self._tried(load) == UNDECIDED:
                return False
        return self._narrowed(resolution)

    def _narrowed(self, resolution: float) -> bool:
        """Narrow the bracket by loads between the last carried and the first failed, beside the plateau of the
        resistance."""
        beside, tries = self.settings.beside * resolution, 0
        while self.high is not None and self.high - self.low > resolution * self.low:
            plateau = next(level.resisted for level in reversed(self.levels) if level.verdict == FAILS)
            tries = tries + 1 if self.levels[-1].verdict == HOLDS else 0
            wanted = ((1.0 - beside) * plateau, (1.0 + beside) * plateau) if tries <= 2 else ()
            middle = 0.5 * (self.low + self.high)
            load = next((load for load in wanted if self.low < load < self.high), middle)
            if self.stop() or self._tried(load) == UNDECIDED:
                return False
        return True

    def _tried(self, load: float) -> str:
        """Return the verdict on a load."""
        self.levels.append(self._hold(load))
        return self.levels[-1].verdict

    def _stand(self) -> bool:
        """Find the equilibrium under dead loads; False: not found."""
        problem, rest = self.problem, at_rest(self.problem)
        for easier, folds in problem.settings.path.easier[: self.settings.under_dead_loads]:
            tau = easier * first_products(problem, rest, None)
            self.state = Increment(problem, rest, None).solve(tau, 0.0, folds, self.stop)
            if self.state is not None:
                break
        else:
            self.state = self._settled(rest)
        if self.state is None:
            return False
        self._origin = float(product(problem.live, self.state.displacements))
        self._elastic = compliance(problem, self.state)
        unit = float(np.abs(problem.elastic().solve(problem.live)).max())
        self._first_step = self.settings.first_step * unit
        if problem.ties is not None:
            self._stretched = self.settings.far_of_ties * problem.ties.longest_elastic / unit
        return self._elastic > 0.0

    def _settled(self, state: State) -> State | None:
        """Find the equilibrium under dead loads, applied at once, by overdamped steps; None: they do not come to
        rest."""
        settings, step = self.settings, self.settings.first_under_dead_loads
        for _ in range(settings.most_under_dead_loads):
            taken = self._step(state, 0.0, step, 0.0)
            if taken is None:
                return None
            state, step = taken.state, settings.growth_of_step * taken.length
            if taken.speed < settings.at_rest:
                return state
        return None

    def _displacement(self, state: State) -> float:
        return (float(product(self.problem.live, state.displacements)) - self._origin) / self._elastic

    def _hold(self, load: float) -> Level:
        """Hold a constant load from the highest that was carried so far; where it is carried it becomes the
        highest."""
        problem, settings, state, reached = self.problem, self.settings, self.state, self._reached
        assert state is not None
        step, last, past = self._first_step, 0.0, list[Resisted]()
        far = max(settings.far * reached, settings.far_per_load * load, self._stretched)
        for steps in range(1, settings.most_steps + 1):
            taken = self._step(state, load / problem.live_scale, step, step / last if last else 0.0)
            if taken is None:
                break
            moved = taken.state.displacements - state.displacements
            work, lost = float(product(problem.live, moved)), float(product(problem.own * moved, moved)) / taken.length
            lacking = lost / work * problem.live_scale if work > 0.0 else 0.0
            state, last, before, reached = taken.state, taken.length, reached, self._displacement(taken.state)
            past.append(Resisted(reached, load - lacking))
            self.progress(load, reached)
            if taken.speed < settings.at_rest:
                self._keep(load, state, reached)
                return Level(load, HOLDS, steps, load)
            half = [one.load for one in past if one.displacement <= 0.5 * reached]
            since = [one.load for one in past if one.displacement > 0.5 * reached]  # none where it went back
            least = load - max(since, default=load)  # that lacked while the displacement doubled
            if reached > far and half and least > settings.flat * (load - half[-1]):
                self.high = load
                return Level(load, FAILS, steps, max(one.load for one in past))
            grown = reached - before
            share = settings.share * max(reached, 0.5) / grown if grown > 0.0 else np.inf
            step = last * min(settings.growth_of_step, share)
        return Level(load, UNDECIDED, len(past), max((one.load for one in past), default=0.0))

    def _step(self, state: State, load: float, length: float, longer: float) -> _Step | None:
        """Solve a time step, made shorter with other first products as often as it fails; None: it failed in all
        sizes.

        longer: its length over that of the step before, by which slips go on.
        """
        problem, settings = self.problem, self.settings
        largest = max(float(state.normal.max(initial=1.0)), 1.0) ** 2
        for tau in (settings.tau, *islice(cycle(settings.other_tau), settings.most_failed)):
            if self.stop():
                return None
            increment = Increment(problem, state, None, load, settings.end, problem.own / length)
            found = increment.solve(tau * largest, min(longer, settings.ahead), 0, self.stop)
            if found is not None:
                speed = float(np.abs(found.displacements - state.displacements).max()) / length
                return _Step(found, length, speed)
            length, longer = length / settings.cut, longer / settings.cut
        return None

    def _keep(self, load: float, state: State, reached: float) -> None:
        weight = self.problem.weight * self.problem.unit
        self.work += load / self.problem.live_scale * (reached - self._reached) * self._elastic * weight
        self.low, self.state, self._reached = load, state, reached
        moved = self.problem.displacements(state.displacements)
        self.held.append(HeldState(load, *self.problem.forces_and_gaps(state), moved, self.work))
