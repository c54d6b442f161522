"""Time-history analysis, kind = "time-history": motion under ground motion, and how reliable its peaks are.

analysis.repeats: the same motion on slightly different structures, and how much peaks differ.

One record is one draw: an exact integration of rocking blocks whose records are scaled by 0.1 % has another outcome in
19 of 240 cases (docs/rocking.md). A peak without its spread says little.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.ensembles.batch import Batch, Batcher, ShakingTrial, each
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.analyses.ensembles.shaken_run import ProgressOnly, RestedStructure, ShakenRunResult, told_peaks
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.analyses.stiffness_check import checked
from dem_cli.core.dynamics.bending_stiffness import bending_doubts
from dem_cli.core.dynamics.coda import longest_coda, undecided
from dem_cli.core.dynamics.extremes import without_meaning
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.history import TimeHistory
from dem_cli.core.dynamics.rocking_stiffness import rocking_stiffness
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.records.history_rows import RunRow
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import FALLS, MOVES
from dem_cli.masonry.assembly.ground_motions import motions_of
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

EARTHQUAKES = ("record", "artificial")  # kinds of [motion] that are one draw of many
ONE_DRAW = (
    "the peaks are those of one record on one structure: rocking is ill-conditioned, and a change of 0.1 % may give "
    "others, or a collapse; repeats = 20 shows their spread, kind = 'fragility' that of many records"
)
ENOUGH = 10  # repeats that stood: of fewer the run itself is often the least or the largest by chance
PERCENTILES = {"min": 0.0, "p16": 16.0, "median": 50.0, "p84": 84.0, "max": 100.0}


def run(
    case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT, batch: Batch | None = None
) -> Outcome:
    """Run a time history with its sensitivity checks. Raises SolverError where the integration diverges."""
    job = CaseJob.of_case(case, model, observer, settings)
    motions = motions_of(case)
    ground = GroundMotion(motions, model)
    chosen = rocking_stiffness(job.request, model, settings)
    job.settings = chosen.applied(settings)
    history = TimeHistory(job, ground)
    outcome = history.run()
    if history.still and outcome.summary["status"] == "ok":
        outcome.summary["warnings"].append(
            f"nothing rocked or slid: no block moved by more than {history.farthest:.2g} m; is the motion as strong as "
            f"meant, with a peak of {ground.peak:.3g} m/s2?"
        )
    if chosen.automatic and outcome.summary["status"] == "ok":
        outcome.summary |= checked(job, history, motions, chosen, outcome.summary["collapsed"], settings)
    outcome.summary["warnings"] += bending_doubts(job.request, model, settings)
    if doubtful(case) and not history.still and outcome.summary["status"] != FALLS:
        outcome.summary["warnings"].append(ONE_DRAW)
    if case.analysis.repeats and outcome.summary["status"] == "ok":
        found = repeated(case, model, observer, job.settings, batch or Batch())
        outcome.summary["warnings"] += found.pop("warnings")
        outcome.summary["warnings"] += alone(case, history.peaks, found["repeats"], settings.rocking.spread)
        outcome.summary["contradictions"] += otherwise(outcome.summary["collapsed"], found["repeats"])
        outcome.summary |= found
    return outcome


def doubtful(case: Case) -> bool:
    """Test whether the peaks of an earthquake case lack repeated runs for their sensitivity."""
    return case.analysis.repeats == 0 and any(table.kind in EARTHQUAKES for table in case.motion)


def repeated(case: Case, model: Model, observer: Observer, settings: Settings, batch: Batch) -> dict[str, Any]:
    """Return the spread of the peaks over the repeats that stood and the share that collapsed, as keys of the summary.

    settings: those of the run beside it, with the same stiffness of "auto" joints.
    """
    started = time.perf_counter()
    motions, quiet, request = motions_of(case), ProgressOnly(observer), solver_request(case)
    variants = [Variant(case, model, 1 + k, settings.statistics.largest_draw) for k in range(case.analysis.repeats)]
    structures = [RestedStructure(variant, motions, quiet, settings) for variant in variants]
    trials = [ShakingTrial(k, 0, 1.0) for k, rested in enumerate(structures) if rested.stands]
    batcher = Batcher(structures, lambda _: motions, batch, settings.statistics)

    def say(done: int) -> None:
        observer.progress(f"repeats {done:,} of {len(trials):,}", math.nan, math.nan, done / max(len(trials), 1))

    batcher.work([*each(trials)], say)
    runs = [batcher.done[trial] for trial in trials]
    observer.runs(_rows(trials, runs, structures, max((motion.peak for motion in motions), default=0.0)))
    warnings = [f"structure {1 + t.structure}: {run.how}" for t, run in zip(trials, runs) if not run.ending]
    fell = case.analysis.repeats - len(trials)
    if fell:
        warnings.append(f"{fell} of {case.analysis.repeats} perturbed structures do not stand: left out")
    ended = [run for run in runs if run.ending]
    found = spread(ended, len(case.monitor))
    for i in without_meaning(request.monitors, max((run.impacts for run in ended), default=0)):
        found["peaks"][i] = None
    warnings += undecided(found["still_moving"], found["runs"], longest_coda(request, model))
    return {
        "repeats": found | {"seconds": sum(run.seconds for run in runs)},
        "repeat_seconds": time.perf_counter() - started,
        "warnings": warnings,
    }


def spread(runs: Sequence[ShakenRunResult], n_monitors: int) -> dict[str, Any]:
    """Count collapses, and compute percentiles of the peaks of the runs that stood: a list, None where none did.

    still_moving: runs whose blocks still move when the time after the motion is over; neither standing nor fallen.
    """
    stood = [run.peaks for run in runs if run.collapsed is False]
    peaks = np.array(stood).reshape(len(stood), n_monitors)
    collapsed, moving = sum(bool(run.collapsed) for run in runs), sum(run.ending == MOVES for run in runs)
    columns = [
        {name: float(np.percentile(column, q)) for name, q in PERCENTILES.items()} if len(column) else None
        for column in peaks.T
    ]
    share = collapsed / (len(runs) - moving) if len(runs) > moving else None
    counts = {"runs": len(runs), "collapsed": collapsed, "still_moving": moving}
    return counts | {"share_collapsed": share, "peaks": columns}


def alone(case: Case, peaks: np.ndarray, repeats: dict[str, Any], allowed: float) -> list[str]:
    """Warn about peaks that scatter widely over the repeats, or lie outside them; the first of each kind is named."""
    wide, outside = [], []
    runs = repeats.get("runs", ENOUGH) - repeats.get("collapsed", 0) - repeats.get("still_moving", 0)
    for monitor, peak, found in zip(case.monitor, peaks.tolist(), repeats["peaks"]):
        if found is None:
            continue
        name = f"{monitor.quantity} of '{monitor.place}'"
        between = f"{found['min']:.3g} to {found['max']:.3g}"
        if runs >= ENOUGH and not found["min"] <= peak <= found["max"]:
            outside.append(f"the peak {name}, {peak:.3g}, lies outside of those of its repeats, {between}")
        if found["p84"] - found["p16"] > allowed * found["median"]:
            wide.append(f"the peak {name} hangs on chance: structures that differ by next to nothing have {between}")
    return [f"{texts[0]}{_more(texts)}: quote the spread, not the peak" for texts in (outside, wide) if texts]


def otherwise(collapsed: bool | None, repeats: dict[str, Any]) -> list[str]:
    """Warn about repeats that end differently from the main run; none where its own end is not known."""
    fell, runs = repeats["collapsed"], repeats["runs"]
    stood = runs - fell - repeats["still_moving"]
    if collapsed is False and fell:
        return [f"{fell} of {runs} perturbed structures collapsed"]
    return [f"{stood} of {runs} perturbed structures stood"] if collapsed and stood else []


def _more(texts: Sequence[str]) -> str:
    return f", and so of {len(texts) - 1} more" if len(texts) > 1 else ""


def _rows(
    trials: Sequence[ShakingTrial], runs: Sequence[ShakenRunResult], structures: Sequence[RestedStructure], peak: float
) -> list[RunRow]:
    return [
        RunRow(
            1 + trial.structure, "", 1.0, peak * structures[trial.structure].variant.motion, run.collapsed, run.time,
            run.how, told_peaks(structures[trial.structure].request.monitors, run),
        )
        for trial, run in zip(trials, runs, strict=True)
    ]  # fmt: skip
