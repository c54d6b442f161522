"""Ports of a run: the observer to whom a solver reports, and the stages at which it may be kept for `--resume`.

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
tells the results is told again. A stage may have others inside: these are kept until it is finished, or offers to go on
behind them. Here nothing is kept; results/output/resume/stages.py keeps them on disk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.frames import Frame
    from dem_cli.core.records.history_rows import HistoryRow, RunRow, Samples

Found = TypeVar("Found")
Given = ParamSpec("Given")


class Stages:
    """Stages of a run of which nothing is kept; all of them are done."""

    before = 0.0  # s of work before this run, whose stages it goes on from

    def done(self, name: str, arguments: tuple[Any, ...], work: Callable[[], Found]) -> Found:
        """What a stage gives: by work, or as it was kept."""
        return work()

    def resumed(self, loop: Any = None) -> bool:
        """Whether the stage under way goes on from a checkpoint: then all it changes and its loop are as they were."""
        return False

    def offer(self, loop: Any = None) -> None:
        """The stage under way may go on from here; loop: an object with all that it needs besides what it changes."""

    def __deepcopy__(self, known: dict[int, Any]) -> Stages:
        return self


NOTHING_KEPT = Stages()


def stage(work: Callable[Given, Found]) -> Callable[Given, Found]:
    """A function as a stage of the run of its first argument: a simulation, or what has one as `sim`."""

    @wraps(work)
    def kept(*arguments: Given.args, **named: Given.kwargs) -> Found:
        first: Any = arguments[0]
        stages: Stages = getattr(first, "sim", first).stages
        return stages.done(work.__qualname__, (*arguments, *named.values()), partial(work, *arguments, **named))

    return kept


class Observer:
    """Observer of a run: who a solver reports to. This one does nothing; all return at once and change no state.

    stages  keeps the stages of the run for `--resume`
    """

    stages: Stages = NOTHING_KEPT

    def frame(self, frame: Frame) -> None:
        """A snapshot to keep."""

    def row(self, row: HistoryRow) -> None:
        """A row of the history to keep."""

    def samples(self, samples: Samples) -> None:
        """A stretch of a time history to keep; follows the one before."""

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Where the run stands; `fraction` of the stage that is done, None where nobody can tell."""

    def structure(self, model: Model) -> None:
        """The structure that all frames show, where it is another one than that of the case; before any of them."""

    def runs(self, rows: Sequence[RunRow]) -> None:
        """All runs of an analysis that consists of many, at its end."""
