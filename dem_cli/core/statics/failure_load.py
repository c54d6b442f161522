"""Failure load by steps from gravity: the load is raised, each step a proven equilibrium, until failure is proven.

An estimate says where the steps have to be small. Limit analysis bounds it (statics/rigid_limits.py): what it proved
impossible needs no proof by motion. Where a creep comes close to that bound, it is the estimate. Else the zero-dilation
path is, a second history from gravity: where its load grows no more, failure shows after a short motion. Where the two
differ, the load is raised once more in small steps.

In the plane structures of some size go from gravity to failure in implicit steps instead (statics/implicit_history.py):
the explicit solver holds their last load and shows the failure above it, or all is done as above.

The creep: equilibrium exists at every prescribed displacement, so nothing has to be guessed for it. The live load is
replaced by a prescribed rate of its own displacement q·u, and its multiplier is found as a reaction. The rate is halved
several times and then set to zero. A joint that slides back and forth on that way may have lost strength; where the
creep ends in an equilibrium inside the bracket, that one is the highest.

A requested start next to failure (statics/warm_start.py) is held a little below its load, and the load is
raised from there; one from limit analysis is an equilibrium that exists, and no more.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.kernels import records as slot
from dem_cli.core.statics.compliance import check_moves, compliance
from dem_cli.core.statics.creep import creep_evenly, creep_to_rest
from dem_cli.core.statics.equilibrium import (
    Ahead,
    Verdict,
    check_finite,
    relax,
    released_in_motion,
    settle_or_fail,
    unexpected,
)
from dem_cli.core.statics.failure_bracket import EXISTS, NO_FAILURE, OK, FailureLoad, LoadPass, SearchRange
from dem_cli.core.statics.mechanism import follows
from dem_cli.core.statics.trial_loads import TrialLoads
from dem_cli.core.statics.warm_start import CURVE, GRAVITY, LIMIT, PATH, start_by_path, starts_by_history
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from collections.abc import Callable

    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.track import Track
    from dem_cli.core.statics.warm_start import CurveStart, WarmStart


LARGE = "a large structure: its path is followed for as long as is affordable, and the load raised from where it ends"
LARGE_SMOOTHED = (
    "a large structure: its path is smoothed, and the load is raised from where it ends for as long as is affordable"
)


class LoadSearch:
    """Search for the failure load of a structure that stands under its dead loads (see the module docstring).

    What is found goes to `answer` as it is found, so that it is not lost where the budget ends; the equilibria are
    kept as rows in the track. Loads inside are internal multipliers. buckles: whether a state at rest does.
    """

    def __init__(
        self,
        sim: Simulation,
        wanted: SearchRange,
        budget: Budget,
        track: Track,
        answer: FailureLoad,
        buckles: Callable[[Simulation], bool] = lambda sim: False,
    ) -> None:
        self.buckles = buckles
        self.sim, self.budget, self.track, self.answer = sim, budget, track, answer
        self.resolution, self.settings, scale = wanted.resolution, sim.settings.load_search, sim.live_scale
        self.limit = self.settings.locked if wanted.max_load is None else wanted.max_load / scale
        self.longest = None if wanted.longest is None else wanted.longest / scale
        self.plateau = np.inf  # load from which on a path is known to grow no more with displacement
        self.impossible = np.inf  # load from which on limit analysis proved that nothing is in equilibrium
        self.on_stiff_joints = np.inf  # load of joints that are stiff, where geometry moves: a creep may throw blocks
        self.first_step = sim.steps
        self.large = False  # whether the load is raised from the end of a path as far as that was affordable
        answer.scale, answer.limit = scale, self.limit * scale

    def run(self, start: WarmStart | CurveStart | None = None) -> None:
        """Search for the bracket; start: a requested state next to failure, instead of loads raised from gravity.

        Where it does not hold, these are the way after all; where joints have a profile, nothing is estimated first.
        Raises SolverError where the live load moves nothing, or where the budget ends.
        """
        sim, answer, settings = self.sim, self.answer, self.settings
        self.at_rest, self.first_start = sim.save(), dict(answer.start)
        answer.low, answer.held, answer.settled = 0.0, self.at_rest, measures.largest_displacement(sim)
        if answer.bound is not None:
            least = self.resolution * settings.least
            self.impossible = max((1.0 + settings.beyond_impossible) * answer.bound / sim.live_scale, least)
            if self.impossible <= least:  # the least live load moves it
                self._raise_load(self._trials([least], least))
                return
        answer.compliance, answer.elastic = compliance(sim, self.budget)
        check_moves(sim, answer.compliance)
        if start is not None and self._holds(start, settings.below * self.resolution):
            low = answer.carried / sim.live_scale
            if start.kind == LIMIT:
                answer.status, answer.high = EXISTS, answer.bound
                return
            self.plateau = start.load / sim.live_scale if start.plateau else np.inf
            self._raise_load(self._trials([], settings.one_step * self.resolution * low))
        elif self.longest is not None or sim.play.moved.any():  # a creep would stop at the first microrotation
            first = settings.first_in_play if self.longest is None else self.longest
            self._raise_load(self._trials([], first, np.inf if self.longest is None else self.longest))
        elif not (self._ends_where_the_history_does() or self._ends_where_the_path_does()):
            self._raise_to_estimate()

    def run_again_in_small_steps(self, most: float) -> None:
        """Search again from gravity in small steps of the load: equal shares of `most` (as users know it).

        Where histories differ the steps may decide: this is then the history that a failure load is stated for. No
        estimate has a say in it, so that it is always the same for the same structure. Where the budget ends first, or
        all that a search may cost is spent, the bracket stays that of the larger steps; it is not begun, nor gone on
        with, where that can be seen beforehand.
        """
        step = most / self.sim.live_scale / self.settings.small_steps
        trials = TrialLoads(
            self.settings, self.resolution, 0.0, [], step, step, min(self.limit, self.impossible),
            goal=self.answer.carried / self.sim.live_scale,
        )  # fmt: skip
        if self._enough(trials):
            return

        def raised() -> bool:
            self._raise_load(trials)
            return not self.answer.wide or (self.answer.found and not self._enough(trials))

        if self._again(raised):
            self.answer.start = self.first_start

    def run_again_in_small_implicit_steps(self) -> bool:
        """Search again by an implicit history in small steps; False: it was not found, and all is as before."""
        return self._again(lambda: self._ends_where_the_history_does(small=True))

    def _again(self, search: Callable[[], bool]) -> bool:
        """Search the bracket again from the dead loads; where that does not end, the answer before stays."""
        known, rows = replace(self.answer), [*self.track.kept]
        self.track.kept[:] = rows[:1]
        self.answer.begin_again(self.at_rest)
        finished = False
        try:
            with suppress(SolverError):
                finished = search()
        finally:
            if not finished:
                vars(self.answer).update(vars(known))
                self.track.kept[:] = rows
                if known.failed_state is not None:
                    self.sim.restore(known.failed_state)
        return finished

    def _trials(self, levels: list[float], step: float, longest: float = np.inf) -> TrialLoads:
        """Return the loads to try from the load that is carried now."""
        low, limit = self.answer.carried / self.sim.live_scale, min(self.limit, self.impossible)
        return TrialLoads(self.settings, self.resolution, low, levels, step, longest, limit)

    def _raise_to_estimate(self) -> None:
        """Raise the load from gravity, in steps that shrink towards an estimate of the failure load."""
        answer, settings = self.answer, self.settings
        estimate, expected = (self.impossible, True) if self._path_meets_the_bound() else self._estimated()
        hinges = expected and answer.limits is not None and not answer.limits.slides
        levels = [share * estimate for share in (settings.shares_of_hinges if hinges else settings.shares)]
        if expected:
            levels.append((1.0 - settings.short * self.resolution) * estimate)
            levels.append((1.0 + settings.beyond * self.resolution) * estimate)
        self._raise_load(self._trials(levels, settings.first_step * self.resolution * estimate))

    def _estimated(self) -> tuple[float, bool]:
        """Estimate the failure load by a creep, and tell whether failure is expected there."""
        answer, settings, sim = self.answer, self.settings, self.sim
        self.track.observer.progress("estimating the failure load", 0.0, 0.0, None)
        estimate = self._creep(settings.reach * answer.compliance)
        sim.restore(answer.standing)
        most = min(self.limit, settings.beyond_stiff * self.on_stiff_joints)
        estimate = min(estimate if estimate > 0.0 else settings.probe, most)
        return self._expected(min(estimate, self.impossible)) if self.impossible < np.inf else (estimate, False)

    def _path_meets_the_bound(self) -> bool:
        """Test whether a path already traced rose steadily to the upper bound of limit analysis."""
        limits, resolution = self.answer.limits, self.resolution
        path = limits.path if limits is not None and limits.followed else None
        if path is None or path.load is None or not path.finished or self.limit < self.impossible < np.inf:
            return False
        steady = path.rest is None and path.fall <= resolution
        return steady and path.load >= (1.0 - self.settings.short * resolution) * (self.answer.bound or np.inf)

    def _expected(self, estimate: float) -> tuple[float, bool]:
        """Improve an estimate, and tell whether the load is expected to fail there: at the bound, or at the end of
        the path."""
        limits = self.answer.limits
        assert limits is not None
        if estimate >= self.settings.likely * self.impossible or not limits.slides:
            return self.impossible, True
        if limits.too_large:
            return estimate, False
        path = limits.path
        load = (path.load or 0.0) / self.sim.live_scale if path is not None else 0.0
        if path is None or load <= self.settings.least:
            return estimate, False
        if not path.flat(self.sim.settings.warm_start.at_the_end):
            return max(load, estimate), False
        self.plateau = load
        return load, True

    def _ends_where_the_history_does(self, small: bool = False) -> bool:
        """Test whether the explicit solver carries the last load of an implicit history, and fails above it.

        Else all is as it was, also where loads raised from gravity fail sooner: these are other histories then.
        small: in small steps of the load.
        """
        answer, limits, resolution = self.answer, self.answer.limits, self.resolution
        if limits is None or answer.bound is None or not limits.slides:
            return False
        plane = self.sim.model.dimension == 2  # in space it takes as long as the path, and fails more often
        if not plane or limits.largest < self.sim.settings.implicit_history.blocks or limits.too_large:
            return False
        beside = limits.largest <= self.sim.settings.warm_start.beside_implicit and limits.path is not None
        if beside and self._path_meets_the_bound():
            return False
        known, rows, report = replace(answer), len(self.track.kept), dict(answer.start)
        starts = starts_by_history(limits, report, small)
        if starts and self._raised_beside(starts) and self._holds(starts[-1], self.settings.below * resolution):
            answer.start = report
            if self._fails_after(starts[-1].load, report["fails"]):
                return True
        passes, self.plateau = answer.passes, np.inf
        vars(answer).update(vars(known) | {"passes": passes, "start": dict(self.first_start)})
        del self.track.kept[rows:]
        self.sim.restore(self.at_rest)
        return False

    def _fails_after(self, held: float, fails: float) -> bool:
        """Test whether the explicit solver fails above the last load that an implicit history carried.

        held, fails: its bracket. Where that is wider than asked for the load is raised in it, trial after trial.
        """
        answer, scale, step = self.answer, self.sim.live_scale, self.settings.one_step * self.resolution
        low = answer.carried / scale
        if fails > (1.0 + self.resolution) * held:
            self.plateau = fails / scale
            self._raise_load(self._trials([0.5 * (low + fails / scale), fails / scale], step * low))
            return answer.found
        self.plateau, load = held / scale, min((1.0 + step) * low, self.impossible)
        verdict = self._settle(load)
        if verdict.state != "failure":
            return False
        answer.status, answer.found = OK, True
        self._note_failure(load, verdict)
        self.track.keep("collapse")
        return True

    def _ends_where_the_path_does(self) -> bool:
        """Test whether the path of a large structure leads to a load that the explicit solver carries.

        From there the load is raised for as long as is affordable. To prove a failure by motion takes 300,000 steps and
        more: the answer is "at least", and "not above" the bound.
        """
        answer, limits = self.answer, self.answer.limits
        if limits is None or not limits.too_large or answer.bound is None:
            return False
        if not limits.slides or self.longest is not None:
            return False
        report = {**answer.start, "kind": PATH}
        start, below = start_by_path(limits, report), self.settings.below * self.resolution
        near = min(self.settings.below_of_large, below)
        if start is None or not (self._holds(start, near) or (near < below and self._holds(start, below))):
            return False
        answer.start = {**report, "note": LARGE_SMOOTHED if "smoothing" in report else LARGE}
        settings, scale = self.settings, self.sim.live_scale
        most = min(settings.trial_of_large, int(settings.effort_of_large / len(self.sim.joints.kn)))
        self.settings = replace(
            settings, effort=settings.effort_of_large, trial=most, trial_per_point=0, most_undecided=0
        )
        self.large = True
        self._raise_load(self._trials([], settings.step_of_large * (answer.bound - start.load) / scale))
        return True

    def _holds(self, start: WarmStart | CurveStart, below: float) -> bool:
        """Test whether the explicit solver carries the state of `start` a share below its load; else all is as it
        was."""
        sim, answer = self.sim, self.answer
        load = (1.0 - below) * start.load / sim.live_scale
        if not 0.0 < load < self.limit:
            return False
        self.track.observer.progress("holding the start", load * sim.live_scale, 0.0, None)
        start.put_into(sim)
        before, verdict = sim.steps, self._held(start, load)
        self._passed("start", before, load, verdict.state)
        if verdict.state != "equilibrium":
            sim.restore(answer.standing)
            answer.start |= {"kind": GRAVITY, "note": "the start did not hold; the load is raised from gravity"}
            return False
        self._keep(load)
        return True

    def _held(self, start: WarmStart | CurveStart, load: float) -> Verdict:
        """Return the verdict on a load from a start next to it; curves, whose peaks are flat, come to rest the
        fast way."""
        sim, scale = self.sim, self.answer.elastic * load
        if start.kind == CURVE:
            tolerance, most = sim.settings.relaxation.tolerance, self.settings.hold_start
            verdict = relax(sim, load, tolerance, most, scale, budget=self.budget, elastic=False)
            if verdict.state == "equilibrium":
                return verdict
            start.put_into(sim)
        return settle_or_fail(sim, load, self.budget, scale, ahead=Ahead(change=self._elastic_change(load)))

    def _fail_above(self, load: float) -> Verdict:
        """Prove failure at a load that limit analysis proved impossible. Its mechanism gains more work than any
        forces in the friction cones can take, and the explicit solver shows that the structure moves on and
        releases energy.

        So little above the bound a structure takes long to move. Where a mechanism at that load is known it is pushed a
        little, and its motion compared with that: another one that lies as close may have set in as well.
        """
        mechanism = self._mechanism_at(load)
        if mechanism is not None:
            verdict = self._moves_on(load, self.settings.pushed)
            if follows(self.sim, self.answer.standing, mechanism):
                return verdict
            self.sim.restore(self.answer.standing)
        return self._moves_on(load)

    def _mechanism_at(self, load: float) -> np.ndarray | None:
        """Return the mechanism of the bound, if nothing slides in it, or of a path that ends there, (n_blocks,
        n_dof)."""
        limits = self.answer.limits
        if limits is None or limits.associated is None:
            return None
        if not limits.slides:
            return limits.associated.velocities
        path = limits.path if limits.followed else None
        if path is None or path.load is None or not path.finished:
            return None
        return path.mechanism if path.load >= (1.0 - self.settings.pushed) * load * self.sim.live_scale else None

    def _moves_on(self, load: float, pushed: float = 0.0) -> Verdict:
        """Motion under a load from the highest equilibrium so far; pushed: what is put on besides, of the load."""
        sim, shown = self.sim, self.settings.shown * self.answer.elastic * load
        sim.use_combined_damping()
        sim.set_load((1.0 + pushed) * load)
        released = released_in_motion(sim, self.budget, load, shown)
        sim.set_load(load)
        if pushed:
            sim.advance(1, slot.HOLD_LOAD)  # what is out of balance at the load itself
        return Verdict("failure", sim.unbalanced, released)

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
            looks = settings.looks if phase == 0 else settings.looks // 2
            loads += creep_evenly(sim, settings.first_phase // settings.looks, looks)
            check_finite(sim)
            if sim.kinematics == "large" and loads[-1] < settings.softened * max(loads):
                break
        else:
            sim.prescribe_rate(0.0)
            if creep_to_rest(sim, settings.hold_steps // sim.settings.relaxation.chunk):
                self.answer.crept = sim.load
                sim.rest()
                self.answer.crept_state = sim.save()
        softened = sim.kinematics == "large" and sim.load < settings.softened * max(loads)
        estimate = max(loads) if softened else sim.load
        self.budget.spend(sim.steps - before, "creeping to failure")
        self._passed("creep", before, estimate, "estimate")
        return estimate

    def _raise_load(self, trials: TrialLoads) -> None:
        """Raise the load, trial after trial, until the bracket is narrow enough, or as narrow as it can be made."""
        answer = self.answer
        while (load := trials.next()) is not None and not self._enough(trials):
            verdict = self._settle(load)
            if verdict.state == "equilibrium":
                trials.carries(load)
                if trials.high is None:
                    answer.withdraw_failure()
                self._keep(load)
                if load > (1.0 + self.resolution) * self.plateau:
                    self.plateau = np.inf  # it was none, but a rest on the way
            elif verdict.state == "failure":
                trials.fails(load, for_certain=load >= self.impossible)
                self._note_failure(load, verdict)
            else:
                trials.leaves(load)
            answer.undecided = [other * answer.scale for other in trials.undecided]
        if trials.high is None and trials.low >= self.limit:
            answer.status = NO_FAILURE
        elif trials.closed:
            self._try_crept(trials)
            answer.status, answer.found = OK, True
        else:
            answer.end_undecided(self.settings.widest)
        if answer.ends_beyond_its_path(self.resolution):
            answer.status, answer.found, answer.high = EXISTS, False, answer.bound
        if answer.failed_state is not None:
            self.sim.restore(answer.failed_state)
            self.track.keep("collapse")

    def _note_failure(self, load: float, verdict: Verdict) -> None:
        answer = self.answer
        answer.high, answer.failing = load * answer.scale, verdict
        answer.failed_from, answer.failed_state = answer.standing, self.sim.save()
        answer.impossible = load >= self.impossible

    def _enough(self, trials: TrialLoads) -> bool:
        """Test whether a bracket cost so much, or would until it is any narrower, that it stays as it is."""
        answer, to_come = self.answer, self._steps_to_come(trials)
        if not (answer.low or trials.goal) or (answer.high is None and answer.bound is None):
            return False
        spent = self.sim.steps - self.first_step
        return to_come > self.budget.left or (spent + to_come) * len(self.sim.joints.kn) > self.settings.effort

    def _steps_to_come(self, trials: TrialLoads) -> float:
        """Steps before anything new is known, at least.

        Small steps come to where larger ones did, each by a share of what any equilibrium took so far. Of a large
        structure, whose failure took so long to show, a lower load takes longer still.
        """
        if trials.to_come:
            return trials.to_come * self.settings.least_of_fewest * min(self._taken("equilibrium"), default=0)
        failures = self._taken("failure")  # none, where limit analysis alone proved one
        return failures[-1] if failures and self.large and trials.high is not None else 0

    def _taken(self, state: str) -> list[int]:
        """List the steps of each raised load that ended with this verdict."""
        return [each.steps for each in self.answer.passes if each.kind == "load" and each.state == state]

    def _try_crept(self, trials: TrialLoads) -> None:
        """Try the equilibrium of the creep inside the bracket: it is closer to failure, if it is one."""
        answer = self.answer
        if answer.crept is None or trials.high is None or not trials.low < answer.crept < trials.high:
            return
        answer.held, held = answer.crept_state, answer.held
        if self._settle(answer.crept).state == "equilibrium":
            self._keep(answer.crept)
        else:
            answer.held = held

    def _settle(self, load: float) -> Verdict:
        """Return the verdict on a load, from the highest equilibrium so far."""
        sim, answer, settings = self.sim, self.answer, self.settings
        impossible = load >= self.impossible
        doing = "failing" if impossible else "raising the load"
        self.track.observer.progress(doing, load * sim.live_scale, answer.peak_displacement, None)
        sim.restore(answer.standing)
        before = sim.steps
        if impossible:
            verdict = self._fail_above(load)
        else:
            most = max(settings.trial, settings.trial_per_point * len(sim.joints.kn))
            if sim.kinematics == "large":
                most = max(most, settings.trial_per_depth * sim.depth**2)
            tolerance = self._tolerance(load)
            verdict = self._rests_soon(load, tolerance) or settle_or_fail(
                sim, load, self.budget, answer.elastic * abs(load), tolerance,
                ahead=self._ahead(load), most_steps=most,
            )  # fmt: skip
        if verdict.state == "equilibrium" and self.buckles(sim):
            verdict = Verdict("failure", sim.unbalanced, buckles=True)
        self._passed("impossible" if impossible else "load", before, load, verdict.state)
        return verdict

    def _tolerance(self, load: float) -> float:
        """Unbalanced force, in own weights, of an equilibrium at a load: small loads are sought as closely as others.

        Not more closely than coordinates are known: large structures on stiff joints would never come to rest.
        """
        settings, full = self.settings, self.sim.settings.relaxation.tolerance
        known = min(settings.noise * measures.round_off(self.sim), settings.unbalanced * self.resolution * abs(load))
        return min(max(full * min(abs(load) / settings.light, 1.0), known), full)

    def _rests_soon(self, load: float, tolerance: float) -> Verdict | None:
        """Equilibrium the fast way, where nothing slides at the bound: joints that only open remember no way there.

        None where that is not so, or where it does not come to rest: then all is as before.
        """
        sim, answer = self.sim, self.answer
        if answer.limits is None or self.impossible == np.inf or answer.limits.slides or sim.kinematics != "fixed":
            return None
        scale = answer.elastic * abs(load)
        verdict = relax(sim, load, tolerance, self.settings.hold_start, scale, budget=self.budget, elastic=False)
        if verdict.state == "equilibrium":
            return verdict
        sim.restore(answer.standing)
        return None

    def _elastic_change(self, load: float) -> float | None:
        """Elastic displacement from the present load to another one [m], where a curve led next to failure."""
        return self.answer.elastic * abs(load - self.sim.load) if self.answer.start.get("kind") == CURVE else None

    def _ahead(self, load: float) -> Ahead:
        """Return the expectation about a load from a path or a curve that was followed."""
        limits, change = self.answer.limits, self._elastic_change(load)
        if limits is not None and self.impossible < np.inf and not limits.slides:
            return Ahead(reach=self.settings.unslid, change=change)  # there is an equilibrium, however softly it rests
        if load > self.plateau or abs(load) <= self.settings.least:
            return Ahead(load > self.plateau, change=change)
        path = limits.path if limits is not None and limits.followed else None
        reach = path.reach(load * self.sim.live_scale) / abs(load) if path is not None else 0.0
        return Ahead(False, max(reach, unexpected(self.sim).reach), change)

    def _passed(self, kind: str, before: int, load: float, state: str) -> None:
        """Notes a creep or a constant load that began after `before` steps."""
        self.answer.passes.append(LoadPass(kind, self.sim.steps - before, load * self.sim.live_scale, state))

    def _keep(self, load: float) -> None:
        """Store the highest proven equilibrium so far, and its row."""
        sim, answer = self.sim, self.answer
        answer.low, answer.held = load * sim.live_scale, sim.save()
        answer.peak_displacement = measures.largest_displacement(sim)
        self._see_onset(load)
        self.track.keep("loading")

    def _raised_beside(self, starts: list[WarmStart]) -> bool:
        """Test whether loads raised by the explicit solver alone come nearly as far as an implicit history.

        Stones that swing lose what stones that creep keep: where it fails sooner the two are different histories.
        """
        answer, settings, most = self.answer, self.settings, starts[-1].load / self.sim.live_scale
        for share in settings.shares:
            if self._settle(share * most).state != "equilibrium":
                return False
            self._keep(share * most)
        answer.raised = answer.low
        for start in starts[:-1]:
            if start.load > answer.carried:
                self._pass_by(start)
        return True

    def _pass_by(self, start: WarmStart) -> None:
        """Record the row of an equilibrium of a history, which the explicit solver need not carry."""
        start.put_into(self.sim)
        self.sim.advance(1, slot.HOLD_LOAD)
        self._see_onset(start.load / self.sim.live_scale)
        self.track.keep("loading")

    def _see_onset(self, load: float) -> None:
        """Notes the first equilibrium in which blocks had moved by more than joints deform."""
        sim, answer = self.sim, self.answer
        elastic = sim.settings.proof.not_elastic * answer.elastic * load
        if answer.onset is None and measures.largest_displacement(sim) > answer.settled + elastic:
            answer.onset = load * sim.live_scale
