"""What several subcommands take and say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase

case_argument = click.argument("case", metavar="CASE")
overrides_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, such as --set joints.dry.friction=0.5; may be repeated.",
)


def warn(loaded: LoadedCase) -> None:
    """Print on stderr what is doubtful about a case."""
    for warning in loaded.warnings:
        click.echo(f"warning: {warning}", err=True)
