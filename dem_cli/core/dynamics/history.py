"""Time history: the motion of a structure while its supports move, from rest under its dead loads to the end."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.braked_motion import BrakedMotion, braked_words
from dem_cli.core.dynamics.coda import Ending, ending, hardly_moves, longest_coda
from dem_cli.core.dynamics.collapse_criterion import CollapsedBlock, check_energy, check_finite, fallen_blocks
from dem_cli.core.dynamics.collapse_criterion import fallen as fallen_block
from dem_cli.core.dynamics.damping import damping_of
from dem_cli.core.dynamics.extremes import Extremes, MotionStretch, shaken_on, without_meaning
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.initial_state import set_initial
from dem_cli.core.dynamics.snapshots import Snapshots
from dem_cli.core.dynamics.supports import carriers_of
from dem_cli.core.dynamics.time_step import TimeStep, time_step
from dem_cli.core.dynamics.vibration_error import refined
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.job import Job, Outcome
from dem_cli.core.engine.joint_summary import END, joint_state
from dem_cli.core.engine.measures import closure
from dem_cli.core.engine.properties import joint_properties, law_of, laws_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.viscous import Damping
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import origin_of, smallest_edge
from dem_cli.core.records.history_rows import Energy, Samples
from dem_cli.core.records.ports import stage
from dem_cli.core.records.statuses import COLLAPSED, FALLS, MOVES, STOOD
from dem_cli.core.statics.equilibrium import stand
from dem_cli.core.statics.mechanism import named
from dem_cli.errors import CaseError, CaseProblem, SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.track import Track
    from dem_cli.core.records.requests import SolverRequest

WAYS = {"damping": "local", "mass_damping": "mass"}  # other words for some of them
CUT = 1e-6  # of a motion, that may be left over where a duration is that of the motion
TAKERS = ("friction", "dashpots", "mass_damping", "maxwell", "damping")  # fields of Energy


@dataclass
class _Shaking:
    """Progress of a time history: steps done, and the block that fell."""

    end: float  # [s]; a collapse brings it nearer
    done: int = 0  # steps
    fallen: CollapsedBlock | None = None


class TimeHistory:
    """Time history of a structure under one motion of the ground."""

    LASTING = frozenset(("job", "ground", "request", "damping", "sim", "step", "track", "snapshots", "braked"))

    def __init__(self, job: Job, ground: GroundMotion):
        self.job, self.ground, self.request = job, ground, job.request
        self.duration = duration_of(job.request, ground)
        self.damping = damping_of_start(job.request, job.model, job.settings)
        self.sim, self.step = self._simulation()
        self.track: Track = job.track(self.sim)
        self.snapshots = Snapshots(self.track, self.sim, ground, job.request.gravity, job.request.frames)
        self.extremes = Extremes(len(job.request.monitors))  # before a collapse is seen
        self.closed: float | None = None  # error of the energy book when a collapse was seen
        self.farthest = 0.0  # that a block went against the ground [m], look by look
        self.braked = BrakedMotion(self.sim)

    def _simulation(self) -> tuple[DynamicSimulation, TimeStep]:
        """Build the simulation, with laws that depend on the time step, and choose the step."""
        analysis, model = self.request.shaking, self.job.model

        def make(step: float) -> DynamicSimulation:
            return shaken(self.request, model, self.damping, step, self.job.settings)

        sim = self.job.clock.compiled(lambda: make(math.inf))
        found = time_step(sim, analysis.margin, analysis.time_step, self.damping.stiffening)
        if not found.held and analysis.time_step is None:
            history = self.job.settings.history
            found = found._replace(step=min(found.step, history.loose_step, history.loose_share * self.duration))
        found, drifts = refined(found, sim, self.ground.motions, self.duration, analysis, self.request.initial)
        self.job.warnings += [drifts] if drifts else []
        if any(law.rates for law in laws_of(self.request)):
            sim = self.job.clock.compiled(lambda: make(found.step))
        return sim, found

    @property
    def peaks(self) -> np.ndarray:
        """Largest absolute value of each monitor in all that was followed, before a collapse is seen, (n_monitors,)."""
        return self.extremes.values

    @property
    def still(self) -> bool:
        """Test whether the ground moved while no block moved by more than joints deform."""
        return self.ground.peak > 0.0 and self.farthest < self.sim.settings.history.noticeable * self.sim.smallest

    def run(self) -> Outcome:
        """Run rest, first motion and shaking; returns the summary."""
        if not self.start():
            return self._outcome({"status": FALLS, "collapsed": True, "collapse_time": 0.0, "ending": COLLAPSED})
        return self._outcome(self._shake())

    def start(self) -> bool:
        """Find rest under dead loads, then apply the first motion; False where there is no rest."""
        sim, request = self.sim, self.request
        if request.shaking.settle:
            self.track.observer.progress("gravity", 0.0, 0.0, None)
            if self._stands() != "equilibrium":
                self.track.write("gravity")
                self.track.frame("gravity")
                return False
        sim.begin(self.step.step)
        sim.take_carriers(carriers_of(sim))
        if request.initial:
            set_initial(request.initial, sim)
        if request.initial or not request.shaking.settle:
            sim.start_moving()
        self.track.write("shaking")
        self.track.frame("shaking")
        return True

    def _stands(self) -> str:
        """Settle the structure under its dead loads and test whether it stands. Raises SolverError where neither
        equilibrium nor a fall is found."""
        steps = min(self.request.shaking.max_steps, self.job.settings.history.settling)
        try:
            return stand(self.sim, Budget(steps)).state
        except SolverError as error:
            raise SolverError(
                f"no rest under dead loads was found in {steps:,} steps before the motion: soften the joints, make "
                f"weights more alike, or start as drawn (analysis.settle = false); {error}"
            ) from error

    def _shake(self) -> dict[str, Any]:
        """Follow the motion to its end, or a collapse for long enough, then the coda."""
        total = max(1, math.ceil(self.duration / self.step.step))
        if total > self.request.shaking.max_steps:
            raise SolverError(
                f"{self.duration:g} s are {total:,} steps of {self.step.step:.3g} s, more than analysis.max_steps "
                f"({self.request.shaking.max_steps:,}): {self.step.cause}"
            )
        return {"status": "ok"} | self._ended(self._through_motion(total))

    @stage
    def _through_motion(self, total: int) -> CollapsedBlock | None:
        """Advance through the stretches of the motion, of so many steps in all; returns the block that fell first."""
        history, sim, dt = self.job.settings.history, self.sim, self.step.step
        every = self._every()
        stretch = max(1, math.ceil(min(total / history.rows, history.longest_look / dt)))
        motion = _Shaking(self.duration)
        if not sim.stages.resumed(motion):
            self.snapshots.begin(motion.end, every)
        while motion.done < total and sim.time < motion.end - 0.5 * dt:
            sim.stages.offer(motion)
            n = min(stretch, total - motion.done, max(1, math.ceil((motion.end - sim.time) / dt - 0.5)))
            try:
                seen = self._stretch(n, every)
                self._look()
            except SolverError as error:
                if motion.fallen is None:
                    raise
                self.job.warnings.append(f"the collapse is known, not what follows: {error}")
                break
            if motion.fallen is None:
                self._look_for_falls(motion, seen)
            else:
                self.extremes.go_on(seen)
            motion.done += n
            self.snapshots.look()
            moved = measures.largest_displacement(sim)
            self.farthest = max(self.farthest, moved)
            self.track.observer.progress("shaking", sim.load, moved, min(sim.time / motion.end, 1.0))
        return motion.fallen

    def _look_for_falls(self, motion: _Shaking, seen: MotionStretch) -> None:
        """Update the peaks of the monitors by the last stretch, and end the motion soon after a block has fallen."""
        self.extremes.see(seen)
        motion.fallen = fallen_block(self.sim, self.request.shaking)
        if motion.fallen is not None:
            self.closed = closure(self.sim)
            motion.end = min(motion.end, motion.fallen.time + self.request.shaking.after_collapse)
            self.snapshots.collapsed(motion.end)

    def _ended(self, fallen: CollapsedBlock | None) -> dict[str, Any]:
        """Return the summary of the outcome: collapse, its time and blocks, or rest."""
        sim = self.sim if fallen is not None else deepcopy(self.sim)
        end = Ending(COLLAPSED, fallen) if fallen is not None else self._followed(sim)
        found: dict[str, Any] = {"collapsed": end.collapsed, "collapse_time": None}
        if end.block is not None:
            found |= {"collapse_time": end.block.time, "collapse_block": end.block.block, "collapse": end.block.how}
            found["fallen_blocks"] = named(sim, fallen_blocks(sim, self.request.shaking))
        return found | {"ending": end.how, "at_rest": end.still, "followed": end.followed}

    def _followed(self, sim: DynamicSimulation) -> Ending:
        """Follow a copy after the motion; energy balance and frames are of the motion alone, peaks and samples of
        all."""
        analysis, dt, motion_ends = self.request.shaking, self.step.step, sim.time
        history, longest = sim.settings.history, longest_coda(self.request, sim.model)
        every, waiting = self._every(), list[MotionStretch]()  # what shows a structure at rest is not worth keeping

        def tell() -> None:
            for seen in waiting:
                self._tell(seen, coda=True)
            waiting.clear()

        def advance(n_steps: int) -> MotionStretch:
            seen = shaken_on(sim, self.ground, self.job.monitors, n_steps, every)
            waiting.append(seen)
            if not hardly_moves(sim):
                tell()
            moved = measures.largest_displacement(sim)
            self.track.observer.progress("coda", 0.0, moved, min((sim.time - motion_ends) / max(longest, dt), 1.0))
            return seen

        stretch = max(1, math.ceil(min(max(longest, history.one_more) / history.rows, history.longest_look) / dt))
        try:
            end = ending(sim, analysis, longest, self.step, stretch, self.extremes, advance)
            if end.how != STOOD:
                tell()
            return end
        except SolverError as error:
            self.job.warnings.append(f"how it ends is not known; after the motion: {error}")
            return Ending(MOVES, None, sim.time - motion_ends)

    def _every(self) -> int:
        """Return the number of time steps from one sample to the next, at least 1."""
        return max(1, round(1.0 / (self.request.rate * self.step.step)))

    def _stretch(self, n_steps: int, every: int) -> MotionStretch:
        """Advance by n_steps of ground motion, sampled every so many steps since the start of the run."""
        sim = self.sim
        seen = shaken_on(
            sim, self.ground, self.job.monitors, n_steps, every, self.snapshots if self.track.frames else None
        )
        check_finite(sim)
        self._tell(seen, coda=False)
        sim.show_base(self.ground.along(sim.time), self.request.gravity)
        return seen

    def _tell(self, seen: MotionStretch, coda: bool) -> None:
        """Pass the samples of a stretch to the observer."""
        self.track.observer.samples(Samples(seen.times, seen.base, seen.values, seen.extremes, coda))

    def _look(self) -> None:
        """Record the energy balance of this instant; stops a run that creates energy."""
        sim = self.sim
        row = self.track.write("shaking")
        self.braked.look(sim)
        check_energy(sim, self.step, row.energy)

    def _outcome(self, found: dict[str, Any]) -> Outcome:
        """Build the audited summary with its warnings."""
        sim = self.sim
        fell = found["status"] == FALLS  # in pseudo-time, damped to come to rest: no part of the motion
        shares = {} if fell else energy_shares(measures.energy(sim))
        if shares.get("local", 0.0) > self.job.settings.doubts.governs:
            self.job.warnings.append(
                f"local damping took {shares['local']:.0%} of the energy that was lost: it has no physical meaning and "
                "slows every motion; use it for nothing but a test"
            )
        self._doubt_what_follows()
        if self.duration < (1.0 - CUT) * self.ground.duration:
            whole, cut = f"{self.ground.duration:.4g}", f"{self.duration:.4g}"
            self.job.contradictions.append(f"its motion of {whole} s was cut at {cut} s")
        braked = 0.0 if fell else self.braked.share(sim, measures.energy(sim))
        if braked > self.job.settings.doubts.governs:
            self.job.warnings.append(braked_words(self.request.damping, braked))
            self.job.contradictions.append(f"mass damping took {100.0 * braked:.0f} % of the energy")
        impacts = self.extremes.impacts
        if without_meaning(self.request.monitors, impacts):
            self.job.warnings.append(
                "no peak accelerations are given: blocks hit each other, and how hard is up to the stiffness of the "
                "joints; history.csv has the samples"
            )
        return self.job.outcome([sim], found | {
            "time_step": self.step.step,
            "largest_time_step": self.step.limit,
            "duration": sim.time,
            "peak_ground_acceleration": self.ground.peak,
            "damping": self.damping.words,
            "energy_shares": shares,
            "impacts": impacts,
            "largest_displacement": measures.largest_displacement(sim),
            "largest_overlap": self.extremes.overlap,
            "unbalanced_force": None,
            "joint_state": joint_state(sim, END),
            "contradictions": self.job.contradictions,
        })  # fmt: skip

    def _doubt_what_follows(self) -> None:
        """Warn where the energy balance closed up to a collapse and does not beyond: fallen blocks hit larger
        faces."""
        allowed = self.job.settings.doubts.closure
        if self.closed is not None and abs(self.closed) <= allowed < abs(closure(self.sim)):
            self.job.warnings.append(
                f"up to the collapse the energy closes within {abs(self.closed):.2g}: doubt what follows, where blocks "
                "fall on faces that are large for their mass, not the collapse"
            )


def damping_of_start(request: SolverRequest, model: Model, settings: Settings = DEFAULT) -> Damping:
    """Compute the requested damping for the joints of the start. Raises CaseError as `damping_of` does."""
    properties = joint_properties(request, model, settings.stiffness.dynamics)
    rest = bodies_at_rest(model, origin_of(model))
    start = joints_of_start(model, rest, properties, smallest_edge(model))
    return damping_of(request, model, start, settings)


def shaken(
    request: SolverRequest, model: Model, damping: Damping, step: float = math.inf, settings: Settings = DEFAULT
) -> DynamicSimulation:
    """Build the simulation of a structure before its first step, with laws that know the time step [s]; compiles
    nothing."""
    properties = joint_properties(request, model, settings.stiffness.dynamics, step)
    return DynamicSimulation(model, law_of(request), properties, damping, settings)


def energy_shares(energy: Energy) -> dict[str, float]:
    """Return the share of the dissipated energy that each mechanism took; empty where none was lost."""
    taken = {WAYS.get(name, name): getattr(energy, name) for name in TAKERS}
    total = sum(taken.values())
    return {name: value / total for name, value in taken.items() if value != 0.0} if total > 0.0 else {}


def duration_of(request: SolverRequest, ground: GroundMotion) -> float:
    """Return the duration of the time history [s]. Raises CaseError where neither the request nor a motion says it."""
    duration = request.shaking.duration or ground.duration
    if duration <= 0.0:
        message = "missing; must be a number > 0 ([s]) where no [motion] says how long the ground moves"
        raise CaseError([CaseProblem(("analysis", "duration"), message)])
    return duration
