"""The failure load: a start next to it or a creep that says where it is, then loads raised, each with its proof.

Where a static solver left a state next to failure (statics/warm_start.py), it is held a little below its load, and the
load is raised from there. Else, and where that does not hold, it is raised from gravity:

Equilibrium exists at every prescribed displacement, so nothing has to be guessed for the estimate: the
live load is replaced by a prescribed rate of its own displacement q·u, and its multiplier is found as a
reaction. The rate is halved several times and then set to zero; what is left is close to the failure load,
but a joint that slides back and forth on that way may have lost strength. The answer therefore comes from
the way that a tilting table takes: the load is raised from gravity in steps that shrink towards the
estimate, every step a proven equilibrium, until failure is proven as well and the bracket is narrow enough. Where the
creep ended in an equilibrium inside that bracket, that one is the highest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.engine import measures
from dem_cli.engine.budget import Budget
from dem_cli.errors import SolverError
from dem_cli.kernels import records as slot
from dem_cli.statics.compliance import compliance
from dem_cli.statics.equilibrium import Verdict, check_finite, settle_or_fail
from dem_cli.statics.failure_bracket import FailureLoad, LoadPass, SearchRange
from dem_cli.statics.warm_start import GRAVITY, place

if TYPE_CHECKING:
    from dem_cli.engine.simulation import Simulation
    from dem_cli.engine.track import Track
    from dem_cli.statics.warm_start import WarmStart


AGAINST = "a small live load moves the structure against its direction: it hardly stands as it is"


class LoadSearch:
    """The search of the failure load of a structure that stands under its dead loads (see the module docstring).

    What is found goes to `answer` as it is found, so that it is not lost where the budget ends; the equilibria are
    kept as rows in the track. Loads inside are internal multipliers.
    """

    def __init__(self, sim: Simulation, wanted: SearchRange, budget: Budget, track: Track, answer: FailureLoad) -> None:
        self.sim, self.budget, self.track, self.answer = sim, budget, track, answer
        self.resolution, self.settings, scale = wanted.resolution, sim.settings.load_search, sim.live_scale
        self.limit = self.settings.locked if wanted.max_load is None else wanted.max_load / scale
        self.longest = None if wanted.longest is None else wanted.longest / scale
        self.plateau = False  # the load is known to grow no more with displacement
        answer.scale, answer.limit = scale, self.limit * scale

    def run(self, start: WarmStart | None = None) -> None:
        """The bracket; start: a state next to failure, instead of creep and loads raised from gravity.

        Where it does not hold, these are the way after all; where joints have a profile, nothing is estimated first.
        Raises SolverError where the live load moves nothing, or where the budget ends.
        """
        sim, answer, settings = self.sim, self.answer, self.settings
        answer.low, answer.held, answer.settled = 0.0, sim.save(), measures.largest_displacement(sim)
        answer.compliance, answer.elastic = compliance(sim)
        if answer.compliance <= 0.0:
            if sim.loads.live[sim.free].any():
                raise SolverError(AGAINST)
            raise SolverError("the live load moves nothing: no free block has a live load")
        if start is not None and self._holds(start):
            low = answer.carried / sim.live_scale
            if start.limits is not None and start.limits.associated.upper is not None:
                above = (1.0 + settings.beyond_impossible) * start.limits.associated.upper / sim.live_scale
                if above <= min(self.limit, (1.0 + max(self.resolution, settings.coarse)) * low):
                    self._fail_above(above)
                    return
            self.plateau = start.plateau
            self._raise_load(low, [], settings.one_step * self.resolution * low)
        elif self.longest is not None or sim.play.moved.any():  # a creep would stop at the first microrotation
            first = settings.first_in_play if self.longest is None else self.longest
            self._raise_load(0.0, [], first, np.inf if self.longest is None else self.longest)
        else:
            self.track.observer.progress("estimating the failure load", 0.0, 0.0, 0.05)
            estimate = self._creep(settings.reach * answer.compliance)
            sim.restore(answer.standing)
            estimate = min(estimate if estimate > 0.0 else settings.probe, self.limit)
            levels = [share * estimate for share in settings.shares]
            self._raise_load(0.0, levels, settings.first_step * self.resolution * estimate)

    def _holds(self, start: WarmStart) -> bool:
        """Whether the explicit solver holds the state of `start` a little below its load; else all is as it was."""
        sim, answer = self.sim, self.answer
        load = (1.0 - self.settings.below * self.resolution) * start.load / sim.live_scale
        if not 0.0 < load < self.limit:
            return False
        self.track.observer.progress("holding the start", load * sim.live_scale, 0.0, None)
        place(sim, start)
        before = sim.steps
        verdict = settle_or_fail(sim, load, self.budget, answer.elastic * load)
        self._passed("start", before, load, verdict.state)
        if verdict.state != "equilibrium":
            sim.restore(answer.standing)
            answer.start |= {"kind": GRAVITY, "note": "the start did not hold; the load is raised from gravity"}
            return False
        self._keep(load)
        return True

    def _fail_above(self, load: float) -> None:
        """Failure at a load that limit analysis proved impossible: its mechanism gains more work than any forces in
        the friction cones can take, and the explicit solver shows that the structure moves on and releases energy.
        """
        sim, answer, relaxation = self.sim, self.answer, self.sim.settings.relaxation
        self.track.observer.progress("failing", load * sim.live_scale, answer.peak_displacement, None)
        before, start, ledger = sim.steps, sim.places(), measures.energy_sums(sim)
        sim.use_combined_damping()
        sim.set_load(load)
        moved, released = 0.0, 0.0
        while moved < self.settings.shown * answer.elastic * load or released <= 0.0:
            sim.advance(relaxation.chunk, slot.HOLD_LOAD)
            self.budget.spend(relaxation.chunk, f"at load multiplier {load * sim.live_scale:.5g}")
            check_finite(sim)
            moved = float(np.abs(sim.places() - start).max())
            now = measures.energy_sums(sim)
            given = now.given - ledger.given
            released = 1.0 - (now.taken - ledger.taken) / given if given > 0.0 else 0.0
        answer.failing = Verdict("failure", sim.unbalanced, released)
        self._passed("impossible", before, load, "failure")
        answer.high, answer.status, answer.found = load * sim.live_scale, "ok", True
        self.track.keep("collapse")

    def _creep(self, distance: float) -> float:
        """Internal multiplier to which a decelerating creep over about `distance` [J] settles: an estimate.

        Where geometry moves, a creep that passed the peak of the curve stops there and gives the peak.
        """
        sim, settings = self.sim, self.settings
        sim.use(sim.settings.relaxation.creep_safety)
        rate, before = distance / settings.first_phase, sim.steps
        loads: list[float] = []
        for phase in range(settings.phases + 1):
            sim.prescribe_rate(rate * 0.5**phase)
            for _ in range(settings.looks if phase == 0 else settings.looks // 2):
                sim.advance(settings.first_phase // settings.looks, sim.creep_mode)
                loads.append(sim.mean_load)
            check_finite(sim)
            if sim.kinematics == "large" and loads[-1] < settings.softened * max(loads):
                break
        else:
            self._hold_creep()
        softened = sim.kinematics == "large" and sim.load < settings.softened * max(loads)
        estimate = max(loads) if softened else sim.load
        self.budget.spend(sim.steps - before, "creeping to failure")
        self._passed("creep", before, estimate, "estimate")
        return estimate

    def _hold_creep(self) -> None:
        """The end of a creep at rate zero; an equilibrium in which it ends is kept."""
        sim, relaxation, calm = self.sim, self.sim.settings.relaxation, 0
        sim.prescribe_rate(0.0)
        for _ in range(self.settings.hold_steps // relaxation.chunk):
            sim.advance(relaxation.chunk, sim.creep_mode)
            calm = calm + 1 if sim.unbalanced < relaxation.tolerance else 0
            if calm == relaxation.looks_at_rest:
                self.answer.crept = sim.load
                sim.rest()
                self.answer.crept_state = sim.save()
                return

    def _raise_load(self, low: float, levels: list[float], step: float, longest: float = np.inf) -> None:
        """From a proven equilibrium up, first to `levels`, then by growing steps, after failure back by halves."""
        answer, settings, first_step = self.answer, self.settings, step
        high: float | None = None
        failed, jumped = answer.standing, False
        while high is None or jumped or high - low > self._width(low):
            if high is not None and high - low <= self._width(low):
                load = high  # failed after a jump, which may break what a gentler step does not: again from close by
            elif high is not None:
                load = 0.5 * (low + high)
            elif levels:
                load = levels.pop(0)
            else:
                load, step = low + step, min(settings.growth * step, longest)
            load = min(load, self.limit)
            verdict = self._settle(load)
            if verdict.state == "equilibrium":
                if high is not None and load >= high:
                    high, step = None, first_step
                low, jumped = load, False if high is None else jumped
                self._keep(low)
                if low >= self.limit:
                    answer.status = "no failure"
                    return
            else:
                jumped = load - low > settings.jump * self.resolution * max(abs(low), settings.least)
                high, failed = load, self.sim.save()
                answer.high, answer.failing = high * self.sim.live_scale, verdict
        self._try_crept(low, high)
        answer.status, answer.found = "ok", True
        self.sim.restore(failed)
        self.track.keep("collapse")

    def _width(self, low: float) -> float:
        """Width of the bracket that is asked for above a proven equilibrium."""
        return self.resolution * max(abs(low), self.settings.least)

    def _try_crept(self, low: float, high: float) -> None:
        """The equilibrium of the creep, where it is inside the bracket: closer to failure, if it holds as well."""
        answer = self.answer
        if answer.crept is None or not low < answer.crept < high:
            return
        answer.held, held = answer.crept_state, answer.held
        if self._settle(answer.crept).state == "equilibrium":
            self._keep(answer.crept)
        else:
            answer.held = held

    def _settle(self, load: float) -> Verdict:
        """The verdict on a load, from the highest equilibrium so far."""
        sim, answer = self.sim, self.answer
        self.track.observer.progress("raising the load", load * sim.live_scale, answer.peak_displacement, None)
        sim.restore(answer.standing)
        before = sim.steps
        verdict = settle_or_fail(sim, load, self.budget, answer.elastic * abs(load), plateau=self.plateau)
        self._passed("load", before, load, verdict.state)
        return verdict

    def _passed(self, kind: str, before: int, load: float, state: str) -> None:
        """Notes a creep or a constant load that began after `before` steps."""
        self.answer.passes.append(LoadPass(kind, self.sim.steps - before, load * self.sim.live_scale, state))

    def _keep(self, load: float) -> None:
        """The highest proven equilibrium so far, and its row."""
        sim, answer = self.sim, self.answer
        answer.low, answer.held = load * sim.live_scale, sim.save()
        answer.peak_displacement = measures.largest_displacement(sim)
        elastic = sim.settings.proof.not_elastic * answer.elastic * load
        if answer.onset is None and answer.peak_displacement > answer.settled + elastic:
            answer.onset = answer.low
        self.track.keep("loading")
