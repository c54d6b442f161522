"""Verify all cases with a known answer against it: `dem verify`."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dem_cli.app.cli.words import console
from dem_cli.app.cli.words.numbers import seconds
from dem_cli.errors import UsageError
from dem_cli.interrupts import Interrupts
from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.app.verify.predictions import PredictionRun
    from dem_cli.app.verify.records import Record

PAGE = Path("docs/verification.md")
SHELF = click.Choice(["verification", "bounds", "validation", "cross-code", "inference", "blind"])


@click.command("verify", short_help="Run all cases with a [reference] and compare.")
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path), metavar="[PATH]...")
@click.option("-k", "--match", "pattern", default="", metavar="TEXT",
              help="Only files with this in their path; * and ? are wildcards.")  # fmt: skip
@click.option(
    "--shelf",
    "shelves",
    multiple=True,
    type=SHELF,
    help="Only exact references, experiments, codes, or arithmetic of inference.",
)
@click.option("--at-most", type=click.FloatRange(min=0.0), metavar="SECONDS",
              help="Leave out cases that took longer when docs/verification.md was written.")  # fmt: skip
@click.option("--changed", is_flag=True, help="Only cases that changed since docs/verification.md was written.")
@click.option("-j", "--jobs", type=click.IntRange(min=1), metavar="N", help="Processes; default: all cores.")
@click.option("--write", type=click.Path(path_type=Path), metavar="PAGE",
              help="Write the page, such as docs/verification.md, and its JSON in data/ beside it.")  # fmt: skip
@click.option("--junit", "junit_file", type=click.Path(path_type=Path), metavar="FILE", help="Write JUnit XML.")
@click.option("--predict", is_flag=True, help="Predict blind cases and write the predictions into their files, once.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no remarks.")
def command(
    paths: Sequence[Path],
    pattern: str,
    shelves: Sequence[str],
    at_most: float | None,
    changed: bool,
    jobs: int | None,
    write: Path | None,
    junit_file: Path | None,
    predict: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Run every case in PATHs (files or folders; default: cases) that has a [reference], and compare.

    Exit code: 0 all as the cases say, 1 some are not, 2 wrong arguments or a wrong case file (the others are run).
    """
    from dem_cli.app.verify.case_selection import find
    from dem_cli.app.verify.records import data_file, digest, load, on_shelves

    began = time.perf_counter()
    if predict:
        given = {"--write": write, "--junit": junit_file, "--changed": changed, "--json": as_json, "--shelf": shelves}
        for name in (name for name, value in given.items() if value):
            raise UsageError(f"{name} is not allowed with --predict, which writes into the case files alone")
        predict_all(find(paths or [Path("cases")], pattern, ["blind"]).cases, jobs, quiet)
        return 0
    found = find(paths or [Path("cases")], pattern, shelves)
    page = write or PAGE
    before = load(data_file(page))
    costs = {record["case"]: record["seconds"] for record in before}
    cases, slow = split(found.cases, costs, at_most)
    if changed:
        told = {record["case"]: record["sha256"] for record in before}
        cases = [case for case in cases if told.get(known_as(case)) != digest(case)]
    if not cases and changed and found.cases:
        console.note("nothing changed since the page was written", quiet)
        return 0
    if not cases:
        raise UsageError(f"no case with a [reference]{nothing(len(found.without), len(slow), pattern, shelves)}")
    if write and shelves:
        raise UsageError("--write needs all references of a case; leave out --shelf")
    remarks = left_out(len(found.without), slow)
    with Interrupts():
        found_records = sorted(run_all(cases, costs, jobs, quiet), key=lambda record: record["case"])
    records = on_shelves(found_records, shelves)
    show(records, time.perf_counter() - began, as_json)  # before anything that a full disk can stop
    if write:
        write_page(write, records)
        remarks.append(f"written: {write}, {data_file(write)}")
    if junit_file:
        from dem_cli.app.verify.junit import junit

        put(junit_file, junit(records))
    for remark in remarks:
        console.note(remark, quiet)
    return code_of(records)


def split(cases: Sequence[Path], costs: dict[str, float], at_most: float | None) -> tuple[list[Path], list[Path]]:
    """Split cases into those to run, and those known to take longer."""
    slow = [] if at_most is None else [case for case in cases if costs.get(known_as(case), 0.0) > at_most]
    return [case for case in cases if case not in slow], slow


