"""Build, solve and write a case: the one pipeline for `dem run`, `dem sweep`, `dem verify` and Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from dem_cli.app.pipeline.batches import BatchOptions, batch_of, finish, finish_stages, many, stages_of
from dem_cli.app.pipeline.completion import completed, stopped, with_names
from dem_cli.app.pipeline.listener import RunListener
from dem_cli.app.pipeline.monitor_names import check_quantities, monitor_names, monitor_quantities
from dem_cli.app.pipeline.recorder import Recorder, joints_of
from dem_cli.core.engine.threads.crew import crew_of
from dem_cli.errors import CaseProblem, SolverError
from dem_cli.interrupts import Interrupts

if TYPE_CHECKING:
    from dem_cli.analyses.ensembles.batch import Batch
    from dem_cli.case.reader import LoadedCase
    from dem_cli.case.schema import Case
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.ports import Observer
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.store import ResultWriter


class SolverOutcome(Protocol):
    """Outcome of a solver."""

    summary: dict[str, Any]


ONE_OF_MANY = "not used here: one case is solved, as written above; `dem sweep` runs all of them"
Solve = Callable[["Case", "Model", "Observer"], SolverOutcome]
RunOutcome = tuple[dict[str, Any], Path]  # the summary, and the folder with the results


@dataclass(frozen=True)
class Destination:
    """Destination of the results of a run, and the treatment of existing files (OutputFolder)."""

    output: Path
    force: bool = False  # write among files that dem did not write
    recover: bool = True  # look after the leftovers of a killed run


def run_case(
    loaded: LoadedCase,
    destination: Destination,
    started: float,
    *,
    options: BatchOptions | None = None,
    listener: RunListener | None = None,
    interrupts: Interrupts | None = None,
) -> RunOutcome:
    """Build, solve and write a case that was read, as `execute`. Raises DemError."""
    from dem_cli.app import api

    return execute(
        loaded,
        api.build_model(loaded),
        destination,
        started,
        options=options,
        listener=listener,
        interrupts=interrupts,
    )


def execute(
    loaded: LoadedCase,
    model: Model,
    destination: Destination,
    started: float,
    *,
    solve: Solve | None = None,
    options: BatchOptions | None = None,
    listener: RunListener | None = None,
    interrupts: Interrupts | None = None,
) -> RunOutcome:
    """Solve a built case and write its results; nothing is left where it fails.

    started: time.perf_counter() when the work began. solve: another solver.
    Raises CaseError, UsageError and OutputError; a solver that gives up is the status "not converged", and one that
    is interrupted has "interrupted", with the results so far (KeyboardInterrupt where there are none).
    """
    from dem_cli.case.writer import case_text
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.provenance import provenance
    from dem_cli.results.output.store import ResultWriter

    listener = listener or RunListener()
    case, names = loaded.case, monitor_names(loaded.case.monitor)
    with loaded.located():
        check_quantities(case, names)
    with (
        interrupts or Interrupts(),
        OutputFolder(destination.output, force=destination.force, recover=destination.recover) as folder,
    ):
        text, kind, quantities = case_text(case), case.analysis.kind, monitor_quantities(case.monitor)
        writer = ResultWriter(folder.path, model, text, provenance(), names, kind, destination.output, quantities)
        writer.follow(joints_of)
        options, recorder = options or BatchOptions(), Recorder(writer, listener)
        with (
            abandoning(writer),
            loaded.located(),
            batch_of(case, text, folder, options, listener) as batch,
            stages_of(case, text, folder, options, recorder) as checkpoints,
            crew_of(1 if many(case) else options.threads or 1) as crew,
        ):
            found = solved(solve or load_solver(batch), case, model, recorder)
            listener.solved()
            if crew.used < crew.wanted:
                listener.threads_without_work(crew.used, crew.wanted)
            if batch is not None:
                found = with_names(found, names, quantities)
            summary = completed(found | writer.measured(found), loaded, model, started)
            writer.close(summary)
            if summary["status"] != "interrupted":
                listener.written(folder.path)
            place = put_in_place(folder, summary, listener)
            if batch is not None:
                finish(batch, summary, listener)
            if checkpoints is not None:
                finish_stages(checkpoints, summary, listener)
            return summary, place


def one_of_many(loaded: LoadedCase) -> None:
    """Add a warning about the [sweep] of a case that is solved once."""
    if loaded.case.sweep is not None:
        line = loaded.render(CaseProblem(("sweep",), ONE_OF_MANY))
        loaded.warnings += [line] if line not in loaded.warnings else []


def load_solver(batch: Batch | None) -> Solve:
    """Import the solver, only when a case is ready to be solved."""
    from dem_cli.analyses.solve import solve

    return solve if batch is None else partial(solve, batch=batch)


def solved(solve: Solve, case: Case, model: Model, recorder: Recorder) -> dict[str, Any]:
    """Run the solver and return its summary; after an interrupt or failure, its progress."""
    writer = recorder.writer
    try:
        return solve(case, model, recorder).summary
    except KeyboardInterrupt:
        if writer.last_row is None and writer.last_frame is None:
            raise
        return stopped("interrupted", writer, ["interrupted: the results end at the state in 'reached'"])
    except SolverError as error:
        return stopped("not converged", writer, [str(error)])


@contextmanager
def abandoning(writer: ResultWriter) -> Iterator[None]:
    """Close the files of a run that ends without results."""
    try:
        yield
    finally:
        writer.abandon()


def put_in_place(folder: OutputFolder, summary: dict[str, Any], listener: RunListener) -> Path:
    """Commit the results; an interrupted run goes beside earlier complete ones, not over them."""
    from dem_cli.results.output.folder import INTERRUPTED_SUFFIX, is_complete

    if summary["status"] != "interrupted" or not is_complete(folder.final):
        return folder.commit()
    place = folder.commit(folder.final.name + INTERRUPTED_SUFFIX)
    listener.earlier_kept(folder.final)
    return place
