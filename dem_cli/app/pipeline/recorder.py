"""Observer of a run that writes all results to files, and forwards progress to the listener."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from dem_cli.core.records.ports import Observer
from dem_cli.interrupts import look
from dem_cli.results.output.resume.kept_values import Damaged

if TYPE_CHECKING:
    from dem_cli.app.pipeline.listener import RunListener
    from dem_cli.core.contact.drawn_joints import DrawnJoints
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.certificate_record import Certificates
    from dem_cli.core.records.frames import Frame
    from dem_cli.core.records.history_rows import HistoryRow, RunRow, Samples
    from dem_cli.results.output.resume.stages import KeptStages
    from dem_cli.results.output.store import ResultWriter


def joints_of(model: Model) -> DrawnJoints:
    """Create the joints of a structure as drawn, on first use since that is compiled."""
    from dem_cli.core.contact.drawn_joints import DrawnJoints

    return DrawnJoints(model)


TOLD = {  # records that are written to the files, by kind, and their classes
    "frame": "Frame", "row": "HistoryRow", "samples": "Samples", "structure": "Model", "runs": "RunRow",
}  # fmt: skip


class Recorder(Observer):
    """Observer of a run: stores results, and forwards progress."""

    def __init__(self, writer: ResultWriter, listener: RunListener):
        self.writer, self.listener = writer, listener
        self._noted: KeptStages | None = None
        self._last: tuple[str, float, float, float | None] | None = None  # of what was said of the progress

    def keep(self, stages: KeptStages) -> None:
        """Send all further output to the stages as well, for a run that is resumed."""
        self.stages = self._noted = stages
        stages.goes_on, stages.gives_up = self.goes_on, self.listener.stages_not_kept

    def tell(self, kind: str, record: Any) -> None:
        """Write output to the files: a "frame", "row", "samples", "structure" or "runs"."""
        getattr(self.writer, kind)(record)

    def tell_again(self, kind: str, record: Any) -> None:
        """Write output of an interrupted run to the files. Raises Damaged where it is of no known kind."""
        each = record if kind == "runs" and isinstance(record, (list, tuple)) else (record,)
        if not all(type(one).__name__ == TOLD.get(kind) for one in each):
            raise Damaged(f"the results are told a {type(record).__name__}")
        self.tell(kind, record)

    def _tell(self, kind: str, record: Any) -> None:
        self.tell(kind, record)
        if self._noted is not None:
            self._noted.note(kind, record)

    def frame(self, frame: Frame) -> None:
        """Write a frame to the files."""
        self._tell("frame", frame)

    def row(self, row: HistoryRow) -> None:
        """Write a history row to the files."""
        self._tell("row", row)

    def samples(self, samples: Samples) -> None:
        """Write samples of a time history to the files."""
        self._tell("samples", samples)

    def certificates(self, found: Certificates) -> None:
        """Write certificates to the files; a run that is resumed makes them anew."""
        self.writer.certificates(found)

    def structure(self, model: Model) -> None:
        """Write the structure of the frames to come."""
        self._tell("structure", model)

    def runs(self, rows: Sequence[RunRow]) -> None:
        """Write the table of many runs."""
        self._tell("runs", rows)

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Forward the progress to the listener. Raises KeyboardInterrupt where one came."""
        self._last = stage, load, displacement, fraction
        self.listener.progress(*self._last)
        look()

    def goes_on(self) -> None:
        """Repeat the last progress, so that its elapsed time is updated."""
        if self._last is not None:
            self.listener.progress(*self._last)
