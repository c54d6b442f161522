"""Storage of unfinished work for `--resume`: stages of one run, or finished runs of many; number of threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.results.output.resume.stages import DEFAULT_KEEPING, Keeping

if TYPE_CHECKING:
    from dem_cli.analyses.ensembles.batch import Batch
    from dem_cli.app.pipeline.listener import RunListener
    from dem_cli.app.pipeline.recorder import Recorder
    from dem_cli.case.schema import Case
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.resume.checkpoints import Checkpoints
    from dem_cli.results.output.resume.journal import Journal


class BatchOptions(NamedTuple):
    """Options of many runs: threads, resuming, and what is stored meanwhile."""

    threads: int | None = None  # of an analysis that consists of many runs, None: all cores; of a run itself, None: one
    resume: bool = False  # go on where an interrupted one stopped
    keeping: Keeping | None = DEFAULT_KEEPING  # stages of one run; None: none are stored


def usable_cores() -> int:
    """Count the cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def many(case: Case) -> bool:
    """Test whether the analysis of a case consists of many runs."""
    return case.analysis.kind == "fragility" or getattr(case.analysis, "repeats", 0) > 0


@contextmanager
def batch_of(
    case: Case, text: str, folder: OutputFolder, options: BatchOptions, listener: RunListener
) -> Iterator[Batch | None]:
    """Yield threads and journal of the runs of a case; None where it is one run. Reports what an interrupt leaves.

    text: the effective case. Raises UsageError where an earlier journal does not fit.
    """
    if not many(case):
        yield None
        return
    from dem_cli.analyses.ensembles.batch import Batch, ShakenRunResult, ShakingTrial
    from dem_cli.app.sweep.identity import facts
    from dem_cli.results.output.resume.journal import Journal

    what, of = facts(case, text), (ShakingTrial, ShakenRunResult)
    with Journal(folder.path.parent, folder.final.name, what, options.resume, of) as journal:
        try:
            with _sound(journal.path, lambda: bool(journal.known())):
                yield Batch(options.threads or usable_cores(), journal)
        except KeyboardInterrupt:
            left(journal, listener)
            raise


@contextmanager
def stages_of(
    case: Case, text: str, folder: OutputFolder, options: BatchOptions, recorder: Recorder
) -> Iterator[Checkpoints | None]:
    """Let the recorder store the stages of a run; yields None where nothing is stored.

    Arguments and errors as `batch_of`.
    """
    if options.keeping is None or case.analysis.kind == "fragility":  # all of its runs are in the journal
        yield None
        return
    from dem_cli.app.sweep.identity import facts
    from dem_cli.results.output.resume.checkpoints import Checkpoints
    from dem_cli.results.output.resume.stages import KeptStages

    what = cache(lambda: facts(case, text))
    checkpoints = Checkpoints(folder.path.parent, folder.final.name, what, options.resume)
    try:
        stages = KeptStages(checkpoints, recorder.tell_again, options.keeping)
        recorder.keep(stages)
        with _sound(checkpoints.path, lambda: stages.went_on):
            yield checkpoints
    except KeyboardInterrupt:
        stages_left(checkpoints, recorder.listener)
        raise
    finally:
        checkpoints.close()


@contextmanager
def _sound(path: Path, went_on: Callable[[], bool]) -> Iterator[None]:
    """Add to the error of a resumed run that the stored work may be at fault."""
    from dem_cli.errors import DemError
    from dem_cli.results.output.resume.leftovers import damaged

    try:
        yield
    except DemError:
        raise
    except Exception as error:
        if not went_on():
            raise
        lines = str(error).splitlines() or [""]
        raise damaged(path, f"a run that went on from it failed: {type(error).__name__}: {lines[0]}") from error


def finish(batch: Batch, summary: dict[str, Any], listener: RunListener) -> None:
    """Remove the journal once the results are in place, or report that it stays."""
    from dem_cli.results.output.resume.journal import Journal

    assert isinstance(batch.journal, Journal)
    if summary["status"] == "interrupted":
        left(batch.journal, listener)
    else:
        batch.journal.remove()


def finish_stages(checkpoints: Checkpoints, summary: dict[str, Any], listener: RunListener) -> None:
    """Remove the checkpoints once the results are in place, or report that they stay."""
    if summary["status"] == "interrupted":
        stages_left(checkpoints, listener)
    else:
        checkpoints.remove()


def stages_left(checkpoints: Checkpoints, listener: RunListener) -> None:
    """Report the stored work of an interrupted run."""
    if checkpoints.found:
        listener.stages_kept(checkpoints.seconds)


def left(journal: Journal, listener: RunListener) -> None:
    """Report the finished runs of an interrupted analysis."""
    if journal.count:
        listener.runs_kept(journal.count)
