"""Estimate a time history for `dem check`: frequencies, time step, steps, run time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from dem_cli.analyses.ensembles.record_search import records_of, runs_per_record
from dem_cli.analyses.estimate_cost import cost_of_shaking
from dem_cli.analyses.modes import touching_points
from dem_cli.core.dynamics.coda import longest_coda
from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.history import duration_of
from dem_cli.core.dynamics.time_step import TimeStep, time_step
from dem_cli.core.dynamics.vibration_error import refined
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.masonry.assembly.ground_motions import motions_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.records.requests import SolverRequest

Rows = list[tuple[str, str]]
MOST_MOTIONS = 6  # that are listed
SOFTER = DEFAULT.rocking.softer


def describe_shaking(
    case: Case, request: SolverRequest, sim: DynamicSimulation, automatic: bool
) -> list[tuple[str, str]]:
    """Describe a time history for `dem check`; automatic: some joints have the stiffness that the program chose.

    Raises CaseError where analysis.time_step is not stable, or nothing says how long to look, as a run does.
    """
    analysis = request.shaking
    step = time_step(sim, analysis.margin, analysis.time_step, sim.damping.stiffening)
    ground = GroundMotion(_motions(case), sim.model)
    step, drifts = refined(step, sim, ground.motions, duration_of(request, ground), analysis, request.initial)
    return [
        ("damping", sim.damping.words),
        ("highest frequency", step.cause),
        ("time step", _step(step)),
        *([("vibrations", drifts)] if drifts else []),
        ("first frequency", _first(sim)),
        *_cost(case, request, sim, step, automatic),
    ]


def _motions(case: Case) -> list[Motion]:
    """Return all motions of a fragility study, or those of a single run."""
    if case.analysis.kind != "fragility":
        return motions_of(case)
    return [motion for record in records_of(case) for motion in record.components]


def _step(step: TimeStep) -> str:
    if not math.isfinite(step.limit):
        return "free: nothing limits it"
    return f"{step.step:.3g} s, {step.step / step.limit:.2g} of the largest stable one, {step.limit:.3g} s"


def _first(sim: DynamicSimulation) -> str:
    found = modes(system(sim, touching_points(sim)), 1, sim.model.dimension, sim.model.n_blocks)
    if not len(found.frequencies):
        return "none: no joint holds any block"
    return f'{found.frequencies[0]:.4g} Hz, all joints that touch closed; kind = "modes" has those under gravity'


def _cost(
    case: Case, request: SolverRequest, sim: DynamicSimulation, step: TimeStep, automatic: bool
) -> list[tuple[str, str]]:
    analysis, ground = case.analysis, GroundMotion(motions_of(case), sim.model)
    length = duration_of(request, ground)
    checked = automatic and analysis.kind != "fragility"
    runs, said = _runs(case, checked)
    peak = "" if analysis.kind == "fragility" else f", {ground_words(motions_of(case))}"
    rows = [("load", f"{length:g} s of motion{peak}"), *([("runs", said)] if said else [])]
    if not math.isfinite(step.step):
        return rows
    steps = math.ceil(length / step.step)
    more = math.ceil(longest_coda(request, sim.model) / step.step)
    return [
        *rows,
        ("steps", f"{steps:,}"),
        *([("coda", f"up to {more:,} steps more, where it still moves then")] if more else []),
        *cost_of_shaking(sim, step, steps, more, runs, SOFTER if checked else None),
    ]


def ground_words(motions: Sequence[Motion]) -> str:
    """Describe the peaks of ground motions; where several act together, each with its direction."""
    if len(motions) < 2:
        return f"peak {max((motion.peak for motion in motions), default=0.0):.4g} m/s²"
    shown = [f"{motion.peak:.4g} m/s² along {_way(motion.direction)}" for motion in motions[:MOST_MOTIONS]]
    more = [f"{len(motions) - MOST_MOTIONS} more"] if len(motions) > MOST_MOTIONS else []
    return "peaks " + ", ".join([*shown, *more])


def _way(direction: Sequence[float]) -> str:
    """Name an axis, or give another direction by its components."""
    along = [k for k, part in enumerate(direction) if part != 0.0]
    if len(along) == 1:
        return f"{'−' if direction[along[0]] < 0.0 else ''}{'xyz'[along[0]]}"
    return f"[{', '.join(f'{part:.3g}' for part in direction)}]"


def _runs(case: Case, checked: bool) -> tuple[int, str]:
    """Return the largest number of runs with an explanation; checked: one more run for the stiffness."""
    analysis = case.analysis
    repeats = 1 + analysis.repeats
    words = f" × {repeats} with repeats" if repeats > 1 else ""
    if analysis.kind != "fragility":
        said = [f"{repeats} with repeats"] if repeats > 1 else []
        if checked:
            said += [
                f"one more on joints {SOFTER:g} times as soft where blocks rock or slide, as their stiffness is auto"
            ]
        return repeats, ", ".join(said)
    records = len(records_of(case))
    levels = runs_per_record(analysis)
    name = "steps of bisection" if analysis.bisects else "intensities"
    runs = records * levels * repeats
    return runs, f"{records} records × {levels} {name}{words}: {'at most ' if analysis.bisects else ''}{runs:,}"
