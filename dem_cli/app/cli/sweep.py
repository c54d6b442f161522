"""Solve a case for all values of its [sweep] in parallel, with one table of the answers: `dem sweep`."""

from __future__ import annotations

import json
import re
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dem_cli.app.cli.options import case_argument, load, overrides_option
from dem_cli.app.cli.words import console
from dem_cli.app.cli.words.run_counter import RunCounter
from dem_cli.errors import CaseError, CaseProblem, UsageError
from dem_cli.interrupts import Interrupts
from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.app.sweep.plan import SweepPlan
    from dem_cli.app.sweep.run import PlannedSweep, Spread, Summary, SweepJob
    from dem_cli.case.reader import LoadedCase

TABLE_EVERY = 15.0  # s between two states of sweep.csv while runs go on
MOST_FAILURES = 8  # failed runs that are shown
LONGEST_VALUE = 40  # letters of a value
SHARD = re.compile(r"([1-9]\d*)/([1-9]\d*)")


@click.command("sweep")
@case_argument
@overrides_option
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Default: results/NAME_sweep.")
@click.option("-j", "--jobs", type=click.IntRange(min=1), metavar="N", help="Processes; default: all cores.")
@click.option("--scheduler", metavar="ADDRESS", help="Run on a Dask cluster, such as tls://host:8786.")
@click.option("--shard", metavar="I/N", help="Only every N-th run, from the I-th: for job arrays that share DIR.")
@click.option("--keep", type=click.Choice(["summary", "all"]), default="summary", show_default=True,
              help="summary: no snapshots, no following of the collapse; all: as the case says.")  # fmt: skip
