"""From a case and its model to an outcome: what every analysis shares."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.kernels.jit import cache_is_cold
from dem_cli.model.model import Model
from dem_cli.output.record import Frame, HistoryRow, Observer
from dem_cli.solve.joints import FIXED_RATIO, joint_properties, law_of
from dem_cli.solve.registry import ANALYSES
from dem_cli.solve.simulation import TOUCH, Simulation

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

NEAR = 1e-3  # gaps below this share of the smallest edge are meant: they may close
CLOSURE = 0.01  # energy error above which a run says so


@dataclass
class Outcome:
    """What a solver returns; `summary` holds the keys of summary.json that are the solver's."""

    summary: dict[str, Any]


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Solve a case with the analysis that it names. Raises SolverError where the solver gives up."""
    return ANALYSES[case.analysis.kind].load()(case, model, observer)


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

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        begun = time.perf_counter()
        self.observer.progress(stage, load, displacement, fraction)
        self.observing += time.perf_counter() - begun

    def compile(self, sim: Simulation) -> None:
        """Compile (or load) the kernel of a simulation, off the clock."""
        begun = time.perf_counter()
        if cache_is_cold():
            self.progress("compiling (once)", 0.0, 0.0, None)
        sim.compile()
        self.compiling += time.perf_counter() - begun

    def seconds(self) -> float:
        return time.perf_counter() - self.started - self.compiling - self.observing


def live_scale(model: Model) -> float:
    """Factor that makes the live loads as large as the dead ones, so that a multiplier is of the order of one."""
    d, free = model.dimension, ~model.fixed
    dead = np.sqrt((model.dead_loads[free, :d] ** 2).sum(axis=1)).sum()
    live = np.sqrt((model.live_loads[free, :d] ** 2).sum(axis=1)).sum()
    return float(dead / live) if dead > 0.0 and live > 0.0 else 1.0


def simulation(case: Case, model: Model, kinematics: str, ratio: float = FIXED_RATIO) -> Simulation:
    """A simulation of the case; `ratio` is the kn·h/W of "auto" joints."""
    pattern = getattr(case.analysis, "pattern", None)
    scale = live_scale(model)
    return Simulation(
        model._replace(live_loads=model.live_loads), law_of(case), joint_properties(case, model, ratio),
        kinematics, live_scale=1.0 if pattern == "tilt" else scale, tilting=pattern == "tilt",
    )  # fmt: skip


def wants_large(case: Case, model: Model, sim: Simulation) -> str:
    """Why frozen geometry would be wrong from the start; "" where it is right."""
    from dem_cli.contact.detect import find_joints

    faces = find_joints(model, sim.bodies.corners, NEAR * sim.smallest)
    near = np.abs(faces.separation) > TOUCH * sim.smallest
    return f"{int(near.sum())} joints have gaps that may close" if near.any() else ""


def closure(sim: Simulation) -> float:
    """Energy error over the largest energy in the ledger: 0 where the books balance."""
    e = sim.energy()
    error = e.kinetic + e.elastic + e.gravity + e.friction + e.damping - e.external - e.supports
    largest = max(abs(e.external), abs(e.gravity), abs(e.supports), e.friction, e.elastic, e.damping)
    return float(error / largest) if largest > 0.0 else 0.0


def common_summary(sims: list[Simulation], clock: Clock, skipped: list[str]) -> dict[str, Any]:
    """Keys that every kind of analysis reports."""
    worst = max((closure(sim) for sim in sims), key=abs)
    overlap = max(sim.largest_overlap() / sim.smallest for sim in sims)
    warnings = []
    if abs(worst) > CLOSURE:
        warnings.append(f"the energy does not close: {worst:.2%} is missing; do not trust this run")
    if overlap > 0.01:
        warnings.append(f"blocks overlap by {overlap:.1%} of the smallest edge: the joints are too soft for these loads")
    return {
        "joints": len(sims[0].joints.blocks),
        "contacts": len(sims[0].joints.kn),
        "steps": sims[-1].steps,
        "time_step": 1.0,
        "solve_seconds": clock.seconds(),
        "compile_seconds": clock.compiling,
        "energy_closure": worst,
        "largest_overlap": overlap * sims[0].smallest,
        "unbalanced_force": sims[0].unbalanced,
        "skipped": skipped,
        "warnings": warnings,
    }
