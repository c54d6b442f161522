"""Run all runs of a sweep, each in its own folder: finished ones are not repeated, failures stop no other."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.app import api
from dem_cli.app.sweep.identity import facts, name_of
from dem_cli.app.sweep.plan import SweepPlan, SweepRun
from dem_cli.app.sweep.pool import WorkerDeath
from dem_cli.case.overrides import Override, key_path, value_at
from dem_cli.case.reader import LoadedCase
from dem_cli.case.writer import case_text
from dem_cli.errors import CaseError, CaseProblem, UsageError
from dem_cli.results.output.folder import OWN_KEYS, SUMMARY, abandoned, write_error
from dem_cli.results.output.sweep_files import RUNS

FAILED, WAITING = "failed", "waiting"
MOST_MISTAKES = 5  # mistakes that are listed
LIGHT = (("output.frames", 0), ("analysis.follow", 0.0))  # what a table of answers does not need
DIED = "its process died, twice; perhaps for want of memory"
Summary = Mapping[str, Any]


class SweepJob(NamedTuple):
    """Job of a sweep: everything that another process needs for a run."""

    id: str
    path: str  # of the case file, for messages and records beside it
    text: str  # what it holds
    overrides: tuple[Override, ...]
    folder: str  # of the results


class PlannedSweep(NamedTuple):
    """Planned sweep: one job per row of its table; equal runs have equal jobs."""

    plan: SweepPlan
    jobs: tuple[SweepJob | None, ...]  # None: the changes of this run make no valid case
    reasons: dict[int, str]  # why not, by row
    base: dict[str, Any]  # value in the file of each key that some runs leave alone


def prepared(loaded: LoadedCase, plan: SweepPlan, folder: Path, given: Sequence[Override], light: bool) -> PlannedSweep:
    """Create the jobs of a plan.

    Raises CaseError where a listed value is wrong in all runs that have it, UsageError where all runs change a given
    override.

    given: overrides of the whole sweep. light: nothing is kept that the table of answers does not need.
    """
    _in_vain(given, plan)
    extra = _light(loaded, plan) if light else ()
    jobs: list[SweepJob | None] = []
    wrong: dict[int, CaseError] = {}
    path = loaded.path.resolve()
    for row, run in enumerate(plan.runs):
        overrides = (*given, *extra, *run.overrides)
        try:
            case = api.load_case(loaded.path, overrides, loaded.text).case
        except CaseError as error:
            wrong[row] = error
            jobs.append(None)
            continue
        name = name_of(facts(case, case_text(case)))
        jobs.append(SweepJob(name, str(path), loaded.text, overrides, str(folder / RUNS / name)))
    _buildable(loaded, next(job for job in jobs if job is not None) if len(wrong) < len(jobs) else None)
    mistaken = _mistaken(plan.runs, wrong)
    if mistaken:
        raise CaseError([CaseProblem((), line) for line in list(dict.fromkeys(mistaken))[:MOST_MISTAKES]])
    return PlannedSweep(plan, tuple(jobs), {row: str(error) for row, error in wrong.items()}, _base(loaded, plan))


def _in_vain(given: Sequence[Override], plan: SweepPlan) -> None:
    """Raise UsageError where every run changes what the command line set."""
    swept = set.intersection(*({tuple(map(str, change.path)) for change in run.overrides} for run in plan.runs))
    for override in given:
        if tuple(map(str, override.path)) in swept - {("sweep",)}:
            raise UsageError(f"--set {override.text}: every run of the sweep changes it; change [sweep] instead")


def _buildable(loaded: LoadedCase, first: SweepJob | None) -> None:
    """Raise CaseError where neither the first run nor the case itself has blocks: all would fail."""
    if first is None:
        return
    try:
        api.build_model(api.load_case(first.path, first.overrides, first.text))
    except CaseError:
        api.build_model(api.load_case(loaded.path, loaded.overrides, loaded.text))


def _light(loaded: LoadedCase, plan: SweepPlan) -> tuple[Override, ...]:
    """Return overrides without snapshots and collapse; a capacity curve keeps its extent."""
    swept = {override.path[:2] for run in plan.runs for override in run.overrides}
    other_kinds = swept & {("analysis",), ("analysis", "kind"), ("analysis", "control")}
    analysis = loaded.case.analysis
    by_load = getattr(analysis, "control", "load") == "load"
    follows = "follow" in type(analysis).model_fields and by_load and not other_kinds
    keys = [(key, value) for key, value in LIGHT if follows or not key.startswith("analysis")]
    return tuple(Override(key, tuple(key.split(".")), value) for key, value in keys)


def _mistaken(runs: Sequence[SweepRun], wrong: Mapping[int, CaseError]) -> list[str]:
    """Return messages for listed values that are wrong in every run, or for all runs if all are wrong."""
    if len(wrong) == len(runs):
        return [str(error) for error in wrong.values()]
    fine = {(c.key, repr(c.value)) for row, run in enumerate(runs) if row not in wrong for c in run.changes}
    return [
        str(error)
        for row, error in wrong.items()
        if not runs[row].sampled and any((c.key, repr(c.value)) not in fine for c in runs[row].changes)
    ]


def _base(loaded: LoadedCase, plan: SweepPlan) -> dict[str, Any]:
    """Return the values of the file for keys that not every run changes."""
    found = {}
    for key in plan.keys:
        if all(key in run.values for run in plan.runs):
            continue
        value = value_at(loaded.case, key_path(key))
        if isinstance(value, (int, float, str, bool)):
            found[key] = value
    return found


def finished(sweep: PlannedSweep) -> dict[str, Summary]:
    """Return existing summaries by name of the run."""
    found: dict[str, Summary] = {}
    for job in sweep.jobs:
        if job is not None and job.id not in found:
            summary = summary_in(Path(job.folder))
            if summary is not None:
                found[job.id] = summary
    return found


def summary_in(folder: Path) -> Summary | None:
    """Read the summary of a run that ended, even by failure."""
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    whole = isinstance(summary, dict) and summary.keys() >= OWN_KEYS and isinstance(summary["status"], str)
    return summary if whole and summary["status"] != "interrupted" else None


def tidy(folder: Path) -> None:
    """Remove leftovers of killed runs in the folder of runs."""
    runs = folder / RUNS
    for entry in os.scandir(runs) if runs.is_dir() else ():
        if entry.name.startswith(".") and abandoned(Path(entry.path)):
            shutil.rmtree(entry.path, ignore_errors=True)


Spread = Callable[
    [Sequence[SweepJob]], Iterator[tuple[int, Summary | WorkerDeath]]
]  # does jobs somewhere, in any order


def carried_out(sweep: PlannedSweep, known: Mapping[str, Summary], spread: Spread) -> Iterator[tuple[str, Summary]]:
    """Yield name and summary of each run as it ends; `known` ones are not repeated."""
    left = list({job.id: job for job in sweep.jobs if job is not None and job.id not in known}.values())
    for number, summary in spread(left):
        if isinstance(summary, WorkerDeath):
            summary = failure(left[number], DIED)
        yield left[number].id, summary


def failure(job: SweepJob, reason: str, trace: str | None = None) -> Summary:
    """Record a failed run in its folder, so that it is not repeated.

    Raises OutputError.
    """
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.summary import write_summary
    from dem_cli.version import __version__

    summary = {"title": "", "kind": "", "version": __version__, "status": FAILED, "reason": reason}
    summary |= {"traceback": trace} if trace else {}
    with OutputFolder(job.folder, force=True, recover=False) as folder:
        try:
            write_summary(folder.path, summary)
        except OSError as error:
            raise write_error(error, Path(job.folder)) from None
        folder.commit()
    return summary


def solved(summary: Summary) -> bool:
    """Test whether a run has an answer."""
    return not str(summary["status"]).startswith((FAILED, "not converged", WAITING))
