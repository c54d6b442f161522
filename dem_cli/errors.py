"""Exceptions that `dem` raises on purpose.

DemError
├── CaseError        exit 2   the case file or an override is wrong (all problems at once)
├── UsageError       exit 2   arguments, a missing or unreadable file, an output folder that is not ours
│   ├── MissingExtra          an optional part of dem that is not installed
│   └── DamagedResults        results that are read back are not what a run writes
├── SolverError      exit 3   the solver gave up; what it has is kept
└── OutputError      exit 3   results could not be written (full disk, no permission)

Anything else is a fault of the program: app/cli/internal_error.py, exit 70.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from dem_cli.version import install_command

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")  # a key that TOML takes without quotes
# what a terminal obeys instead of showing it, what turns the order of letters round, and what no file of text can hold
CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
KeyPath = tuple[str | int, ...]


class DemError(Exception):
    """Base class of all exceptions of dem; `exit_code` is what the command line returns."""

    exit_code = 1

    def _render_traceback_(self) -> list[str]:
        """Return the lines that a notebook shows instead of a traceback: the line of the call, and the message."""
        import linecache

        trace, asked = self.__traceback__, ""
        while trace is not None and not trace.tb_frame.f_globals.get("__name__", "").startswith("dem_cli"):
            asked = linecache.getline(trace.tb_frame.f_code.co_filename, trace.tb_lineno).strip()
            trace = trace.tb_next
        first, *more = str(self).splitlines() or [""]
        return [*([f"in: {asked}"] if asked else []), f"{type(self).__name__}: {first}", *more]


@dataclass(frozen=True)
class CaseProblem:
    """Mistake in a case: its place (key path such as ("structure", 0, "block")) and its message.

    `at_key` points the reader to the name instead of the value, as for an unknown key.
    """

    path: KeyPath
    message: str
    at_key: bool = False


class CaseError(DemError):
    """Error of an invalid case, with every problem found.

    `render` turns a problem into a line of text; the reader of the file gives one that adds line and column.
    """

    exit_code = 2

    def __init__(self, problems: Sequence[CaseProblem], render: Callable[[CaseProblem], str] | None = None):
        self.problems = tuple(problems)
        super().__init__("\n".join((render or plain)(problem) for problem in self.problems))

    def __reduce__(self) -> tuple[Callable[..., CaseError], tuple[str, tuple[CaseProblem, ...]]]:
        """Pickle the error with its text, so that it can come from another process."""
        return _case_error, (str(self), self.problems)


def _case_error(text: str, problems: tuple[CaseProblem, ...]) -> CaseError:
    """Recreate a CaseError from its text."""
    error = CaseError(problems)
    error.args = (text,)
    return error


class UsageError(DemError):
    """Error of wrong arguments or files on the command line."""

    exit_code = 2


class MissingExtra(UsageError):
    """Error of a missing optional part of dem: `drawing needs matplotlib: pip install '/home/me/dem[plot]'`."""

    def __init__(self, need: str, extra: str, note: str = ""):
        super().__init__(f"{need}: {install_command(extra)}{note}")

    def __reduce__(self) -> tuple[Callable[..., UsageError], tuple[str]]:
        """Pickle the error with its text, so that it can come from another process."""
        return UsageError, (str(self),)


class DamagedResults(UsageError):
    """Error of damaged results that differ from what a run writes: `NAME is missing`, or has the wrong type or shape.

    damage: which part of them is what; folder: where they lie, named once that is known.
    """

    def __init__(self, damage: str, folder: object = None):
        self.damage = damage
        place = "" if folder is None else f"{folder}: "
        super().__init__(f"{place}these results are damaged: {damage}")

    def __reduce__(self) -> tuple[Callable[..., UsageError], tuple[str]]:
        """Pickle the error with its text, so that it can come from another process."""
        return UsageError, (str(self),)


class SolverError(DemError):
    """Error of the solver, which cannot go on; the message says when, where and why."""

    exit_code = 3


class OutputError(DemError):
    """Error of results that could not be written."""

    exit_code = 3


def dotted(path: KeyPath) -> str:
    """Format a key path as a user types it after `--set`: ("structure", 0, "block") -> structure.0.block.

    A name that is more than letters, digits, - and _ is quoted: materials."hard stone".density.
    """
    return ".".join(str(key) if BARE_KEY.fullmatch(str(key)) else json.dumps(key, ensure_ascii=False) for key in path)


def printable(text: str) -> str:
    """Escape the control characters of a text, such as \\x1b: a terminal shows them instead of obeying."""
    return CONTROLS.sub(lambda found: repr(found[0])[1:-1], text)


def plain(problem: CaseProblem) -> str:
    """Format a problem as one line, without its place in a file."""
    return f"{dotted(problem.path)}: {problem.message}" if problem.path else problem.message
