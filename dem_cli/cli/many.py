"""Analyses that consist of many runs: over how many threads, and what an interrupted one left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.cli.words import console
from dem_cli.cli.workers import usable_cores
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.ensembles.batch import Batch
    from dem_cli.output.folder import OutputFolder
    from dem_cli.output.journal import Journal


class Wish(NamedTuple):
    """What the user asked for."""

    threads: int | None = None  # None: all cores
    resume: bool = False


def many(case: Case) -> bool:
    """Whether the analysis of a case consists of many runs."""
    return case.analysis.kind == "fragility" or getattr(case.analysis, "repeats", 0) > 0


def check(case: Case, wish: Wish) -> None:
    """Raises UsageError where there is nothing to resume."""
    if wish.resume and not many(case):
        raise UsageError(f"--resume: analysis.kind = '{case.analysis.kind}' is one run, which starts anew")


@contextmanager
def batch_of(case: Case, text: str, folder: OutputFolder, wish: Wish, quiet: bool) -> Iterator[Batch | None]:
    """Threads and journal of the runs of a case; None where it is one run. Says what an interrupted one leaves.

    text: the effective case. Raises UsageError where an earlier journal does not fit.
    """
    if not many(case):
        yield None
        return
    from dem_cli.ensembles.batch import Batch
    from dem_cli.output.journal import Journal
    from dem_cli.sweep.identity import facts

    with Journal(folder.path.parent, folder.final.name, facts(case, text), wish.resume) as journal:
        try:
            yield Batch(wish.threads or usable_cores(), journal)
        except KeyboardInterrupt:
            left(journal, quiet)
            raise


def finish(batch: Batch, summary: dict[str, Any], quiet: bool) -> None:
    """Once the results are in place: the journal goes, or it is said that it stays."""
    from dem_cli.output.journal import Journal

    assert isinstance(batch.journal, Journal)
    if summary["status"] == "interrupted":
        left(batch.journal, quiet)
    else:
        batch.journal.remove()


def left(journal: Journal, quiet: bool) -> None:
    """What an interrupted analysis leaves."""
    if journal.count:
        console.note(f"{journal.count:,} runs are kept; go on with --resume", quiet)


def with_names(found: dict[str, Any], names: Sequence[str], quantities: Sequence[str]) -> dict[str, Any]:
    """The summary of a solver, with the peaks of repeats by the names of monitors and with units."""
    repeats = found.get("repeats")
    if not repeats or "peaks" not in repeats:
        return found
    from dem_cli.output.series import MONITOR_UNITS

    spreads = [
        spread and spread | {"unit": MONITOR_UNITS[q]} for spread, q in zip(repeats["peaks"], quantities, strict=True)
    ]
    return found | {"repeats": repeats | {"peaks": dict(zip(names, spreads, strict=True))}}
