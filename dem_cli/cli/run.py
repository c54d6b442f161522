"""`dem run`: validate, build, solve, write; print the failure load and how sure it is."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import click

from dem_cli import __version__
from dem_cli.cli.interrupt import Interrupts
from dem_cli.cli.many import Wish, batch_of, check, finish, with_names
from dem_cli.cli.options import case_argument, overrides_option
from dem_cli.cli.words import console
from dem_cli.cli.words.reference import check_quantities
from dem_cli.errors import CaseProblem, DemError, SolverError

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase
    from dem_cli.case.schema import Case, Monitor
    from dem_cli.ensembles.batch import Batch
    from dem_cli.model.model import Model
    from dem_cli.output.folder import OutputFolder
    from dem_cli.output.record import Frame, HistoryRow, Observer, RunRow, Samples
    from dem_cli.output.store import ResultWriter


class Outcome(Protocol):
    """What a solver returns."""

    summary: dict[str, Any]


# What a run that was stopped does not know, by kind.
ANSWERS = {
    "pushover": ("failure_load", "failure_load_bracket", "failure_mode", "displacement_at_failure"),
    "time-history": ("collapsed", "collapse_time"),
    "safety": ("safety_factor", "safety_factor_bracket", "critical_value", "critical_value_bracket"),
    "fragility": ("median", "dispersion", "collapse_intensities"),
}

ONE_OF_MANY = "not used here: one case is solved, as written above; `dem sweep` runs all of them"
Solve = Callable[["Case", "Model", "Observer"], Outcome]


class Recorder:
    """The observer of a run: keeps what comes, says where it stands, lets nothing interrupt a write."""

    def __init__(self, writer: ResultWriter, progress: console.Progress, interrupts: Interrupts):
        self.writer, self.bar, self.interrupts = writer, progress, interrupts

    def frame(self, frame: Frame) -> None:
        with self.interrupts.shielded():
            self.writer.frame(frame)

    def row(self, row: HistoryRow) -> None:
        with self.interrupts.shielded():
            self.writer.row(row)

    def samples(self, samples: Samples) -> None:
        with self.interrupts.shielded():
            self.writer.samples(samples)

    def structure(self, model: Model) -> None:
        with self.interrupts.shielded():
            self.writer.structure(model)

    def runs(self, rows: Sequence[RunRow]) -> None:
        with self.interrupts.shielded():
            self.writer.runs(rows)

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        self.bar.update(stage, load, displacement, fraction)


@click.command("run")
@case_argument
@overrides_option
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Default: results/NAME.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no remarks.")
@click.option("-v", "--verbose", is_flag=True, help="Say what was skipped because the case does not need it.")
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
@click.option(
    "-j",
    "--threads",
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Runs side by side, of analyses that consist of many; default: all cores.",
)
@click.option("--resume", is_flag=True, help="Go on where an interrupted analysis of many runs stopped.")
@click.option("--plot/--no-plot", default=False, help="Draw the pictures of `dem plot` as well.")
def command(
    case: str,
    overrides: Sequence[str],
    output: Path | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    force: bool,
    threads: int | None,
    resume: bool,
    plot: bool,
) -> int:
    """Solve CASE and write its results to DIR."""
    from dem_cli import api
    from dem_cli.output.summary import exit_code, to_json

    started = time.perf_counter()
    loaded = api.load_case(case, overrides)
    if loaded.case.sweep is not None:
        loaded.warnings.append(loaded.render(CaseProblem(("sweep",), ONE_OF_MANY)))
    wish = Wish(threads, resume)
    check(loaded.case, wish)
    model = api.build_model(loaded)
    summary, folder = execute(
        loaded,
        model,
        output or Path("results") / loaded.path.stem,
        started,
        force=force,
        quiet=quiet,
        plot=plot,
        wish=wish,
    )
    if as_json:
        console.show(to_json(summary).rstrip())
    else:
        console.show(console.answer(summary, shown(folder), file_names(folder), verbose))
    return exit_code(summary)


def execute(
    loaded: LoadedCase,
    model: Model,
    output: Path,
    started: float,
    *,
    force: bool = False,
    quiet: bool = False,
    plot: bool = False,
    solve: Solve | None = None,
    wish: Wish | None = None,
    recover: bool = True,
) -> tuple[dict[str, Any], Path]:
    """Solve and write; returns the summary and where the results are. Nothing is left where it fails."""
    from dem_cli.case.writer import case_text
    from dem_cli.output.folder import OutputFolder
    from dem_cli.output.provenance import provenance
    from dem_cli.output.store import ResultWriter

    case, names = loaded.case, monitor_names(loaded.case.monitor)
    with loaded.located():
        check_quantities(case, names)
    with Interrupts() as interrupts, OutputFolder(output, force=force, recover=recover) as folder:
        with interrupts.shielded():
            text, kind = case_text(case), case.analysis.kind
            quantities = [("absolute " if m.absolute else "") + m.quantity for m in case.monitor]
            writer = ResultWriter(folder.path, model, text, provenance(), names, kind, output, quantities)
        with (
            abandoning(writer),
            loaded.located(),
            batch_of(case, text, folder, wish or Wish(), quiet) as batch,
            console.Progress(quiet) as bar,
        ):
            recorder = Recorder(writer, bar, interrupts)
            found = solved(solve or load_solver(batch), case, model, recorder)
            interrupts.ignore()
            bar.stop()
            if batch is not None:
                found = with_names(found, names, quantities)
            summary = completed(found | writer.measured(found), loaded, model, started)
            writer.close(summary)
            if plot:
                draw(folder.path, quiet)
            place = put_in_place(folder, summary, quiet)
            if batch is not None:
                finish(batch, summary, quiet)
            return summary, place


def load_solver(batch: Batch | None) -> Solve:
    """The solver, imported only when a case is ready to be solved."""
    from dem_cli.analyses.solve import solve

    return solve if batch is None else partial(solve, batch=batch)


def solved(solve: Solve, case: Case, model: Model, recorder: Recorder) -> dict[str, Any]:
    """The solver's summary; where it was interrupted or gave up, how far it came."""
    writer = recorder.writer
    try:
        return solve(case, model, recorder).summary
    except KeyboardInterrupt:
        if writer.last_row is None and writer.last_frame is None:
            raise
        return stopped("interrupted", writer, ["interrupted: the results end at the state in 'reached'"])
    except SolverError as error:
        return stopped("not converged", writer, [str(error)])


