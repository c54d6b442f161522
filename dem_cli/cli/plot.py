"""`dem plot`: the pictures of a run."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.cli import console


@click.command("plot", short_help="Draw the results of a run.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Default: beside the results."
)
@click.option("--animate", is_flag=True, help="Draw collapse.gif as well.")
def command(folder: Path, output: Path | None, animate: bool) -> None:
    """Draw what the results in DIR hold: capacity.png, histories.png, collapse.png, energy.png, spectra.png."""
    from dem_cli.cli.motion import draw_spectra_of_run
    from dem_cli.output.folder import write_error
    from dem_cli.post.plots import draw_all

    target = output or folder
    try:
        if output is not None:
            output.mkdir(parents=True, exist_ok=True)
        written = draw_all(folder, target, animate) + draw_spectra_of_run(folder, target)
    except OSError as error:
        raise write_error(error, target) from None
    for path in written:
        console.show(str(path))
    if not written:
        console.note(f"{folder}: nothing to draw, the run kept neither frames nor a history")
