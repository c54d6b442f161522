"""Search of collapse intensities: records, their intensity, and the next intensity of a bisection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.analyses.ensembles.batch import Answer, ShakingTrial, Task
from dem_cli.core.records.statuses import MOVES
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.masonry.assembly.ground_motions import suites_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.tables.analysis import FragilityAnalysis
    from dem_cli.core.motion.motion import Motion


class GroundRecord(NamedTuple):
    """Ground motion record: one motion, or the components of one event, which are scaled together."""

    name: str
    components: tuple[Motion, ...]

    @property
    def peak(self) -> float:
        """Peak acceleration of the strongest component [m/s²]."""
        return max(motion.peak for motion in self.components)


def records_of(case: Case) -> list[GroundRecord]:
    """Collect every record of every [[motion]], those of one event together, in the order of their first tables.

    Raises CaseError where there is none, one that does not move, or an event with suites of different length.
    """
    events: dict[tuple[str, int], list[tuple[int, list[Motion]]]] = {}
    tables = [(i, table) for i, table in enumerate(case.motion) if table.kind != "none"]
    for (i, table), suite in zip(tables, suites_of(case), strict=True):
        events.setdefault((table.event or "", 0 if table.event else i + 1), []).append((i, suite))
    if not events:
        message = "missing; kind = 'fragility' needs a [[motion]]: its set of records"
        raise CaseError([CaseProblem(("motion",), message)])
    found = []
    for (event, _), parts in events.items():
        _check_lengths(event, parts)
        for k, components in enumerate(zip(*(suite for _, suite in parts), strict=True)):
            name = (event if len(parts[0][1]) == 1 else f"{event} {k + 1}") if event else components[0].name
            found.append(GroundRecord(name, components))
    return found


def _check_lengths(event: str, parts: Sequence[tuple[int, list[Motion]]]) -> None:
    """Raise CaseError where tables of an event have different numbers of records."""
    first = len(parts[0][1])
    for i, suite in parts[1:]:
        if len(suite) != first:
            message = f"'{event}' has {first} record(s) in motion.{parts[0][0]} and {len(suite)} here"
            raise CaseError([CaseProblem(("motion", i, "event"), message)])


def scaled(record: GroundRecord, intensity: float, analysis: FragilityAnalysis) -> list[Motion]:
    """Scale the components of a record to the peak acceleration of an intensity."""
    factor = intensity * analysis.unit_acceleration / record.peak
    return [motion.scaled(factor) for motion in record.components]


def runs_per_record(analysis: FragilityAnalysis) -> int:
    """Return the largest number of runs per record."""
    if not analysis.bisects:
        return len(analysis.levels)
    if analysis.intensities is not None:
        return math.ceil(math.log2(len(analysis.levels) + 1))
    lowest, highest, resolution = analysis.range
    return 2 + math.ceil(math.log2((highest - lowest) / resolution) - 1e-9)


def bisection(analysis: FragilityAnalysis, structure: int, record: int) -> Task:
    """Bisect the collapse intensity of a record: a task that asks for one run after the other."""

    def falls(answer: Answer, intensity: float) -> bool | None:
        run = answer(ShakingTrial(structure, record, intensity))
        return False if run.ending == MOVES else run.collapsed  # what is not known bounds nothing: looked for above it

    def among_levels(answer: Answer) -> None:
        low, high = -1, len(analysis.levels)
        while high - low > 1:
            middle = (low + high) // 2
            fell = falls(answer, analysis.levels[middle])
            if fell is None:
                return
            low, high = (low, middle) if fell else (middle, high)

    def between(answer: Answer) -> None:
        low, high, _ = analysis.range
        if not falls(answer, high) or falls(answer, low) is not False:
            return
        for _ in range(runs_per_record(analysis) - 2):
            middle = 0.5 * (low + high)
            fell = falls(answer, middle)
            if fell is None:
                return
            low, high = (low, middle) if fell else (middle, high)

    return between if analysis.intensities is None else among_levels
