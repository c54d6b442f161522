"""Ports of a run: the observer to which a solver reports, and the stages at which `--resume` can save it.

Stages are pieces of work whose outcome is kept, and loops that may go on from the middle. A run is deterministic: begun
again it goes the same way. So what is kept is small: of each finished stage what it returned and what it left of the
objects that it changes, of the one under way a checkpoint now and then. A resumed run goes its way from the start,
takes finished stages from what was kept, and works on where nothing was.

    @stage
    def settle(sim, budget): ...            # sim.stages keeps it; sim and budget are put back as it left them

        looks = Looks()                     # an object with the few numbers of a loop
        if not sim.stages.resumed(looks):
            begin()                         # what comes before the loop
        while not done(looks):
            sim.stages.offer(looks)         # here the run may go on, from `sim`, `budget` and `looks`
            work(looks)

All that a stage changes are its arguments, or lasts in one of them (results/output/resume/kept_objects.py); what it
reports to the results is reported again. A stage may have others inside: these are kept until it is finished, or
offers to go on behind them. Here nothing is kept; results/output/resume/stages.py keeps them on disk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.certificate_record import Certificates
    from dem_cli.core.records.frames import Frame
    from dem_cli.core.records.history_rows import HistoryRow, RunRow, Samples

Found = TypeVar("Found")
Given = ParamSpec("Given")


class Stages:
    """Stages of a run without checkpoints; all of them are computed."""

    before = 0.0  # s of work before this run, whose stages it goes on from

    def done(self, name: str, arguments: tuple[Any, ...], work: Callable[[], Found]) -> Found:
        """Return the result of a stage: computed by `work`, or as it was stored."""
        return work()

    def resumed(self, loop: Any = None) -> bool:
        """Test whether the current stage resumes from a checkpoint: then all it changes and its loop are as they
        were."""
        return False

    def offer(self, loop: Any = None) -> None:
        """Offer a checkpoint from which the current stage may resume; loop: an object with all else that it needs."""

    def __deepcopy__(self, known: dict[int, Any]) -> Stages:
        return self


NOTHING_KEPT = Stages()


def stage(work: Callable[Given, Found]) -> Callable[Given, Found]:
    """Decorate a function as a stage of the run of its first argument: a simulation, or an object with one as
    `sim`."""

    @wraps(work)
    def kept(*arguments: Given.args, **named: Given.kwargs) -> Found:
        first: Any = arguments[0]
        stages: Stages = getattr(first, "sim", first).stages
        return stages.done(work.__qualname__, (*arguments, *named.values()), partial(work, *arguments, **named))

    return kept


class Observer:
    """Observer of a run, to which a solver reports. This one does nothing; all return at once and change no state.

    stages  keeps the stages of the run for `--resume`
    """

    stages: Stages = NOTHING_KEPT

    def frame(self, frame: Frame) -> None:
        """Receive a snapshot to store."""

    def row(self, row: HistoryRow) -> None:
        """Receive a row of the history to store."""

    def samples(self, samples: Samples) -> None:
        """Receive a stretch of a time history to store; follows the one before."""

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Receive the progress of the run; `fraction` of the stage that is done, None where unknown."""

    def certificates(self, found: Certificates) -> None:
        """Receive the certificates of what a pushover claims, at its end."""

    def structure(self, model: Model) -> None:
        """Receive the structure that all frames show, where it differs from the given one; before any of them."""

    def runs(self, rows: Sequence[RunRow]) -> None:
        """Receive all runs of an analysis that consists of many, at its end."""