@click.option("--retry", is_flag=True, help="Do runs that failed before once more.")
@click.option("--fresh", is_flag=True, help="Throw away the runs that are there, instead of going on with them.")
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
@click.option("--dry-run", is_flag=True, help="Print the runs as CSV; do none.")
@click.option("--json", "as_json", is_flag=True, help="Print the outcome as one JSON object.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no remarks.")
def command(
    case: str,
    overrides: Sequence[str],
    output: Path | None,
    jobs: int | None,
    scheduler: str | None,
    shard: str | None,
    keep: str,
    retry: bool,
    fresh: bool,
    force: bool,
    dry_run: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Solve CASE once for every combination of values in its [sweep].

    Every run gets a folder in DIR/runs; DIR/sweep.csv and DIR/sweep.sqlite have a row for each. The same command goes
    on where an interrupted or killed one stopped. Exit code: 0 all solved, 1 some failed; a run that does not stand is
    solved, and counted.
    """
    from dem_cli.app.sweep.folder import opened
    from dem_cli.app.sweep.run import prepared

    started = time.perf_counter()
    part = sharded(shard)
    if fresh and shard:
        raise UsageError("--fresh with --shard would throw away the runs of the other shards; give another DIR with -o")
    loaded = load(case, overrides)
    plan = planned(loaded)
    folder = output or Path("results") / f"{loaded.name}_sweep"
    sweep = prepared(loaded, plan, folder.resolve(), loaded.overrides, light=keep == "summary")
    if dry_run:
        print_plan(sweep)
        return 0
    with opened(folder, fresh, force, (shard and f"-{part[0] + 1}of{part[1]}") or ""):
        run = SweepProgress(loaded, sweep, folder, part, quiet)
        found = run.all(partial(spread, scheduler, jobs, folder.resolve()), retry)
    found["wall_seconds"] = time.perf_counter() - started
    console.show(json.dumps(found, indent=2, ensure_ascii=False) if as_json else told(found, folder))
    return 1 if found["failed"] else 0


def planned(loaded: LoadedCase) -> SweepPlan:
    """Plan the runs of a case. Raises CaseError, with file and line."""
    from dem_cli.app.sweep.plan import plan_of

    if loaded.case.sweep is None:
        message = f'{loaded.path}: has no [sweep], such as "joints.dry.friction" = [0.5, 0.6, 0.7]'
        raise CaseError([CaseProblem((), message)])
    with loaded.located():
        return plan_of(loaded.case.sweep, loaded.case.seed)


def sharded(text: str | None) -> tuple[int, int]:
    """Parse a shard: `2/8` -> (1, 8), every eighth run from the second on."""
    if text is None:
        return 0, 1
    match = SHARD.fullmatch(text)
    if not match or int(match[1]) > int(match[2]):
        raise UsageError(f"--shard {text}: must be I/N with I from 1 to N, such as 2/8")
    return int(match[1]) - 1, int(match[2])


def print_plan(sweep: PlannedSweep) -> None:
    """Print the table without answers."""
    import csv
    import sys

    from dem_cli.app.sweep.plan import show_value
    from dem_cli.results.output.csv_cells import cell

    def told(value: Any) -> Any:
        return cell(value) if isinstance(value, str) else show_value(value)

    names = ["run", *sweep.plan.keys]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(map(cell, names))
    for run, job in zip(sweep.plan.runs, sweep.jobs, strict=True):
        values = sweep.base | run.values
        writer.writerow([job.id if job else "", *("" if k not in values else told(values[k]) for k in names[1:])])


def spread(
    scheduler: str | None, processes: int | None, folder: Path, jobs: Sequence[SweepJob]
) -> Iterator[tuple[int, Any]]:
    """Run jobs on a cluster, or in processes of this machine."""
    from dem_cli.app.pipeline.jobs import do_job

    if scheduler is not None:
        from dem_cli.app.sweep.cluster import connected, doubt, on_cluster

        if line := doubt(scheduler):
            click.echo(f"warning: {line}", err=True)
        with connected(scheduler, folder) as client:
            yield from on_cluster(client, do_job, jobs)
        return
    from dem_cli.app.pipeline.batches import usable_cores
    from dem_cli.app.sweep.pool import each_done
    from dem_cli.core.kernels.compilation.cache_folder import cache_is_cold

    yield from each_done(do_job, jobs, processes or usable_cores(), first_alone=cache_is_cold())


class SweepProgress:
    """Sweep in progress: known runs, and what the user is shown meanwhile."""

    def __init__(self, loaded: LoadedCase, sweep: PlannedSweep, folder: Path, part: tuple[int, int], quiet: bool):
        self.loaded, self.sweep, self.folder, self.quiet = loaded, sweep, folder, quiet
        self.part = part
        self.known: dict[str, Summary] = {}

    def all(self, do: Spread, retry: bool) -> dict[str, Any]:
        """Do every missing run, then write the tables; an interrupt keeps what is done."""
        from dem_cli.app.sweep.folder import tables_alone
        from dem_cli.app.sweep.run import finished, solved, tidy

        first, step = self.part
        mine = self.sweep._replace(jobs=self.sweep.jobs[first::step])
        self.facts("running")
        tidy(self.folder)
        before = finished(self.sweep)
        self.known = {name: summary for name, summary in before.items() if solved(summary) or not retry}
        wanted = {job.id for job in mine.jobs if job is not None}
        there = len(wanted & self.known.keys())
        rest = "; the others are done now" if there < len(wanted) else ""
        console.note(f"{there:,} of {len(wanted):,} runs are there already{rest}", self.quiet or not there)
        with Interrupts():
            try:
                self.work(mine, do, wanted)
            except KeyboardInterrupt:
                tidy(self.folder)
                console.note(f"{len(self.known):,} runs are kept; the same command goes on from there", self.quiet)
                raise
            finally:
                with tables_alone(self.folder):
                    if len(self.known) < self.count:  # others' runs, as far as they are
                        self.known = finished(self.sweep) | self.known
                    found = self.write()
        return found

    @property
    def count(self) -> int:
        """Number of different runs of the whole sweep."""
        return len({job.id for job in self.sweep.jobs if job is not None})

    def work(self, mine: PlannedSweep, do: Spread, wanted: set[str]) -> None:
        """Do the remaining runs, with progress and an intermediate table."""
        from dem_cli.app.sweep.run import carried_out, solved
        from dem_cli.app.sweep.table import columns, rows, write_csv

        due = time.monotonic() + TABLE_EVERY
        with RunCounter(len(wanted), len(wanted & self.known.keys()), self.quiet) as bar:
            for name, summary in carried_out(mine, self.known, do):
                self.known[name] = summary
                bar.update(failed=not solved(summary))
                if time.monotonic() > due:
                    begun = time.monotonic()
                    table = rows(self.sweep, self.known)
                    write_csv(self.folder, table, columns(table, self.sweep.plan.keys))
                    due = time.monotonic() + max(TABLE_EVERY, 20.0 * (time.monotonic() - begun))

    def write(self) -> dict[str, Any]:
        """Write the tables and sweep.json; returns the outcome."""
        from dem_cli.app.sweep.run import FAILED, WAITING
        from dem_cli.app.sweep.table import rows, write
        from dem_cli.core.records.statuses import FALLS

        table = rows(self.sweep, self.known)
        write(self.folder, table, self.sweep.plan.keys)
        states = Counter(row["status"] for row in table)
        failed = [row for row in table if row["status"] in (FAILED, "not converged")]
        found = {
            "title": self.loaded.case.title,
            "keys": list(self.sweep.plan.keys),
            "runs": len(table),
            "different": self.count,
            "solved": len(table) - len(failed) - states[WAITING],
            "do not stand": states[FALLS],
            "failed": len(failed),
            "waiting": states[WAITING],
            "warned": sum(bool(row.get("warnings")) for row in table),
        }
        self.facts("waiting" if states[WAITING] else "done", found)
        first = next((row for row in table if row.get("warnings")), None)
        return found | {
            "failures": [self.failure(row) for row in failed],
            "first_warning": first and f"{first['run']}: {str(first['warnings']).partition(' | ')[0]}",
        }

    def failure(self, row: dict[str, Any]) -> dict[str, Any]:
        """Describe a failed run by its name, swept values and reason."""
        return {"run": row["run"], **{key: row[key] for key in self.sweep.plan.keys}, "reason": row["reason"]}

    def facts(self, status: str, found: dict[str, Any] | None = None) -> None:
        """Write sweep.json and the case, with changes of the command line."""
        from dem_cli.app.sweep.folder import write_facts
        from dem_cli.results.output.atomic_file import write_text
        from dem_cli.results.output.store import CASE

        text = self.loaded.text if self.loaded.text.endswith("\n") else self.loaded.text + "\n"
        changes = "".join(f"# --set {o.text}={o.value!r}\n" for o in self.loaded.overrides)
        write_text(self.folder / CASE, changes + text)
        write_facts(self.folder, {"kind": "sweep", "version": __version__, "status": status} | (found or {}))


def brief(value: Any) -> str:
    """Format a value briefly."""
    from dem_cli.app.sweep.plan import show_value

    text = f"{value:.6g}" if isinstance(value, float) else show_value(value)
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 1] + "…"


def told(found: dict[str, Any], folder: Path) -> str:
    """Format the outcome of a sweep."""
    from dem_cli.app.cli.run import shown

    lines = [found["title"] or "sweep"]
    fallen = f" ({found['do not stand']:,} of them do not stand)" if found["do not stand"] else ""
    lines.append(f"  runs      {found['runs']:,}: {found['solved']:,} solved{fallen}, {found['failed']:,} failed"
                 + (f", {found['waiting']:,} not done yet" if found["waiting"] else ""))  # fmt: skip
    for row in found["failures"][:MOST_FAILURES]:
        values = ", ".join(f"{key} = {brief(row[key])}" for key in found["keys"])
        lines.append(f"  failed    {row['run']} ({values}): {row['reason']}")
    if found["failed"] > MOST_FAILURES:
        lines.append(f"            and {found['failed'] - MOST_FAILURES:,} more in sweep.csv")
    if found["warned"]:
        lines.append(f"  warned    {found['warned']:,} (column 'warnings'), such as {found['first_warning']}")
    where = shown(folder.resolve())
    lines.append(f"  results   {where}/sweep.csv, sweep.sqlite, runs/ ({console.seconds(found['wall_seconds'])})")
    return "\n".join(lines)
