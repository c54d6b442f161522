"""Analyses that consist of many runs: over how many threads, and what an interrupted one left to resume."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.ensembles.batch import Batch
    from dem_cli.output.folder import OutputFolder
    from dem_cli.output.journal import Journal
    from dem_cli.pipeline.listener import RunListener


class BatchOptions(NamedTuple):
    """How many runs are done; not used by an analysis that is one run."""

    threads: int | None = None  # None: all cores
    resume: bool = False  # go on where an interrupted one stopped


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def many(case: Case) -> bool:
    """Whether the analysis of a case consists of many runs."""
    return case.analysis.kind == "fragility" or getattr(case.analysis, "repeats", 0) > 0


def check(case: Case, options: BatchOptions) -> None:
    """Raises UsageError where there is nothing to resume."""
    if options.resume and not many(case):
        raise UsageError(f"--resume: analysis.kind = '{case.analysis.kind}' is one run, which starts anew")


@contextmanager
def batch_of(
    case: Case, text: str, folder: OutputFolder, options: BatchOptions, listener: RunListener
) -> Iterator[Batch | None]:
    """Threads and journal of the runs of a case; None where it is one run. Says what an interrupted one leaves.

    text: the effective case. Raises UsageError where an earlier journal does not fit.
    """
    if not many(case):
        yield None
        return
    from dem_cli.ensembles.batch import Batch
    from dem_cli.output.journal import Journal
    from dem_cli.sweep.identity import facts

    with Journal(folder.path.parent, folder.final.name, facts(case, text), options.resume) as journal:
        try:
            yield Batch(options.threads or usable_cores(), journal)
        except KeyboardInterrupt:
            left(journal, listener)
            raise


def finish(batch: Batch, summary: dict[str, Any], listener: RunListener) -> None:
    """Once the results are in place: the journal goes, or it is said that it stays."""
    from dem_cli.output.journal import Journal

    assert isinstance(batch.journal, Journal)
    if summary["status"] == "interrupted":
        left(batch.journal, listener)
    else:
        batch.journal.remove()


def left(journal: Journal, listener: RunListener) -> None:
    """What an interrupted analysis leaves."""
    if journal.count:
        listener.runs_kept(journal.count)
