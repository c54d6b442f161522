"""Sensitivity of a time history to joint stiffness: the same run on softer joints, and the change of its peaks.

Only joints of "auto" stiffness are the program's choice, and only these are checked. What elastic joints change shrinks
with their compliance: peaks that hold on joints ten times as soft hold on stiffer ones all the more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.analyses.ensembles.shaken_run import ProgressOnly, RestedStructure, ShakenRunResult
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.core.dynamics.extremes import without_meaning
from dem_cli.core.dynamics.rocking_stiffness import RockingStiffness
from dem_cli.core.engine.measures import largest_displacement
from dem_cli.core.engine.settings import Settings
from dem_cli.core.records.history_rows import MONITOR_UNITS

if TYPE_CHECKING:
    from dem_cli.case.schema import Monitor
    from dem_cli.core.dynamics.history import TimeHistory
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.records.requests import MonitorRequest

MOST_LISTED = 3  # monitors that a warning names
WHY = (
    "such motion hangs on chance (repeats = 20 shows its share) or on the stiffness of the joints, which only a given "
    "kn says"
)


def checked(
    job: CaseJob,
    history: TimeHistory,
    motions: Sequence[Motion],
    chosen: RockingStiffness,
    collapsed: bool | None,
    settings: Settings,
) -> dict[str, Any]:
    """Check a run on "auto" joints against softer ones as keys of the summary; doubts become warnings of the job.

    settings: those without the choice.
    """
    rocking = settings.rocking
    found: dict[str, Any] = {"joint_stiffness": chosen.ratio, "elastic_turn": chosen.turn, "softer_joints_move": None}
    if history.still:
        job.skipped.append("a second run on softer joints: nothing rocked or slid")
        return found
    run = _run(job, motions, chosen.softer(rocking.softer).applied(settings))
    factor, said = f"on joints {rocking.softer:g} times as soft", ""
    if run is None or not run.ending:
        job.skipped.append(f"a second run {factor}: {'it does not stand' if run is None else run.how}")
    elif run.collapsed is None and collapsed is not None:
        said = f"{factor} it is {run.how}: whether it falls there is not known"
    elif run.collapsed is not None and run.collapsed != bool(collapsed):
        job.contradictions.append(f"on softer joints it {'collapses' if run.collapsed else 'stands'}")
        said = f"{factor} the structure {'collapses' if run.collapsed else 'survives'}: {WHY}"
    elif not collapsed:
        least = trifles(job.request.monitors, history.peaks, history.sim.smallest, job.case.gravity, settings)
        moved = change(history.peaks, np.array(run.peaks), least)
        moved[without_meaning(job.request.monitors, history.extremes.impacts)] = 0.0
        found["softer_joints_move"] = float(moved.max()) if len(moved) else None
        said = _doubts(job, factor, moved, rocking.moved)
    if chosen.turn > rocking.doubtful:
        job.warnings.append(f"{chosen.doubt}; {said or _measured(factor, run, found['softer_joints_move'])}")
    elif said:
        job.warnings.append(said)
    return found


def _measured(factor: str, run: ShakenRunResult | None, moved: float | None) -> str:
    """Describe the change of the peaks on softer joints where the second run raises no doubt."""
    if moved is not None:
        return f"{factor} peaks move by {moved:.1%} at most"
    if run is not None and run.collapsed:
        return f"{factor} it collapses as well"
    return "how much that matters was not found, a given kn may show it"


def trifles(
    monitors: Sequence[MonitorRequest], peaks: np.ndarray, smallest: float, gravity: float, settings: Settings
) -> np.ndarray:
    """Select negligible peaks, (n,): a small share of the largest one of the same quantity, or no real motion.

    That is what counts as none of a block with an edge `smallest` [m]: so much of its size, of a turn of 1 rad, and of
    what it gains in speed as it falls by its size under `gravity` [m/s²].
    """
    share = settings.history.noticeable
    speed = math.sqrt(gravity * smallest)
    size = {"m": smallest, "rad": 1.0, "m/s": speed, "m/s2": gravity}
    found = [share * size.get(MONITOR_UNITS[monitor.quantity], 0.0) for monitor in monitors]
    for i, monitor in enumerate(monitors):
        alike = [peak for peak, other in zip(peaks.tolist(), monitors) if other.quantity == monitor.quantity]
        found[i] = max(found[i], share * max(alike))
    return np.array(found)


def change(one: np.ndarray, other: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Compute the relative difference of peaks over the larger one; 0 where neither exceeds the least relevant
    value.
    """
    larger = np.maximum(one, other)
    return np.where(larger > least, np.abs(other - one) / np.where(larger > 0.0, larger, 1.0), 0.0)


def _run(job: CaseJob, motions: Sequence[Motion], settings: Settings) -> ShakenRunResult | None:
    """Run the same structure under the same motion with other settings; None where it does not stand."""
    same = Variant(job.case, job.model, 0, settings.statistics.largest_draw)
    rested = RestedStructure(same, motions, ProgressOnly(job.clock, job.clock.stages), settings)

    def told(sim: DynamicSimulation, share: float) -> None:
        job.clock.progress("again on softer joints", 0.0, largest_displacement(sim), share)

    return rested.shaken(motions, told=told) if rested.stands else None


def _doubts(job: CaseJob, factor: str, moved: np.ndarray, allowed: float) -> str:
    """Describe the peaks that changed by more than allowed, the worst first; empty where none did."""
    worst = [i for i in np.argsort(-moved, kind="stable") if moved[i] > allowed]
    if not worst:
        return ""
    monitors = job.case.monitor
    names = [f"{_named(monitors[i])} by {moved[i]:.1%}" for i in worst[:MOST_LISTED]]
    more = f" and {len(worst) - MOST_LISTED} more" if len(worst) > MOST_LISTED else ""
    return f"{factor} peaks move, {', '.join(names)}{more}: {WHY}"


def _named(monitor: Monitor) -> str:
    """Name the quantity of a monitor in words: "displacement x of 'top'"."""
    quantity = f"{monitor.quantity} {monitor.component}" if monitor.component else monitor.quantity
    return f"{quantity} of '{monitor.place}'"
