"""Command `scripts/benchmark [GROUP...]`: measure run time against error on this machine, write docs/benchmarks.md."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench import registry
from bench.machine import describe, one_thread
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from bench.record import BenchOptions


class BenchmarkCommand(click.Command):
    """A command that prints a UsageError as one line and exits with its code, as `dem` does."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except UsageError as error:
            click.echo(f"error: {error}", err=True)
            ctx.exit(error.exit_code)


@click.command("scripts/benchmark", cls=BenchmarkCommand, context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("groups", nargs=-1, metavar="[GROUP]...")
@click.option("--quick", is_flag=True, help="The smallest sizes, once: does it work?")
@click.option("--long", is_flag=True, help="The largest sizes as well; takes hours.")
@click.option("--repeats", type=click.IntRange(min=1), help="Rounds; default: as each group says.")
@click.option("--json", "json_file", metavar="FILE", help="Results as JSON; - for stdout.")
@click.option(
    "-o",
    "--write",
    "folder",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Write benchmarks.md, pictures and data/benchmarks.json there; groups not measured now stay.",
)
@click.option("--redraw", is_flag=True, help="Measure nothing: page and pictures again from DIR/data/benchmarks.json.")
def command(
    groups: Sequence[str],
    quick: bool,
    long: bool,
    repeats: int | None,
    json_file: str | None,
    folder: Path | None,
    redraw: bool,
) -> None:
    """Measure cost and error of dem: all groups, or those named.

    Groups: kernels, joints, precision, time_histories, growth, threads, sweeps, features, others, spatial, peers,
    startup.
    """
    one_thread()
    from bench.page import data_file, keep, render, write
    from bench.record import BenchOptions, as_json, read

    if redraw and folder is None:
        raise UsageError("--redraw needs the folder of benchmarks.json: -o DIR")
    check_places(folder, json_file)
    found = read(data_file(folder)) if redraw and folder is not None else {}
    for name in [] if redraw else checked(groups):
        found[name] = measured(name, BenchOptions(quick, long, repeats))
        if folder is not None:
            keep(folder, found)  # at once: what was measured is not lost if the rest is interrupted
    if json_file == "-":
        click.echo(as_json(found), nl=False)
    elif json_file is not None:
        Path(json_file).write_text(as_json(found), encoding="utf-8", newline="\n")
    if folder is not None:
        for path in write(folder, found):
            click.echo(f"wrote {path}", err=True)
    elif json_file is None:
        click.echo(render(found), nl=False)


def check_places(folder: Path | None, json_file: str | None) -> None:
    """Raise UsageError before anything is measured where results could not be written."""
    if json_file not in (None, "-") and not Path(str(json_file)).resolve().parent.is_dir():
        raise UsageError(f"--json {json_file}: there is no such folder")
    if folder is not None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(f"-o {folder}: {error.strerror}") from None
        if not os.access(folder, os.W_OK):
            raise UsageError(f"-o {folder}: cannot be written to")


def checked(groups: Sequence[str]) -> list[str]:
    """Return the requested groups in their order. Raises UsageError on an unknown one."""
    unknown = [name for name in groups if name not in registry.GROUPS]
    if unknown:
        raise UsageError(f"no benchmark group '{unknown[0]}' (groups: {', '.join(registry.GROUPS)})")
    return [name for name in registry.GROUPS if name in groups or not groups]


def measured(name: str, options: BenchOptions) -> dict[str, Any]:
    """Measure one group; returns its JSON form."""
    from bench.cases import compiled
    from bench.record import group_table

    click.echo(f"measuring {name}: {registry.GROUPS[name]}", err=True)
    machine = describe()
    compiled()
    return group_table(registry.module(name).measure(options), machine)


if __name__ == "__main__":
    command(prog_name="scripts/benchmark")
