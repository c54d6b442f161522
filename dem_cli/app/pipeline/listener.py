"""Listener for the progress of a run and its results: for a command, a notebook, a test."""

from __future__ import annotations

from pathlib import Path


class RunListener:
    """Listener of a run that does nothing. Its methods return at once and change nothing."""

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Report the progress of the solver; `fraction` of the stage that is done, None where it is unknown."""

    def solved(self) -> None:
        """Report that the solver has ended; its results are being completed."""

    def threads_without_work(self, used: int, wanted: int) -> None:
        """Report that fewer threads stepped the structure than were requested."""

    def written(self, folder: Path) -> None:
        """Report that all files of a finished run are in `folder`, before it gets its final name; pictures may join
        them.
        """

    def earlier_kept(self, folder: Path) -> None:
        """Report that the run was interrupted: earlier, complete results stay in `folder`, these go beside it."""

    def runs_kept(self, count: int) -> None:
        """Report that an analysis of many runs was interrupted, and how many are stored for `resume`."""

    def stages_kept(self, seconds: float) -> None:
        """Report that a run was interrupted, and how much of its work is stored for `resume`."""

    def stages_not_kept(self, why: str) -> None:
        """Report that no more of the run is stored for `resume`."""
