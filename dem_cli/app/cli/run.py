"""Solve a case with a progress bar; print the failure load and its accuracy: `dem run`."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dem_cli.app.cli.options import case_argument, load, overrides_option
from dem_cli.app.cli.words import console
from dem_cli.app.cli.words.numbers import seconds as duration
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.listener import RunListener
from dem_cli.errors import DemError

if TYPE_CHECKING:
    from dem_cli.app.pipeline.execution import RunOutcome, Solve
    from dem_cli.case.reader import LoadedCase
    from dem_cli.core.model.model import Model


MORE_THREADS = (
    "several step a structure where its geometry is fixed and joints follow coulomb, from some 1,000 blocks on"
)


class TerminalListener(RunListener):
    """Listener that shows a progress bar, prints remarks, and draws the requested pictures."""

    def __init__(self, bar: console.Progress, quiet: bool, plot: bool):
        self.bar, self.quiet, self.plot = bar, quiet, plot

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Update the progress bar."""
        self.bar.update(stage, load, displacement, fraction)

    def solved(self) -> None:
        """Remove the progress bar."""
        self.bar.stop()

    def threads_without_work(self, used: int, wanted: int) -> None:
        """Print a remark on idle threads."""
        console.note(f"{used} of {wanted} threads had work: {MORE_THREADS}", self.quiet)

    def written(self, folder: Path) -> None:
        """Draw the pictures, where requested."""
        if self.plot:
            draw(folder, self.quiet)

    def earlier_kept(self, folder: Path) -> None:
        """Print that earlier results stay."""
        console.note(f"the earlier, complete results stay in {shown(folder)}", self.quiet)

    def runs_kept(self, count: int) -> None:
        """Print how many finished runs are kept."""
        self.bar.stop()
        console.note(f"{count:,} runs are kept; go on with --resume", self.quiet)

    def stages_kept(self, seconds: float) -> None:
        """Print how much work is kept."""
        self.bar.stop()
        console.note(f"the first {duration(seconds)} of work are kept; go on with --resume", self.quiet)

    def stages_not_kept(self, why: str) -> None:
        """Print why no more work is kept."""
        console.note(f"nothing more of this run is kept for --resume: {why}", self.quiet)


@click.command("run")
@case_argument
@overrides_option
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Default: results/NAME.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no remarks.")
@click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="Say what was skipped because the case does not need it, and what made compilation slow.",
)
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
@click.option(
    "-j",
    "--threads",
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Runs side by side, of analyses that consist of many; default: all cores. Else threads that step a large"
    " structure together; default: 1.",
)
@click.option("--resume", is_flag=True, help="Go on where an interrupted or killed run of the same case stopped.")
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
    from dem_cli.app import api
    from dem_cli.app.pipeline.execution import one_of_many
    from dem_cli.results.output.summary import exit_code, to_json

    started = time.perf_counter()
    loaded = load(case, overrides)
    one_of_many(loaded)
    options = BatchOptions(threads, resume)
    model = api.build_model(loaded)
    summary, folder = execute(
        loaded,
        model,
        output or Path("results") / loaded.name,
        started,
        force=force,
        quiet=quiet,
        plot=plot,
        options=options,
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
    options: BatchOptions | None = None,
) -> RunOutcome:
    """Solve and write a case as pipeline.execution.execute, with terminal output and pictures."""
    from dem_cli.app.pipeline import execution

    with console.Progress(quiet) as bar:
        listener = TerminalListener(bar, quiet, plot)
        destination = execution.Destination(output, force=force)
        return execution.execute(loaded, model, destination, started, solve=solve, options=options, listener=listener)


def draw(folder: Path, quiet: bool) -> None:
    """Draw the pictures; a failure is only reported."""
    try:
        from dem_cli.results.post.run_pictures import draw_all

        draw_all(folder, folder)
    except (DemError, OSError) as error:
        console.note(f"no pictures: {error}", quiet)
    except KeyboardInterrupt:
        console.note("not all pictures: interrupted", quiet)
    except Exception as error:  # a fault of the program in a picture does not cost hours of solving
        console.note(f"no pictures: internal error: {type(error).__name__}: {error}", quiet)


def file_names(folder: Path) -> list[str]:
    """List the files of dem in `folder`, the summary first."""
    from dem_cli.results.output.folder import OWN_NAMES, SUMMARY

    here = sorted(path.name for path in folder.iterdir() if path.name in OWN_NAMES)
    return sorted(here, key=lambda name: name != SUMMARY)


def shown(folder: Path) -> Path:
    """Format a path as the user would type it."""
    try:
        return folder.relative_to(Path.cwd())
    except ValueError:
        return folder
