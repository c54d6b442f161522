"""Run the analysis that a case names, from a model to an outcome."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.analyses.registry import ANALYSES
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer

if TYPE_CHECKING:
    from dem_cli.analyses.ensembles.batch import Batch
    from dem_cli.case.schema import Case


def solve(
    case: Case, model: Model, observer: Observer, batch: Batch | None = None, settings: Settings = DEFAULT
) -> Outcome:
    """Run the analysis that a case names. Raises SolverError where the solver gives up.

    batch: how to do the runs of an analysis that consists of many; settings: those that differ from the default are
    named in the summary.
    """
    run = ANALYSES[case.analysis.kind].load()
    outcome = run(case, model, observer, settings, *([] if batch is None else [batch]))
    if changed := settings.changed():
        outcome.summary["settings"] = changed
    return outcome
