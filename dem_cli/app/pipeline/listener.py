"""Progress of a run and what becomes of its results, told to whoever runs it: a command, a notebook, a test."""

from __future__ import annotations

from pathlib import Path


class RunListener:
    """Hears how a run goes; this one does nothing. Its methods return at once and change nothing."""

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Where the solver stands; `fraction` of the stage that is done, None where nobody can tell."""

    def solved(self) -> None:
        """The solver has ended; its results are being completed."""

    def threads_without_work(self, used: int, wanted: int) -> None:
        """Fewer threads stepped the structure than were wanted."""

    def written(self, folder: Path) -> None:
        """All files of a run that nobody interrupted are in `folder`, which is about to get its final name; pictures
        may join them.
        """

    def earlier_kept(self, folder: Path) -> None:
        """The run was interrupted: the earlier, complete results stay in `folder`, these go beside it."""

    def runs_kept(self, count: int) -> None:
        """An analysis of many runs was interrupted; so many of them are done and kept for `resume`."""

    def stages_kept(self, seconds: float) -> None:
        """A run was interrupted; so much of its work is kept for `resume`."""

    def stages_not_kept(self, why: str) -> None:
        """Nothing more of the run is kept for `resume`."""
