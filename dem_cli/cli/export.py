"""`dem export`: results in other formats."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.cli.words import console
from dem_cli.errors import UsageError


@click.command("export", short_help="Write results in other formats.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--pvd", is_flag=True, help="A .vtu and .vtp file per frame with .pvd, for ParaView before 5.12.")
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Default: DIR/pvd.")
def command(folder: Path, pvd: bool, output: Path | None) -> None:
    """Write the results in DIR in another format."""
    from dem_cli.output.reader import read
    from dem_cli.output.vtk import export_pvd

    if not pvd:
        raise UsageError("say which format is wanted: --pvd")
    for path in export_pvd(read(folder), output or folder / "pvd"):
        console.show(str(path))
