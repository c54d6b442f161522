"""Everything that `dem` raises on purpose.

DemError
├── CaseError        exit 2   the case file or an override is wrong (all problems at once)
├── UsageError       exit 2   arguments, a missing or unreadable file, an output folder that is not ours
├── SolverError      exit 3   the solver gave up; what it has is kept
└── OutputError      exit 3   results could not be written (full disk, no permission)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

KeyPath = tuple[str | int, ...]


class DemError(Exception):
    """Base of all; `exit_code` is what the command line returns."""

    exit_code = 1


@dataclass(frozen=True)
class CaseProblem:
    """One mistake in a case: where (key path such as ("structure", 0, "block")) and what."""

    path: KeyPath
    message: str


class CaseError(DemError):
    """The case is invalid. Holds every problem found, not only the first."""

    exit_code = 2

    def __init__(self, problems: Sequence[CaseProblem]):
        self.problems = tuple(problems)
        super().__init__("\n".join(f"{dotted(p.path)}: {p.message}" for p in self.problems))


class UsageError(DemError):
    """Wrong arguments or files on the command line."""

    exit_code = 2


class SolverError(DemError):
    """The solver cannot go on; the message says when, where and why."""

    exit_code = 3


class OutputError(DemError):
    """Results could not be written."""

    exit_code = 3


def dotted(path: KeyPath) -> str:
    """The key path as a user types it after `--set`: ("structure", 0, "block") -> "structure.0.block"."""
    return ".".join(str(key) for key in path)
