"""Write one HTML page with everything from a run or a sweep: `dem report`."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Any

import click

from dem_cli.app.cli.words import console
from dem_cli.errors import UsageError

PAGE_FILE = "report.html"


@click.command("report", short_help="Write one page of HTML with all results.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help=f"Default: DIR/{PAGE_FILE}.")
@click.option("--open", "show", is_flag=True, help="Open it in the browser.")
def command(folder: Path, output: Path | None, show: bool) -> None:
    """Write one page of HTML with everything that `dem run` or `dem sweep` left in DIR.

    The page is one file that loads nothing: answer, warnings, audit, a view of the structure to turn and play, charts,
    tables, the case.
    """
    from dem_cli.results.output.atomic_file import write_text
    from dem_cli.results.output.folder import require_folder
    from dem_cli.results.output.reader import read_summary
    from dem_cli.results.post.sweep_table import is_sweep
    from dem_cli.results.report import run, sweep

    require_folder(folder)
    target = output or folder / PAGE_FILE
    if target.is_dir():
        raise UsageError(f"{target}: a folder; -o takes the name of a file")
    if is_sweep(folder):
        text = sweep.page(folder, target.parent)
    else:
        summary = read_summary(folder)
        text = run.page(folder, summary, said(summary))
    write_text(target, text)
    console.show(f"{target}  ({len(text.encode()) / 1e6:.1f} MB)")
    if show:
        webbrowser.open(target.resolve().as_uri())


def said(summary: dict[str, Any]) -> Any:
    """Return the lines that `dem run` prints of a summary, and its verdicts."""
    from dem_cli.app.cli.words.reference import one_line
    from dem_cli.results.output.reference import as_declared, from_summary
    from dem_cli.results.report.run import TerminalText

    if not summary:  # of a killed run
        return TerminalText([], [])
    answers = from_summary(summary.get("reference"))
    tones = ["bad" if not as_declared(answer) else "look" if "missed" in answer else "good" for answer in answers]
    verdicts = [(tone, f"reference: {one_line(answer)}") for tone, answer in zip(tones, answers, strict=True)]
    return TerminalText(console.answer_rows(summary), verdicts)