def stopped(status: str, writer: ResultWriter, warnings: list[str]) -> dict[str, Any]:
    """Summary of a run that did not reach its end."""
    last = writer.last_row or writer.last_frame
    reached = last and {"stage": last.stage, "load": last.load, "displacement": last.displacement}
    if last and writer.kind == "time-history":
        reached = {"stage": last.stage, "time": last.time, "displacement": last.displacement}
    points = writer.last_frame.contacts.joint if writer.last_frame else None
    unknown = ANSWERS.get(writer.kind, ANSWERS["pushover"])
    return {
        "status": status,
        **dict.fromkeys(unknown),
        "reached": reached,
        "joints": None if points is None else len(set(points.tolist())),
        "contacts": None if points is None else len(points),
        "steps": last.step if last else 0,
        "time_step": None,
        "solve_seconds": None,
        "energy_closure": None,
        "warnings": warnings,
    }


def completed(found: dict[str, Any], loaded: LoadedCase, model: Model, started: float) -> dict[str, Any]:
    """The solver's summary with everything that is not the solver's."""
    from dem_cli.output.reference import in_summary, verdicts
    from dem_cli.output.summary import ordered

    case = loaded.case
    summary = dict(found)
    summary |= {"title": case.title or loaded.path.stem, "kind": case.analysis.kind, "version": __version__}
    summary["blocks"] = model.n_blocks
    summary["warnings"] = [*loaded.warnings, *found.get("warnings", ())]
    if case.reference and found["status"] != "interrupted":
        summary["reference"] = in_summary(verdicts(summary, case.reference))
    summary["wall_seconds"] = time.perf_counter() - started
    return ordered(summary)


@contextmanager
def abandoning(writer: ResultWriter):  # type: ignore[no-untyped-def]
    """Close the files of a run that ends without results."""
    try:
        yield
    finally:
        writer.abandon()


def draw(folder: Path, quiet: bool) -> None:
    """Pictures are welcome, not needed: what goes wrong with them is only said."""
    try:
        from dem_cli.post.run_pictures import draw_all

        draw_all(folder, folder)
    except (DemError, OSError) as error:
        console.note(f"no pictures: {error}", quiet)
    except Exception as error:  # a fault of the program in a picture does not cost hours of solving
        console.note(f"no pictures: internal error: {type(error).__name__}: {error}", quiet)


def put_in_place(folder: OutputFolder, summary: dict[str, Any], quiet: bool) -> Path:
    """Commit; an interrupted run goes beside earlier complete results, not over them."""
    from dem_cli.output.folder import INTERRUPTED_SUFFIX, is_complete

    if summary["status"] != "interrupted" or not is_complete(folder.final):
        return folder.commit()
    place = folder.commit(folder.final.name + INTERRUPTED_SUFFIX)
    console.note(f"the earlier, complete results stay in {shown(folder.final)}", quiet)
    return place


def monitor_names(monitors: Sequence[Monitor]) -> list[str]:
    """A different name for each, such as "top-right displacement x"."""
    from dem_cli.output.record import distinct

    def told(monitor: Monitor) -> str:
        words = (monitor.place, "absolute" if monitor.absolute else "", monitor.quantity, monitor.component)
        return monitor.name or " ".join(filter(None, words))

    return distinct(map(told, monitors))


def file_names(folder: Path) -> list[str]:
    """Our files in `folder`, the summary first."""
    from dem_cli.output.folder import OWN_NAMES, SUMMARY

    here = sorted(path.name for path in folder.iterdir() if path.name in OWN_NAMES)
    return sorted(here, key=lambda name: name != SUMMARY)


def shown(folder: Path) -> Path:
    """A path as the user would type it."""
    try:
        return folder.relative_to(Path.cwd())
    except ValueError:
        return folder
