"""Options and parameter types shared by several subcommands."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dem_cli.errors import UsageError, printable
from dem_cli.input_limits import CASE_BYTES

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase

case_argument = click.argument("case", metavar="CASE", type=click.Path(readable=False))  # shells complete file names
overrides_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, such as --set joints.dry.friction=0.5; may be repeated.",
)

azimuth_option = click.option(
    "--azimuth", type=float, metavar="DEG",
    help="Of a structure in space: where one stands, from x towards y; default: where it moves to.",
)  # fmt: skip
elevation_option = click.option(
    "--elevation", type=click.FloatRange(-90.0, 90.0), metavar="DEG", help="Of one in space: how high one stands."
)

STDIN, STANDARD_INPUT = "-", Path("<stdin>")  # on the command line; in messages

given: list[str] = []  # the case that came from there last, for the report of a fault
_SMALLEST, _LARGEST = 200, 8000  # pixels of a picture


class PictureSize(click.ParamType):
    """Size of a picture in pixels: 1200x800, or 1200 and a height that suits."""

    name = "WIDTH[xHEIGHT]"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> object:
        """Parse width and height, None where it is left to the picture; an error for anything else."""
        match = re.fullmatch(r"(\d+)(?:x(\d+))?", str(value))
        sides = [int(side) for side in match.groups() if side] if match else []
        if not sides or not all(_SMALLEST <= side <= _LARGEST for side in sides):
            self.fail(f"{value}: give a width from {_SMALLEST} to {_LARGEST} pixels, or both sides such as 1200x800")
        return (sides[0], sides[1] if len(sides) > 1 else None)


class AxisLimits(click.ParamType):
    """Limits of an axis: 0:0.02, the lower and the upper end."""

    name = "LOW:HIGH"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> object:
        """Parse both ends; an error for anything else."""
        try:
            low, high = map(float, str(value).split(":"))
        except ValueError:
            low, high = 0.0, 0.0
        if not low < high:
            self.fail(f"{value}: give two numbers, the lower one first, such as 0:0.02")
        return low, high


def load(case: str, overrides: Sequence[str]) -> LoadedCase:
    """Read and validate the case of a command: a file, or standard input where it is `-`.

    Relative paths in a case from standard input start at the working directory. Raises CaseError and UsageError.
    """
    from dem_cli.app import api
    from dem_cli.case.reader import decoded

    if case != STDIN:
        return api.load_case(case, overrides)
    raw = sys.stdin.buffer.read(CASE_BYTES + 1)
    if len(raw) > CASE_BYTES:
        raise UsageError(f"{STANDARD_INPUT}: has no end within {CASE_BYTES / 1e6:,.0f} MB, the largest case allowed")
    text = decoded(STANDARD_INPUT, raw)
    given[:] = [text]
    return api.load_case(STANDARD_INPUT, overrides, text)


def warn(loaded: LoadedCase) -> None:
    """Print the warnings about a case on stderr."""
    for warning in loaded.warnings:
        click.echo(f"warning: {printable(warning)}", err=True)
