"""Entry point of the `dem` command: subcommands imported on use, and one place for errors.

A subcommand lives in dem_cli/app/cli/<name>.py as a click command named `command`. It raises DemError for
everything that is the user's to mend, and returns its exit code (None is 0).
"""

from __future__ import annotations

import atexit
import errno
import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any

import click

from dem_cli.errors import DemError, OutputError, UsageError, printable
from dem_cli.interrupts import Interrupts, asked
from dem_cli.late_modules import start_lightly
from dem_cli.version import __version__

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

COMMANDS = {  # name -> the line that `dem --help` shows
    "run": "Solve a case and write its results.",
    "check": "Validate a case and print its model; solve nothing.",
    "sweep": "Run a case many times, over the values in its [sweep].",
    "verify": "Run all cases with a known answer and compare.",
    "calibrate": "Find the joint profile that comes closest to a test.",
    "limit": "Failure load by rigid-block limit analysis.",
    "motion": "Measure, write and draw the ground motions of a case.",
    "build": "Write the blocks of a case to a file for another program.",
    "new": "Print a commented case file to start from.",
    "schema": "Print the JSON Schema of the case file.",
    "explain": "Say what a key of the case file means.",
    "plot": "Draw the results of runs and sweeps.",
    "render": "Stills and movies of a run.",
    "report": "Write one page of HTML with all results of a run or sweep.",
    "export": "Write results in other formats.",
}
# Matrices here are small: threads of NumPy's linear algebra wait in a loop, an eighth of the CPU time of a short run.
for _threads in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):  # read when NumPy is imported
    os.environ.setdefault(_threads, "1")

os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # to look for some reads all that is installed
start_lightly()

_ended: list[int] = []  # the exit code of a command that ended, in a process of its own


def _leave() -> None:
    """End the process at once: freeing all objects takes a tenth of a short run."""
    if _ended:
        with suppress(OSError, ValueError):  # what cannot be printed is Python's to say
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(_ended[0])


atexit.register(_leave)  # before others do, so that it comes after them

LONGEST_NAME = 60  # letters of a name that is too long, in a message
UNPRINTED = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # why a file or device takes no more of what we print
INTERRUPTED_CODE = 130  # what a shell reports for a program ended by Ctrl-C


class LazyGroup(click.Group):
    """Command group that imports subcommands on use and turns every DemError into its exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all subcommands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import a subcommand; None for an unknown name."""
        if name not in COMMANDS:
            return None
        return import_module(f"dem_cli.app.cli.{name}").command

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Complete a command in the shell without importing any, or an option."""
        from click.shell_completion import CompletionItem

        if incomplete.startswith("-"):
            return super().shell_complete(ctx, incomplete)
        return [CompletionItem(name, help=line) for name, line in COMMANDS.items() if name.startswith(incomplete)]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the subcommand that the arguments name, or raise an error with the nearest name."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            ctx.fail(unknown_command(name))
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Format the table of subcommands in the help, without importing any."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def main(self, *args: Any, **options: Any) -> Any:
        """Run a command and exit: the only place where an error becomes a line on stderr and an exit code."""
        options |= {"prog_name": options.get("prog_name") or "dem", "standalone_mode": False}
        is_program = not args and options.get("args") is None
        with Interrupts(at_once=True, ends_program=is_program) as interrupts:  # until a command has something to keep
            code = self._exit_code(args, options)
            if is_program:
                interrupts.over()
                _ended.append(code or 0)
        sys.exit(code or 0)

    def _exit_code(self, args: tuple[Any, ...], options: dict[str, Any]) -> int | None:
        try:
            code = super().main(*args, **options)
            sys.stdout.flush()
        except click.ClickException as error:
            error.show()
            code = error.exit_code
        except (click.Abort, KeyboardInterrupt):
            code = interrupted()
        except BrokenPipeError:
            code = quiet_pipe()
        except DemError as error:
            click.echo("\n".join(f"error: {printable(line)}" for line in str(error).splitlines()), err=True)
            code = error.exit_code
        except Exception as error:
            if asked():
                return interrupted()  # what a library made of it while it was imported
            if isinstance(error, OSError) and error.filename is None and error.errno in UNPRINTED:
                return unprinted(error)
            if isinstance(error, OSError) and error.errno in (errno.ENAMETOOLONG, errno.ELOOP):
                return unopened(error)
            from dem_cli.app.cli import internal_error  # a fault of the program

            code = internal_error.report(error, internal_error.command_line(args[0] if args else options.get("args")))
        return code


def interrupted() -> int:
    """Return the exit code after Ctrl-C."""
    click.echo("interrupted", err=True)
    return INTERRUPTED_CODE


def unprinted(error: OSError) -> int:
    """Return the exit code after a failed write to standard output (`dem ... > /dev/full`)."""
    click.echo(f"error: cannot print to the standard output: {os.strerror(error.errno or 0).lower()}", err=True)
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return OutputError.exit_code


def unopened(error: OSError) -> int:
    """Return the exit code after a file or folder name that the system rejects."""
    name = printable(os.fsdecode(error.filename or ""))
    short = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}..."
    click.echo(f"error: {short}: {os.strerror(error.errno or 0).lower()}", err=True)
    return UsageError.exit_code


def unknown_command(name: str) -> str:
    """Return the message for an unknown command."""
    from difflib import get_close_matches

    if name == "bench":  # of versions before 0.21
        return "no command 'bench' since 0.21: benchmarks are run by scripts/benchmark of a checkout"
    close = get_close_matches(name, COMMANDS, 1)
    hint = f", did you mean '{close[0]}'?" if close else ""
    return f"no command '{name}'{hint} (commands: {', '.join(COMMANDS)})"


def quiet_pipe() -> int:
    """Return the exit code after a closed pipe (`dem ... | head`): no error, and no more output."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


@click.group("dem", cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="dem", message="%(prog)s %(version)s")
def main() -> None:
    """How much earthquake can a dry-stone wall, arch, vault or house take?

    A TOML case file describes the structure; `dem run CASE.toml` pushes it until it fails, or shakes it.
    """
