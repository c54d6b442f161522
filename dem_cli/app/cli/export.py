"""Export results in other formats: `dem export`."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.app.cli.words import console
from dem_cli.errors import UsageError


@click.command("export", short_help="Write results in other formats.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--joints", is_flag=True, help="A CSV file: opening, crack width, slip and stress of every joint.")
@click.option("--pvd", is_flag=True, help="A .vtu and .vtp file per frame with .pvd, for ParaView before 5.12.")
@click.option(
    "--frame", metavar="WHICH",
    help="With --joints: last (the default), failure, a number from 0, or a time such as 2.5s.",
)  # fmt: skip
@click.option(
    "-o", "--output", metavar="PATH", type=click.Path(path_type=Path), help="Default: DIR/joints.csv, DIR/pvd."
)
def command(folder: Path, joints: bool, pvd: bool, frame: str | None, output: Path | None) -> None:
    """Write the results in DIR in another format."""
    from dem_cli.results.output.joint_table import JOINTS_TABLE, joints_of, write_joints
    from dem_cli.results.output.paraview.vtk import export_pvd
    from dem_cli.results.output.reader import read

    if joints == pvd:
        raise UsageError("say which format is wanted: --joints or --pvd")
    if pvd and frame is not None:
        raise UsageError("--frame is for --joints; --pvd writes all frames")
    results = read(folder)
    if pvd:
        for path in export_pvd(results, output or folder / "pvd"):
            console.show(str(path))
        return
    from dem_cli.results.render.render import frame_number

    joints_of(results)
    number = frame_number(results.frames, results, frame or "last")
    console.show(str(write_joints(results, number, output or folder / JOINTS_TABLE)))