def known_as(case: Path) -> str:
    """Return the name of a case in records: its relative path."""
    from dem_cli.app.verify.records import moved

    return moved(case.as_posix(), Path(), Path())


def nothing(without: int, slow: int, pattern: str, shelves: Sequence[str]) -> str:
    """Describe why there is nothing to do."""
    why = [f"{without} {'has' if without == 1 else 'have'} none"] if without else []
    why += [f"{slow} take longer"] if slow else []
    why += [f"none matches '{pattern}'"] if pattern and not why else []
    why += [f"on the shelf {' or '.join(shelves)}"] if shelves and not why else []
    return f" ({', '.join(why)})" if why else ""


def left_out(without: int, slow: Sequence[Path]) -> list[str]:
    """Describe the cases that were not run, a line each."""
    lines = [f"left out: {many(without, 'case')} without [reference]"] if without else []
    return lines + ([f"left out as too long: {', '.join(case.stem for case in slow)}"] if slow else [])


def run_all(cases: Sequence[Path], costs: dict[str, float], jobs: int | None, quiet: bool) -> Iterator[Record]:
    """Yield the records of all cases as they finish, the longest first."""
    from dem_cli.app.cli.words.run_counter import RunCounter
    from dem_cli.app.pipeline.batches import usable_cores
    from dem_cli.app.sweep.pool import WorkerDeath, each_done
    from dem_cli.app.verify.case_selection import longest_first
    from dem_cli.app.verify.records import failed
    from dem_cli.core.kernels.compilation.cache_folder import cache_is_cold

    order = longest_first(cases, lambda case: costs.get(known_as(case)))
    with RunCounter(len(order), quiet=quiet) as count:
        for number, record in each_done(verified, order, jobs or usable_cores(), first_alone=cache_is_cold()):
            if isinstance(record, WorkerDeath):
                record = failed(order[number], "the process of this run died, perhaps for want of memory", bad=False)
            count.update("error" in record or any(a["state"] in ("failed", "met") for a in record["references"]))
            yield {**record, "case": known_as(order[number])}


def verified(path: Path) -> Record:
    """Solve and compare one case, in any process. Raises KeyboardInterrupt where it is stopped."""
    from dem_cli.app import api
    from dem_cli.app.pipeline.jobs import solve_one
    from dem_cli.app.verify.blind import refusal
    from dem_cli.app.verify.records import failed, record
    from dem_cli.errors import DemError

    try:
        case = api.load_case(path).case
        refused = refusal(path, case)
        if refused:
            return failed(path, refused, bad=True)
        summary = solve_one(path)
    except DemError as error:
        return failed(path, str(error), bad=error.exit_code == UsageError.exit_code)
    except Exception as error:  # a fault of the program in one case does not stop the others
        return failed(path, f"internal error: {type(error).__name__}: {error}", bad=False)
    if summary["status"] == "interrupted":
        raise KeyboardInterrupt
    if summary["status"] == "failed":
        return failed(path, summary["reason"], bad=summary["exit_code"] == UsageError.exit_code)
    return record(path, case.title, summary, case, summary.get("solve_seconds") or 0.0)


def predict_all(paths: Sequence[Path], jobs: int | None, quiet: bool) -> None:
    """Predict blind cases and append the predictions to their files. Raises DemError before anything is written.

    A case that has a prediction is refused, and so is every other one named beside it.
    """
    from dem_cli.app import api
    from dem_cli.app.verify.predictions import runs_of, text_of_predictions

    cases = {path: api.load_case(path).case for path in paths}
    blind = {path: case for path, case in cases.items() if case.blind}
    if not blind:
        raise UsageError("no case with a [reference] of kind 'blind'")
    for path, case in blind.items():
        if case.prediction:
            said = f"was predicted on {case.prediction[0].date} with dem {case.prediction[0].version}"
            raise UsageError(f"{path}: {said}; a prediction stays: name cases that have none")
    runs = [run for path, case in blind.items() for run in runs_of(path, case)]
    with Interrupts():
        summaries = predicted_runs(runs, jobs, quiet)
    texts = {}
    for path, case in blind.items():
        own = [summary for run, summary in zip(runs, summaries, strict=True) if run.path == path]
        texts[path] = text_of_predictions(path, case, own)
    for path, text in texts.items():
        put(path, path.read_text(encoding="utf-8").rstrip("\n") + "\n\n" + text)
        console.show(f"{path}: {many(text.count('[[prediction]]'), 'prediction')} written")


