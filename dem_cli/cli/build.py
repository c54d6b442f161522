"""`dem build`: the geometry of a case as a file."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.cli.options import case_argument, load, overrides_option, warn


@click.command("build", short_help="Write the geometry of a case to a file.")
@case_argument
@overrides_option
@click.option("-o", "--output", required=True, metavar="FILE", help="File to write, such as model.vtu.")
def command(case: str, overrides: tuple[str, ...], output: str) -> None:
    """Write the blocks of CASE to FILE: .vtu (ParaView) or another format that meshio writes."""
    from dem_cli import api
    from dem_cli.output.paraview.vtk import write_geometry

    loaded = load(case, overrides)
    model = api.build_model(loaded)
    warn(loaded)
    write_geometry(Path(output), model)
    click.echo(f"{model.n_blocks:,} blocks written to {output}")
