"""Search of collapse intensities: the records, how strong they are, and where a bisection looks next."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dem_cli.ensembles.batch import Answer, ShakingTrial, Task
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.motion.ground_motions import suites_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.motion.motion import Motion
    from dem_cli.tables.analysis import FragilityAnalysis


def records_of(case: Case) -> list[Motion]:
    """Every record of every [[motion]]. Raises CaseError where there is none, or one that does not move."""
    records = [motion for suite in suites_of(case) for motion in suite]
    if not records:
        message = "missing; kind = 'fragility' needs a [[motion]]: its set of records"
        raise CaseError([CaseProblem(("motion",), message)])
    return records


def scaled(record: Motion, intensity: float, analysis: FragilityAnalysis) -> Motion:
    """A record with the peak acceleration of an intensity."""
    return record.scaled(intensity * analysis.unit_acceleration / record.peak)


def runs_per_record(analysis: FragilityAnalysis) -> int:
    """How many runs a record takes at most."""
    if not analysis.bisects:
        return len(analysis.levels)
    if analysis.intensities is not None:
        return math.ceil(math.log2(len(analysis.levels) + 1))
    lowest, highest, resolution = analysis.range
    return 2 + math.ceil(math.log2((highest - lowest) / resolution) - 1e-9)


def bisection(analysis: FragilityAnalysis, structure: int, record: int) -> Task:
    """A task that finds an intensity survived and a higher one that was not, next to each other."""

    def falls(answer: Answer, intensity: float) -> bool | None:
        return answer(ShakingTrial(structure, record, intensity)).collapsed

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
