"""From a case and its model to an outcome: what every analysis shares."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.contact.detect import find_joints
from dem_cli.contact.start import TOUCH
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.kernels.jit import cache_is_cold
from dem_cli.model.model import Model
from dem_cli.model.places import undeformed
from dem_cli.model.scales import smallest_edge
from dem_cli.output.record import Frame, HistoryRow, Observer, Samples
from dem_cli.solve.audit import closure
from dem_cli.solve.audit import warnings as doubts
from dem_cli.solve.equilibrium import Budget
from dem_cli.solve.joints import FIXED_RATIO, joint_properties, law_of
from dem_cli.solve.monitors import Monitors
from dem_cli.solve.registry import ANALYSES
from dem_cli.solve.simulation import Simulation
from dem_cli.solve.track import Track

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.output.record import RunRow
    from dem_cli.solve.batch import Batch

NEAR = 1e-3  # gaps below this share of the smallest edge are meant: they may close


@dataclass
class Outcome:
    """What a solver returns; `summary` holds the keys of summary.json that are the solver's."""

    summary: dict[str, Any]


def run(case: Case, model: Model, observer: Observer, batch: Batch | None = None) -> Outcome:
    """Solve a case with the analysis that it names. Raises SolverError where the solver gives up.

    batch: how to do the runs of an analysis that consists of many.
    """
    solve = ANALYSES[case.analysis.kind].load()
    return solve(case, model, observer) if batch is None else solve(case, model, observer, batch)


class Clock:
    """Seconds of solving, without the compilation of kernels and what the observer does with results.

    It is an observer itself and hands everything on.
    """

    def __init__(self, observer: Observer) -> None:
        self.started, self.compiling, self.observing = time.perf_counter(), 0.0, 0.0
        self.observer = observer

    def frame(self, frame: Frame) -> None:
        begun = time.perf_counter()
        self.observer.frame(frame)
        self.observing += time.perf_counter() - begun

    def row(self, row: HistoryRow) -> None:
        begun = time.perf_counter()
        self.observer.row(row)
        self.observing += time.perf_counter() - begun

    def samples(self, samples: Samples) -> None:
        begun = time.perf_counter()
        self.observer.samples(samples)
        self.observing += time.perf_counter() - begun

    def runs(self, rows: Sequence[RunRow]) -> None:
        self.observer.runs(rows)

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        begun = time.perf_counter()
        self.observer.progress(stage, load, displacement, fraction)
        self.observing += time.perf_counter() - begun

    def compiled(self, make: Callable[[], Simulation]) -> Simulation:
        """A simulation with its kernels compiled or loaded off the clock, and all else on it."""
        cold, begun = cache_is_cold(), time.perf_counter()
        if cold:
            self.progress("compiling (once)", 0.0, 0.0, None)
        sim = make()
        built = time.perf_counter()
        sim.compile()
        self.compiling += time.perf_counter() - (begun if cold else built)
        return sim

    def imported(self, module: str) -> None:
        """Imports a module that only some runs need, off the clock."""
        begun = time.perf_counter()
        import_module(module)
        self.compiling += time.perf_counter() - begun

    def seconds(self) -> float:
        return time.perf_counter() - self.started - self.compiling - self.observing


@dataclass
class Job:
    """One run: the case, its model, and what its stages share."""

    case: Case
    model: Model
    clock: Clock
    monitors: Monitors
    budget: Budget
    skipped: list[str] = field(default_factory=list)  # what the case did not need
    warnings: list[str] = field(default_factory=list)

    @classmethod
    def start(cls, case: Case, model: Model, observer: Observer) -> Job:
        """A job that reports to `observer`. Raises CaseError where a monitor has no block."""
        return cls(case, model, Clock(observer), Monitors(case, model), Budget(case.analysis.max_steps))

    def simulation(self, kinematics: str, ratio: float = FIXED_RATIO) -> Simulation:
        """A compiled simulation of the case; `ratio` is the kn·h/W of "auto" joints."""
        tilting = getattr(self.case.analysis, "pattern", None) == "tilt"
        return self.clock.compiled(
            lambda: Simulation(
                self.model,
                law_of(self.case),
                joint_properties(self.case, self.model, ratio),
                kinematics,
                live_scale=1.0 if tilting else live_scale(self.model),
                tilting=tilting,
            )
        )

    def first_simulation(self) -> Simulation:
        """The simulation that finds equilibria and failure, with the kinematics that the case asks for or needs."""
        moving = why_moving(self.case, self.model)
        if moving is None:
            self.skipped.append("large displacements: the geometry of the start is exact for a failure load")
            self.skipped.append("detection: done once, nothing moves visibly before failure")
        elif moving:
            self.skipped.append(f"fixed geometry: {moving}")
        return self.simulation("fixed" if moving is None else "large")

    def track(self, sim: Simulation) -> Track:
        """Rows and frames of a simulation."""
        return Track(sim, self.clock, self.monitors, self.case.output.frames)

    def outcome(self, sims: list[Simulation], found: dict[str, Any]) -> Outcome:
        """The summary of all simulations of this job, audited."""
        worst = max((closure(sim) for sim in sims), key=abs)
        overlap = max(sim.largest_overlap() / sim.smallest for sim in sims)
        self.warnings += doubts(self.case, sims, found)
        summary = {
            "joints": sims[0].first_joints,
            "contacts": sims[0].first_points,
            "steps": sims[-1].steps,
            "time_step": 1.0,
            "solve_seconds": self.clock.seconds(),
            "compile_seconds": self.clock.compiling,
            "energy_closure": worst,
            "largest_overlap": overlap * sims[0].smallest,
            "unbalanced_force": sims[0].unbalanced,
            "skipped": self.skipped,
            "warnings": self.warnings,
        }
        return Outcome(summary | found)


def why_moving(case: Case, model: Model) -> str | None:
    """Why geometry moves on the way to failure ("": the case says so); None: that of the start is good enough.

    Raises CaseError where the case asks for fixed geometry that its joints do not allow.
    """
    wanted = case.analysis.kinematics
    profiles = [name for name, joint in case.joints.items() if joint.profile is not None]
    if profiles:
        reason = f"microrotations at the profile of joint '{profiles[0]}' move the blocks"
        if wanted == "fixed":
            raise CaseError([CaseProblem(("analysis", "kinematics"), f"'fixed' is not allowed: {reason}")])
        return reason
    if wanted != "auto":
        return "" if wanted == "large" else None
    if case.imperfection:
        return "imperfections of blocks leave gaps that may close"
    gaps = open_joints(model)
    return f"{gaps} joints have gaps that may close" if gaps else None


def live_scale(model: Model) -> float:
    """Factor that makes the live loads as large as the dead ones, so that a multiplier is of the order of one."""
    d, free = model.dimension, ~model.fixed
    dead = np.sqrt((model.dead_loads[free, :d] ** 2).sum(axis=1)).sum()
    live = np.sqrt((model.live_loads[free, :d] ** 2).sum(axis=1)).sum()
    return float(dead / live) if dead > 0.0 and live > 0.0 else 1.0


def open_joints(model: Model) -> int:
    """How many faces start so close that they may meet: the geometry of the start is wrong for them."""
    edge = smallest_edge(model)
    return int((np.abs(find_joints(model, undeformed(model), NEAR * edge).separation) > TOUCH * edge).sum())
