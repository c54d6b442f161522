"""Time history of one structure at rest under one ground motion, for many runs: does it collapse?"""

from __future__ import annotations

import math
import time
from copy import deepcopy
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.core.dynamics.braked_motion import BrakedMotion
from dem_cli.core.dynamics.coda import Ending, ending, longest_coda
from dem_cli.core.dynamics.collapse_criterion import check_energy, check_finite, fallen
from dem_cli.core.dynamics.extremes import Extremes, MotionStretch, shaken_on, without_meaning
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.history import TimeHistory
from dem_cli.core.engine.job import Job
from dem_cli.core.engine.measures import closure, energy
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.records.ports import NOTHING_KEPT, Observer, Stages, stage
from dem_cli.core.records.statuses import COLLAPSED
from dem_cli.errors import SolverError
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dem_cli.analyses.ensembles.variants import Variant
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.records.requests import MonitorRequest


class ShakenRunResult(NamedTuple):
    """Result of one structure under one ground motion."""

    collapsed: bool | None  # before the time after the motion was over; None: it failed, or still moved then
    time: float | None  # of the collapse [s]
    how: str  # the block that collapsed and how, that the end is not known, or why the run failed
    peaks: tuple[float, ...]  # largest absolute value of each monitor, up to the collapse
    steps: int
    closure: float | None  # energy error over the largest energy
    seconds: float  # CPU of the thread [s]
    ending: str = ""  # one of those of core/records/statuses.py; empty where the run failed
    braked: float = 0.0  # share of the energy that mass damping took from blocks that rock, slide or fall
    impacts: int = 0  # steps in which contact points met


def told_peaks(monitors: Sequence[MonitorRequest], run: ShakenRunResult) -> tuple[float, ...]:
    """Return the peaks of a run; nan where they have no meaning."""
    left_out = without_meaning(monitors, run.impacts)
    return tuple(math.nan if i in left_out else peak for i, peak in enumerate(run.peaks))


class RunCancelled(Exception):
    """Exception of a run that is cancelled because its result is no longer needed."""


class ProgressOnly(Observer):
    """Observer of structures that come to rest: only progress is reported, no results.

    stages: what keeps their stages; none where many run side by side.
    """

    def __init__(self, observer: Observer, stages: Stages = NOTHING_KEPT):
        self.observer, self.stages = observer, stages

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Forward the progress of the run."""
        self.observer.progress(stage, load, displacement, fraction)


class _Stretches:
    """Progress of a motion in steps and stretches."""

    def __init__(self) -> None:
        self.done = self.looks = 0  # steps, stretches


class RestedStructure:
    """Structure at rest under dead loads, from which any number of motions start."""

    def __init__(self, variant: Variant, records: Sequence[Motion], observer: Observer, settings: Settings = DEFAULT):
        self.variant, self.request = variant, solver_request(variant.case)
        job = Job.start(self.request, variant.model, observer, settings)
        history = TimeHistory(job, GroundMotion(records, variant.model))
        self.stands = history.start()
        self.sim, self.step, self.monitors, self.damping = history.sim, history.step, job.monitors, history.damping
        self.compile_seconds = job.clock.compiling
        self.absolute = any(monitor.absolute for monitor in self.request.monitors)
        dt = self.step.step
        self.every = max(1, round(1.0 / (self.request.rate * dt)))
        self.stretch = self.every * max(1, round(settings.history.look / (self.every * dt)))

    def shaken(
        self,
        motions: Sequence[Motion],
        cancelled: Callable[[], bool] = lambda: False,
        told: Callable[[DynamicSimulation, float], None] = lambda sim, share: None,
    ) -> ShakenRunResult:
        """Shake a copy of the structure with the sum of motions, times the factor of the variant; ends with a collapse.

        told: hears of the share of the motion that is over. Raises RunCancelled.
        """
        begun = time.thread_time()
        sim = deepcopy(self.sim)
        ground = GroundMotion([motion.scaled(self.variant.motion) for motion in motions], self.variant.model)
        peaks, braked = Extremes(len(self.request.monitors)), BrakedMotion(sim)
        collapsed, at, balance, word = None, None, None, ""
        try:
            end = self._shake(sim, ground, peaks, braked, cancelled, told)
        except SolverError as error:
            how = str(error)
        else:
            collapsed, at, how, balance, word = end.collapsed, end.time, end.why, closure(sim), end.how
        steps, seconds = sim.steps - self.sim.steps, time.thread_time() - begun
        share = braked.share(sim, energy(sim)) if word else 0.0
        return ShakenRunResult(
            collapsed, at, how, tuple(peaks.values.tolist()), steps, balance, seconds, word, share, peaks.impacts
        )

    @stage
    def _shake(
        self,
        sim: DynamicSimulation,
        ground: GroundMotion,
        peaks: Extremes,
        braked: BrakedMotion,
        cancelled: Callable[[], bool],
        told: Callable[[DynamicSimulation, float], None],
    ) -> Ending:
        """Run the motion and the time after it; returns how it ends."""
        analysis, dt = self.request.shaking, self.step.step
        total, motion = math.ceil((analysis.duration or ground.duration) / dt), _Stretches()

        def advance(n_steps: int) -> MotionStretch:
            if cancelled():
                raise RunCancelled
            stretch = shaken_on(sim, ground, self.monitors, n_steps, self.every, with_base=self.absolute)
            braked.look(sim)
            return stretch

        sim.stages.resumed(motion)
        while motion.done < total:
            sim.stages.offer(motion)
            n = min(self.stretch, total - motion.done)
            peaks.see(advance(n))
            motion.done, motion.looks = motion.done + n, motion.looks + 1
            told(sim, motion.done / total)
            check_finite(sim)
            if motion.looks % sim.settings.history.energy_every == 0:
                check_energy(sim, self.step)
            found = fallen(sim, analysis)
            if found is not None:
                return Ending(COLLAPSED, found)
        return ending(sim, analysis, longest_coda(self.request, sim.model), self.step, self.stretch, peaks, advance)
