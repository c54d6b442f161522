"""Fragility analysis, kind = "fragility": which intensities of a set of records a structure survives.

Overturning is not monotone in amplitude: a structure may fall at one intensity and survive a higher one. The collapse
intensity of a record is the lowest one at which the structure fell among those that were tried.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.ensembles.batch import Batch, Batcher, ShakingTrial, Task, each
from dem_cli.analyses.ensembles.capacities import (
    Bounds,
    Outcomes,
    between,
    bounds_of,
    distribution,
    outcomes,
    split,
    survived_above,
)
from dem_cli.analyses.ensembles.record_search import bisection, records_of, runs_per_record, scaled
from dem_cli.analyses.ensembles.shaken_run import ProgressOnly, RestedStructure, told_peaks
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.core.dynamics.bending_stiffness import bending_doubts
from dem_cli.core.dynamics.braked_motion import braked_words
from dem_cli.core.dynamics.coda import longest_coda, undecided
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.history import duration_of
from dem_cli.core.dynamics.rocking_stiffness import rocking_stiffness
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.records.history_rows import RunRow
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import FALLS, MOVES
from dem_cli.errors import SolverError
from dem_cli.masonry.assembly.solver_request import solver_request
from dem_cli.results.output.distinct_names import distinct

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.tables.analysis import FragilityAnalysis
    from dem_cli.core.motion.motion import Motion

MOST_LISTED = 5  # runs that one warning names


def run(
    case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT, batch: Batch | None = None
) -> Outcome:
    """Run a fragility analysis. Raises CaseError without any record, SolverError where no run has a result."""
    return FragilityStudy(case, model, observer, settings, batch or Batch()).run()


class FragilityStudy:
    """Fragility study of all records at all intensities, on the structure of the case and perturbed ones."""

    def __init__(self, case: Case, model: Model, observer: Observer, settings: Settings, batch: Batch):
        self.case, self.model, self.observer, self.batch = case, model, observer, batch
        self.request = solver_request(case)
        self.analysis: FragilityAnalysis = case.analysis
        self.started = time.perf_counter()
        self.records = records_of(case)
        self.names = distinct([record.name for record in self.records])
        self.motions = [motion for record in self.records for motion in record.components]
        duration_of(self.request, GroundMotion(self.motions, model))  # which must be known
        self.stiffness = rocking_stiffness(self.request, model, settings)
        self.coda = longest_coda(self.request, model)
        self.settings = self.stiffness.applied(settings)
        self.warnings = [self.stiffness.doubt] if self.stiffness.turn > settings.rocking.doubtful else []
        self.warnings += bending_doubts(self.request, model, settings)

    def run(self) -> Outcome:
        """Bring the structures to rest, run all trials, and summarise them."""
        self.rested = self._rest()
        if not self.rested[0].stands:
            return Outcome(self._facts() | {"status": FALLS, "collapse_intensities": None, "runs": 0})
        self.batcher = Batcher(self.rested, self._motion, self.batch, self.settings.statistics)
        pairs = [(s, r) for r in range(len(self.records)) for s in range(len(self.rested)) if self.rested[s].stands]
        tasks, expected = self._plan(pairs)

        def say(done: int) -> None:
            total = max(expected, done)
            self.observer.progress(f"runs {done:,} of {total:,}", math.nan, math.nan, done / total)

        say(len(self.batcher.done))
        self.batcher.work(tasks, say)
        self.observer.runs(self._rows())
        return Outcome(self._facts() | self._answer(pairs) | self._effort())

    def _rest(self) -> list[RestedStructure]:
        """Bring all structures to rest under their dead loads."""
        quiet, found = ProgressOnly(self.observer), []
        for number in range(1 + self.analysis.repeats):
            found.append(self._rested(number, quiet))
        fell = [rested.variant.number for rested in found if not rested.stands]
        if fell and found[0].stands:
            self.warnings.append(f"{len(fell)} of {len(found) - 1} perturbed structures do not stand: left out")
        return found

    def _rested(self, number: int, quiet: Observer) -> RestedStructure:
        """Bring one structure of the set to rest under its dead loads."""
        variant = Variant(self.case, self.model, number, self.settings.statistics.largest_draw)
        return RestedStructure(variant, self.motions, quiet, self.settings)

    def _motion(self, trial: ShakingTrial) -> list[Motion]:
        return scaled(self.records[trial.record], trial.intensity, self.analysis)

    def _plan(self, pairs: Sequence[tuple[int, int]]) -> tuple[list[Task], int]:
        """Plan the tasks, and the number of runs that they will take (of a bisection: at most)."""
        analysis = self.analysis
        if not analysis.bisects:
            trials = [ShakingTrial(s, r, a) for s, r in pairs for a in analysis.levels]
            return [*each(trials)], len(trials)
        return [bisection(analysis, s, r) for s, r in pairs], len(pairs) * runs_per_record(analysis)

    def _rows(self) -> list[RunRow]:
        """Return all runs in the order of records, structures and intensities, whatever the order in which they
        finished.
        """
        rows = []
        for trial in sorted(self.batcher.done, key=lambda t: (t.record, t.structure, t.intensity)):
            run, peak = self.batcher.done[trial], max(motion.peak for motion in self._motion(trial))
            acceleration = peak * self.rested[trial.structure].variant.motion
            rows.append(RunRow(trial.structure, self.names[trial.record], trial.intensity, acceleration,
                               run.collapsed, run.time, run.how, told_peaks(self.request.monitors, run)))  # fmt: skip
        return rows

    # -- what the runs say -------------------------------------------------------------------------

    def _answer(self, pairs: Sequence[tuple[int, int]]) -> dict[str, Any]:
        found = {(s, r): outcomes(self.batcher.done, s, r) for s, r in pairs}
        structures = sorted({s for s, _ in pairs})
        bounds = {pair: bounds_of(runs) for pair, runs in found.items()}
        complete = [r for r in range(len(self.records)) if all(bounds[s, r] is not None for s in structures)]
        if not complete:
            first = min(self.batcher.done.items())[1]
            remedy = "; a longer analysis.coda may tell how it ends" if first.ending == MOVES else ""
            raise SolverError(f"no record has a result; the first: {first.how}{remedy}")
        self._warn_failed()
        table = np.array([[bounds[s, r] for s in structures] for r in complete], float)
        intervals = len(np.unique(table.reshape(-1, 2), axis=0))
        levels = list(self.analysis.levels)
        answer: dict[str, Any] = {
            "status": "ok",
            "records": self.names,
            "collapse_intensities": [_upper(bounds[0, r]) for r in range(len(self.records))],
            "stood_up_to": [_lower(bounds[0, r]) for r in range(len(self.records))],
            **distribution(table, levels, self.analysis.confidence, self.settings.statistics),
            "median_between": None,
            "never_collapsed": int(np.isinf(table[:, :, 1]).sum()),
            "collapsed_at_lowest": int((table[:, :, 0] == 0.0).sum()),
            "unit_acceleration": self.analysis.unit_acceleration,
            "search": "bisection" if self.analysis.bisects else "grid",
        }
        if not self.analysis.bisects:
            answer |= {"levels": levels, "share": [_share(found.values(), level) for level in levels]}
        above = [
            {"record": self.names[r], "structure": s, "collapsed": fell.upper, "survived": survived_above(runs)}
            for (s, r), runs in found.items()
            if survived_above(runs) and (fell := bounds[s, r]) is not None
        ]
        answer["non_monotone"] = above
        self._warn_about(answer, intervals)
        if answer["median"] is not None and intervals <= self.settings.statistics.few:
            low, high = between(table)
            answer |= dict.fromkeys(("median", "dispersion", "confidence", "curve"))
            answer["median_between"] = [low, high if math.isfinite(high) else None]
        if len(structures) > 1:
            answer["repeats"] = {
                "structures": structures[1:],
                "collapse_intensities": [[_upper(bounds[s, r]) for s in structures] for r in range(len(self.records))],
                "dispersion": split(table),
            }
        return answer

    def _warn_failed(self) -> None:
        done = self.batcher.done
        failed = [(t, run) for t, run in sorted(done.items()) if not run.ending]
        for trial, run in failed[:MOST_LISTED]:
            self.warnings.append(f"{self.names[trial.record]} at {trial.intensity:g}: {run.how}")
        if failed:
            self.warnings.append(f"{len(failed)} of {len(done)} runs failed and are left out")
        self.warnings += undecided(sum(run.ending == MOVES for run in done.values()), len(done), self.coda)

    def _warn_about(self, answer: dict[str, Any], intervals: int) -> None:
        """Warn about limits of the fragility curve; intervals: number of different capacity bounds."""
        if answer["median"] is not None and intervals <= self.settings.statistics.few:
            self.warnings.append(
                f"all collapse intensities lie in {intervals} interval{'s' * (intervals > 1)} between levels: median "
                "and dispersion are not resolved, closer levels are needed"
            )
        elif answer["median"] is not None and answer["confidence"] is None:
            self.warnings.append(
                "fewer than 2 records both stood and fell: median and dispersion have no confidence band, take "
                "more records or other intensities"
            )
        if self.analysis.bisects:
            self.warnings.append(
                "bisection takes for granted that a structure that falls falls at every higher intensity too; rocking "
                "structures need not: a lower collapse may be missed (search = 'grid' with intensities tries all)"
            )
        if self.analysis.repeats == 0:
            self.warnings.append(
                "each run hangs on chance: rocking is ill-conditioned, and structures that differ by 0.1 % fall at "
                "other intensities; repeats = 5 shows by how much"
            )
        braked = max((run.braked for run in self.batcher.done.values()), default=0.0)
        if braked > self.settings.doubts.governs:
            self.warnings.append(braked_words(self.request.damping, braked, " in one of the runs"))
        worst = _worst(run.closure for run in self.batcher.done.values() if run.collapsed is False)
        if worst is not None and abs(worst) > self.settings.doubts.closure:
            self.warnings.append(f"the energy of a run that stood does not close: {worst:.2%} is missing")
        if answer["never_collapsed"] and answer["median"] is not None:
            highest = self.analysis.levels[-1]
            self.warnings.append(f"{answer['never_collapsed']} collapse intensities are above {highest:g}: not known")

    # -- how it was obtained -----------------------------------------------------------------------

    def _facts(self) -> dict[str, Any]:
        first = self.rested[0]
        compiling = sum(rested.compile_seconds for rested in self.rested)
        return {
            "joints": first.sim.first_joints,
            "contacts": first.sim.first_points,
            "steps": 0,
            "time_step": first.step.step,
            "largest_time_step": first.step.limit,
            "damping": first.damping.words,
            "solve_seconds": time.perf_counter() - self.started - compiling,
            "compile_seconds": compiling,
            "energy_closure": None,
            "warnings": self.warnings,
        }

    def _effort(self) -> dict[str, Any]:
        done = self.batcher.done.values()
        return {
            "runs": len(done),
            "runs_done_before": len(done) - self.batcher.fresh,
            "steps": sum(run.steps for run in done),
            "seconds": sum(run.seconds for run in done),
            "threads": self.batch.threads,
            "still_moving": sum(run.ending == MOVES for run in done),
            "energy_closure": _worst(run.closure for run in done if run.collapsed is False),
            "energy_closure_of_collapses": _worst(run.closure for run in done if run.collapsed),
        }


def _worst(closures: Iterable[float | None]) -> float | None:
    """Return the largest of the energy balance errors."""
    return max((closure for closure in closures if closure is not None), key=abs, default=None)


def _upper(bounds: Bounds | None) -> float | None:
    return None if bounds is None or math.isinf(bounds.upper) else bounds.upper


def _lower(bounds: Bounds | None) -> float | None:
    return None if bounds is None else bounds.lower


def _share(found: Iterable[Outcomes], level: float) -> float | None:
    """Return the share of runs at a level that collapsed."""
    tried = [runs[level] for runs in found if level in runs]
    return sum(tried) / len(tried) if tried else None
