"""Export the blocks of a case as a file for another program: `dem build`."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.app.cli.options import case_argument, load, overrides_option, warn


@click.command("build", short_help="Write the blocks of a case to a file for another program.")
@case_argument
@overrides_option
@click.option(
    "-o", "--output", required=True, type=click.Path(), metavar="FILE", help="File to write, such as model.obj."
)
def command(case: str, overrides: tuple[str, ...], output: str) -> None:
    """Write the blocks of CASE to FILE.

    \b
    .vtu          ParaView
    .obj .stl     meshes, with the names of the blocks
    .glb .gltf    glTF, for viewers
    .json         COMPAS meshes
    .dxf          a drawing of a case in 2D
    .lmgc90.py    LMGC90: a script for pylmgc90
    .3ddat        3DEC: a data file
    or another format that meshio writes.
    """
    from dem_cli.app import api
    from dem_cli.masonry.exports.contents import ExportedCase
    from dem_cli.masonry.exports.formats import write_case

    loaded = load(case, overrides)
    made = api.build_assembly(loaded)
    warn(loaded)
    for note in write_case(Path(output), ExportedCase(loaded.case, made.model, made.blocks, loaded.name)):
        click.echo(f"warning: {output} does not carry: {note}", err=True)
    click.echo(f"{made.model.n_blocks:,} blocks written to {output}")