def predicted_runs(runs: Sequence[PredictionRun], jobs: int | None, quiet: bool) -> list[dict[str, Any]]:
    """Solve the runs of predictions, several at a time; their summaries. Raises UsageError, SolverError."""
    from dem_cli.app.cli.words.run_counter import RunCounter
    from dem_cli.app.pipeline.batches import usable_cores
    from dem_cli.app.sweep.pool import WorkerDeath, each_done
    from dem_cli.core.kernels.compilation.cache_folder import cache_is_cold
    from dem_cli.errors import SolverError

    found: dict[int, Any] = {}
    with RunCounter(len(runs), quiet=quiet) as count:
        for number, summary in each_done(predicted, runs, jobs or usable_cores(), first_alone=cache_is_cold()):
            name = runs[number].name
            if isinstance(summary, WorkerDeath):
                raise SolverError(f"{name}: the process of this run died, perhaps for want of memory")
            if summary["status"] == "failed":
                wrong = UsageError if summary["exit_code"] == UsageError.exit_code else SolverError
                raise wrong(f"{name}: {summary['reason']}")
            found[number] = summary
            count.update()
    return [found[number] for number in range(len(runs))]


def predicted(run: PredictionRun) -> dict[str, Any]:
    """Solve one run of a prediction, in any process. Raises KeyboardInterrupt where it is stopped."""
    from dem_cli.app.pipeline.jobs import solve_one
    from dem_cli.case.overrides import override_of

    summary = solve_one(run.path, [override_of(key, value) for key, value in run.changes.items()])
    if summary["status"] == "interrupted":
        raise KeyboardInterrupt
    return summary


def write_page(page: Path, records: list[Record]) -> None:
    """Write the page and its JSON: new records, and earlier ones of other cases."""
    from dem_cli.app.verify.page import page as text
    from dem_cli.app.verify.records import data_file, dump, load, merged

    kept = dump(merged(load(data_file(page)), records), page, __version__)
    put(data_file(page), kept)
    put(page, text(json.loads(kept)["cases"], __version__))


def put(file: Path, text: str) -> None:
    """Write a file atomically. Raises OutputError."""
    from dem_cli.results.output.atomic_file import write_text
    from dem_cli.results.output.folder import write_error

    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise write_error(error, file) from None
    write_text(file, text)


def code_of(records: Sequence[Record]) -> int:
    """Return the overall exit code."""
    from dem_cli.app.verify.records import all_well

    return UsageError.exit_code if any(record.get("bad") for record in records) else 0 if all_well(records) else 1


def show(records: Sequence[Record], took: float, as_json: bool) -> None:
    """Print the answer on stdout; references of kind "inference" are counted separately."""
    from dem_cli.app.verify.records import apart, counts

    others, of_inference = apart(records)
    found = counts(records)
    if as_json:
        found |= {key: number for key, number in counts(others).items() if key not in ("cases", "not solved")}
        found |= {"inference": counts(of_inference)["references"]} if of_inference else {}
        answer: dict[str, Any] = {"version": __version__, "counts": found, "wall_seconds": took, "cases": records}
        console.show(json.dumps(answer, indent=2, ensure_ascii=False))
        return
    from dem_cli.app.cli.words.verify_table import show_tables

    show_tables(records)
    besides = f"; besides, of inference: {in_words(of_inference)}" if of_inference else ""
    unsolved = f"; {many(found['not solved'], 'case')} NOT SOLVED" if found["not solved"] else ""
    console.show(f"{many(found['cases'], 'case')}, {in_words(others)}{besides}{unsolved}; {seconds(took)}")


def in_words(records: Sequence[Record]) -> str:
    """Describe the number of references in each state."""
    from dem_cli.app.verify.records import counts

    found = counts(records)
    states = {"passed": found["passed"], "missed, as known": found["missed"]}
    states |= {"predicted": found.get("predicted", 0), "outside their bands": found.get("outside", 0)}
    states |= {"FAILED": found["failed"] + found["met"]}
    listed = ", ".join(f"{number} {name}" for name, number in states.items() if number or name == "passed")
    return f"{many(found['references'], 'reference')}: {listed}"


def many(number: int, noun: str) -> str:
    """Format a count with its noun: `1 case`, `2 cases`."""
    return f"{number} {noun}{'s' * (number != 1)}"
