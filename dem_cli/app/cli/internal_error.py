"""Internal errors: message, report file with traceback and case, exit code 70."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from pathlib import Path

import click

from dem_cli.app.cli.options import STANDARD_INPUT, STDIN, given
from dem_cli.errors import OutputError
from dem_cli.version import __version__

CODE = 70  # EX_SOFTWARE of sysexits.h
TRACEBACK = "DEM_TRACEBACK"  # environment variable: anything but "" and 0 shows the traceback on the terminal as well
LARGEST_CASE = 1_000_000  # bytes of a file that is copied into the report


def report(error: Exception, words: Sequence[str]) -> int:
    """Print the error and the report file to send; returns the exit code. words: the command line."""
    if os.environ.get(TRACEBACK, "") not in ("", "0"):
        traceback.print_exception(error)
    if isinstance(error, MemoryError):
        from dem_cli.app.cli.lack_of_memory import lack_of_memory

        click.echo(f"error: {lack_of_memory(error)}", err=True)
        return OutputError.exit_code
    lines = [f"internal error: {summary(error)}", "This is a fault of dem, not of the case."]
    try:
        file = write(error, words)
        lines.append(f"Please send this file, which has the traceback and the case: {file}")
    except OSError as unwritable:
        lines.append(f"No report could be written ({unwritable.strerror}); {TRACEBACK}=1 shows the traceback.")
    click.echo("\n".join(lines), err=True)
    return CODE


def summary(error: Exception) -> str:
    """Format the exception in one line."""
    said = str(error).strip().splitlines()
    return f"{type(error).__name__}: {said[0]}" if said else type(error).__name__


def write(error: Exception, words: Sequence[str]) -> Path:
    """Write the report as a new file in the current folder, or in that of temporary files."""
    text = "".join(
        (
            f"dem {__version__}, Python {platform.python_version()}, {platform.platform()}\n",
            f"command: dem {' '.join(words)}\n\n",
            *traceback.format_exception(error),
            *(f"\n---- {word}\n{case_text(Path(word))}" for word in words if is_case(word)),
            *(f"\n---- {STANDARD_INPUT}\n{text[:LARGEST_CASE]}" for text in given if STDIN in words),
        )
    )
    name = f"dem-internal-error-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
    for folder in (Path.cwd(), Path(tempfile.gettempdir())):
        try:
            (folder / name).write_text(text, encoding="utf-8", errors="replace")
            return folder / name
        except OSError as unwritable:
            last = unwritable
    raise last


def is_case(word: str) -> bool:
    """Test whether an argument is a case file."""
    return word.endswith(".toml") and Path(word).is_file()


def case_text(path: Path) -> str:
    """Read the text of a case file, as far as possible."""
    try:
        return path.read_bytes()[:LARGEST_CASE].decode("utf-8", errors="replace")
    except OSError as error:
        return f"cannot be read: {error}\n"


def command_line(args: object) -> list[str]:
    """Return the words after `dem`: the given ones, or those of the process."""
    return [str(word) for word in args] if isinstance(args, Sequence) else sys.argv[1:]
