"""Draw the pictures of a run, and any columns of runs and sweeps as charts: `dem plot`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dem_cli.app.cli.options import AxisLimits, PictureSize, azimuth_option, elevation_option
from dem_cli.app.cli.words import console
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.app.cli.chart import ColumnChoice
    from dem_cli.results.post.chart import ChartOptions
    from dem_cli.results.post.scene.axonometry import Standpoint

CHART, SWEEP = "plot.png", "sweep.png"
PICTURE_NAMES = ("capacity", "histories", "modes", "safety", "fragility", "collapse", "energy", "joints")


@click.command("plot", short_help="Draw the results of runs and sweeps.")
@click.argument("folders", metavar="DIR...", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option("-x", metavar="COLUMN", help="Of a chart: what goes to the right.")
@click.option("-y", "ys", metavar="COLUMN", multiple=True, help="What goes upwards; may be repeated.")
@click.option("--by", metavar="KEY", multiple=True, help="A curve for each value of this key of the case; colours it.")
@click.option("--where", metavar="KEY=VALUE", multiple=True, help="Of a sweep: only runs that have this value.")
@click.option("--map", "as_map", is_flag=True, help="Of a sweep: a heat map of -y over two keys (-x, --by).")
@click.option("--picture", type=click.Choice(PICTURE_NAMES), help="Only this one of all pictures of a run.")
@click.option("--list", "listed", is_flag=True, help="Print the columns that there are; draw nothing.")
@click.option(
    "-o", "--output", metavar="PATH", type=click.Path(path_type=Path),
    help="A file ending in .png, .svg or .pdf; where all pictures are drawn, a folder.",
)  # fmt: skip
@click.option("--size", type=PictureSize(), help="Of a chart [pixels], such as 1200x800.")
@click.option("--log", type=click.Choice(("x", "y", "xy")), help="Logarithmic axes.")
@click.option("--xlim", type=AxisLimits(), help="Ends of the x axis, such as 0:0.02.")
@click.option("--ylim", type=AxisLimits(), help="Ends of the y axis.")
@azimuth_option
@elevation_option
@click.option("--animate", is_flag=True, help="With all pictures of a run: collapse.gif as well.")
def command(
    folders: Sequence[Path],
    x: str | None,
    ys: Sequence[str],
    by: Sequence[str],
    where: Sequence[str],
    as_map: bool,
    picture: str | None,
    listed: bool,
    output: Path | None,
    size: tuple[int, int | None] | None,
    log: str | None,
    xlim: tuple[float, float] | None,
    ylim: tuple[float, float] | None,
    azimuth: float | None,
    elevation: float | None,
    animate: bool,
) -> None:
    """Draw what the results in DIR hold.

    \b
    dem plot RUN                                  all its pictures
    dem plot RUN -x "top displacement" -y load    a chart of two columns
    dem plot RUN RUN ... --by joints.dry.friction a curve for each run
    dem plot SWEEP                                the answer over the swept keys
    dem plot SWEEP -x displacement -y load        a curve for each of its runs (dem sweep --keep all)
    """
    from dem_cli.app.cli import chart
    from dem_cli.results.post.chart import CHART_FORMATS, ChartOptions
    from dem_cli.results.post.scene.axonometry import Standpoint

    sweep = holds_sweep(folders)
    if (where or as_map) and not sweep:
        raise UsageError("--where and --map are for the folder of a sweep")
    options = ChartOptions(size, frozenset(log or ""), xlim, ylim)
    asked = bool(x or ys or by or listed or len(folders) > 1)
    if picture is not None:
        if sweep or asked or options != ChartOptions():
            raise UsageError("--picture is for one run, without columns and sizes")
        draw_picture(folders[0], picture, output or folders[0] / f"{picture}.png", Standpoint(None, azimuth, elevation))
        return
    if not sweep and not asked:
        if options != ChartOptions() or (output is not None and output.suffix.lower() in CHART_FORMATS):
            raise UsageError("-o FILE, --size, --log, --xlim and --ylim are for charts: choose columns with -x and -y")
        if output is not None and output.suffix[1:].isalpha() and not output.is_dir():
            raise UsageError(f"-o {output}: all pictures of a run go to a folder; '{output.suffix}' names a file")
        draw_pictures(folders[0], output, animate, Standpoint(None, azimuth, elevation))
        return
    if animate:
        raise UsageError("--animate comes with all pictures of a run, without -x and -y")
    if azimuth is not None or elevation is not None:
        raise UsageError("--azimuth and --elevation are for pictures of a structure, not for charts")
    if listed:
        console.show("\n".join(chart.listing(folders, sweep)))
        return
    target = output or default(folders, sweep)
    draw_chart(folders, sweep, chart.ColumnChoice(x, ys, by, where, as_map), target, options)
    console.show(str(target))


def holds_sweep(folders: Sequence[Path]) -> bool:
    """Test whether the folder is a sweep. Raises UsageError for a missing folder, or a sweep among others."""
    from dem_cli.results.output.folder import require_folder
    from dem_cli.results.post.sweep_table import is_sweep

    for folder in folders:
        require_folder(folder)
    sweeps = [folder for folder in folders if is_sweep(folder)]
    if sweeps and len(folders) > 1:
        raise UsageError(f"{sweeps[0]}: a sweep is drawn alone, not beside other folders")
    return bool(sweeps)


def default(folders: Sequence[Path], sweep: bool) -> Path:
    """Return the default file of a chart: beside the results; of several folders, the working directory."""
    if len(folders) > 1:
        return Path(CHART)
    return folders[0] / (SWEEP if sweep else CHART)


def draw_pictures(folder: Path, output: Path | None, animate: bool, asked: Standpoint) -> None:
    """Draw all pictures of one run."""
    from dem_cli.app.cli.motion import draw_spectra_of_run
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.post.run_pictures import draw_all

    target = output or folder
    try:
        if output is not None:
            output.mkdir(parents=True, exist_ok=True)
        written = draw_all(folder, target, animate, asked) + draw_spectra_of_run(folder, target)
    except OSError as error:
        raise write_error(error, target) from None
    for path in written:
        console.show(str(path))
    if not written:
        console.note(f"{folder}: nothing to draw, the run kept neither frames nor a history")


def draw_picture(folder: Path, name: str, path: Path, asked: Standpoint) -> None:
    """Draw one of the pictures of a run."""
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.post.chart import check_format
    from dem_cli.results.post.run_pictures import draw_one

    check_format(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        draw_one(folder, f"{name}.png", path, asked)
    except OSError as error:
        raise write_error(error, path) from None
    console.show(str(path))


def draw_chart(folders: Sequence[Path], sweep: bool, choice: ColumnChoice, target: Path, options: ChartOptions) -> None:
    """Draw one chart, of runs or of a sweep."""
    from dem_cli.app.cli import chart
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.post.chart import check_format

    check_format(target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if sweep:
            chart.of_sweep(folders[0], choice, target, options)
        else:
            chart.of_runs(folders, choice, target, options)
    except OSError as error:
        raise write_error(error, target) from None
