"""Render stills and movies of a run in a stone look: `dem render`."""

from __future__ import annotations

from pathlib import Path

import click

from dem_cli.app.cli.options import PictureSize, azimuth_option, elevation_option
from dem_cli.app.cli.words import console
from dem_cli.errors import UsageError

STILL, MOVIES = ".png", (".gif", ".mp4")


@click.command("render", short_help="Stills and movies of a run.")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Default: render.* in DIR.")
@click.option("--movie", type=click.Choice(("gif", "mp4")), help="All frames one after the other.")
@click.option(
    "--frame", default="last", show_default=True, metavar="WHICH",
    help="Of a still: last, failure, a number from 0, or a time such as 2.5s.",
)  # fmt: skip
@click.option("--view", type=click.Choice(("front", "3d")), help="Default: front; of structures in space 3d.")
@azimuth_option
@elevation_option
@click.option(
    "--scale", type=click.FloatRange(min=0.0, min_open=True), metavar="FACTOR",
    help="Of displacements; default: as they are, or larger where nobody would see them.",
)  # fmt: skip
@click.option(
    "--colour", "--color", type=click.Choice(("stone", "displacement", "rotation", "velocity")), default="stone",
    show_default=True, help="Of the blocks.",
)  # fmt: skip
@click.option("--joints/--no-joints", default=True, show_default=True, help="Colour joints that slide or are open.")
@click.option(
    "--forces", type=click.Choice(("bars", "arrows")), is_flag=False, flag_value="bars",
    help="Joint forces: bars as thick as they are large, or arrows as long.",
)  # fmt: skip
@click.option("--size", type=PictureSize(), help="Of the picture [pixels], such as 1200x800.")
@click.option(
    "--fps", type=click.FloatRange(0.5, 60.0),
    help="Frames per second of a movie; default: 12.5, of time histories as fast as they were.",
)  # fmt: skip
def command(
    folder: Path,
    output: Path | None,
    movie: str | None,
    frame: str,
    view: str | None,
    azimuth: float | None,
    elevation: float | None,
    scale: float | None,
    colour: str,
    joints: bool,
    forces: str | None,
    size: tuple[int, int | None] | None,
    fps: float | None,
) -> None:
    """Render the results in DIR: a picture of one frame, or a movie of all."""
    from dem_cli.results.output.atomic_file import require_file
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.output.reader import read
    from dem_cli.results.post.scene.axonometry import Standpoint
    from dem_cli.results.render.render import RenderOptions, render_apart

    path = target(folder, output, movie)
    if path.suffix in MOVIES and frame != "last":
        raise UsageError("--frame is for stills; a movie shows all frames")
    read(folder)  # what is wrong with the results is said before anything is started
    look = RenderOptions(frame, Standpoint(view, azimuth, elevation), scale, colour, joints, forces, size, fps)
    try:
        require_file(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        render_apart(folder, path, look)
    except OSError as error:
        raise write_error(error, path) from None
    console.show(str(path))


def target(folder: Path, output: Path | None, movie: str | None) -> Path:
    """Return the file to write; raises UsageError where its name and --movie disagree."""
    suffix = f".{movie}" if movie else STILL
    if output is None:
        return folder / f"render{suffix}"
    named = output.suffix
    if named not in (STILL, *MOVIES):
        raise UsageError(f"-o {output}: the name has to end in .png, .gif or .mp4")
    if movie and named != suffix:
        raise UsageError(f"-o {output}: --movie {movie} writes {suffix}")
    return output
