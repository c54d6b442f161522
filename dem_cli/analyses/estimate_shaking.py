"""Estimate of a time history, for `dem check`: frequencies, time step, steps, run time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from dem_cli.analyses.modes import touching_points
from dem_cli.dynamics.frequencies import modes, system
from dem_cli.dynamics.ground import GroundMotion
from dem_cli.dynamics.rocking_stiffness import rocking_stiffness
from dem_cli.dynamics.time_step import TimeStep, time_step
from dem_cli.engine.clock import duration_words
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.ensembles.record_search import records_of, runs_per_record
from dem_cli.motion.ground_motions import motions_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.engine.dynamic import DynamicSimulation
    from dem_cli.model.model import Model
    from dem_cli.motion.motion import Motion

NANOSECONDS = {  # per contact point and step, one core, by dimension, without and with dashpots
    2: {False: 20, True: 55},
    3: {False: 60, True: 110},  # about: a third less where blocks stand, a third more where all of them rock
}
PER_STEP = 0.4  # µs beside them
MOST_MOTIONS = 6  # that are listed


def settings_of(case: Case, model: Model) -> Settings:
    """Settings with the stiffness that a run gives "auto" joints."""
    return rocking_stiffness(case, model, DEFAULT).applied(DEFAULT)


def describe_shaking(case: Case, sim: DynamicSimulation, beside: float) -> list[tuple[str, str]]:
    """Lines of `dem check`; beside: what a run takes beside its steps [s].

    Raises CaseError where analysis.time_step is not stable.
    """
    analysis = case.analysis
    step = time_step(sim, analysis.margin, analysis.time_step, sim.damping.stiffening)
    return [
        ("damping", sim.damping.words),
        ("highest frequency", step.cause),
        ("time step", _step(step)),
        ("first frequency", _first(sim)),
        *_cost(case, sim, step, beside),
    ]


def _step(step: TimeStep) -> str:
    if not math.isfinite(step.limit):
        return "free: nothing limits it"
    return f"{step.step:.3g} s, {step.step / step.limit:.2g} of the largest stable one, {step.limit:.3g} s"


def _first(sim: DynamicSimulation) -> str:
    found = modes(system(sim, touching_points(sim)), 1, sim.model.dimension, sim.model.n_blocks)
    if not len(found.frequencies):
        return "none: no joint holds any block"
    return f'{found.frequencies[0]:.4g} Hz, all joints that touch closed; kind = "modes" has those under gravity'


def _cost(case: Case, sim: DynamicSimulation, step: TimeStep, beside: float) -> list[tuple[str, str]]:
    analysis, ground = case.analysis, GroundMotion(motions_of(case), sim.model)
    length, points = analysis.duration or ground.duration, sim.first_points
    if length <= 0.0:
        return [("load", "how long is not said: no [motion] does, and analysis.duration is missing")]
    runs, said = _runs(case)
    peak = "" if analysis.kind == "fragility" else f", {ground_words(motions_of(case))}"
    rows = [("load", f"{length:g} s of motion{peak}"), *([("runs", said)] if said else [])]
    if not math.isfinite(step.step):
        return rows
    steps = math.ceil(length / step.step)
    more = math.ceil(analysis.coda / step.step)
    each_point = NANOSECONDS[sim.model.dimension][sim.damping.in_joints]
    seconds = beside + (1e-9 * each_point * points + 1e-6 * PER_STEP) * steps * runs
    work = f"{points:,} points × {each_point} ns + {PER_STEP} µs"
    each = f"{runs:,} runs × " if runs > 1 else ""
    return [
        *rows,
        ("steps", f"{steps:,}"),
        *([("coda", f"up to {more:,} steps more, where it still moves then")] if more else []),
        ("cost", f"{duration_words(seconds)} on one core ({each}{steps:,} steps × ({work}))"),
    ]


def ground_words(motions: Sequence[Motion]) -> str:
    """Peaks of ground motions; where several come together, each with its direction."""
    if len(motions) < 2:
        return f"peak {max((motion.peak for motion in motions), default=0.0):.4g} m/s²"
    shown = [f"{motion.peak:.4g} m/s² along {_way(motion.direction)}" for motion in motions[:MOST_MOTIONS]]
    more = [f"{len(motions) - MOST_MOTIONS} more"] if len(motions) > MOST_MOTIONS else []
    return "peaks " + ", ".join([*shown, *more])


def _way(direction: Sequence[float]) -> str:
    """An axis by its name, another direction by its components."""
    along = [k for k, part in enumerate(direction) if part != 0.0]
    if len(along) == 1:
        return f"{'−' if direction[along[0]] < 0.0 else ''}{'xyz'[along[0]]}"
    return f"[{', '.join(f'{part:.3g}' for part in direction)}]"


def _runs(case: Case) -> tuple[int, str]:
    """How many runs there are at most, and why; no words for one."""
    analysis = case.analysis
    repeats = 1 + analysis.repeats
    words = f" × {repeats} with repeats" if repeats > 1 else ""
    if analysis.kind != "fragility":
        return repeats, f"{repeats} with repeats" if repeats > 1 else ""
    records = len(records_of(case))
    levels = runs_per_record(analysis)
    name = "steps of bisection" if analysis.bisects else "intensities"
    runs = records * levels * repeats
    return runs, f"{records} records × {levels} {name}{words}: {'at most ' if analysis.bisects else ''}{runs:,}"
