"""Case job: a job with its case, for analyses that read more of it than the solver request."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from dem_cli.core.engine.job import Job
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.ports import Observer


@dataclass(kw_only=True)
class CaseJob(Job):
    """Run of a case with its clock, budget and warnings."""

    LASTING: ClassVar[frozenset[str]] = Job.LASTING | {"case"}
    case: Case

    @classmethod
    def of_case(cls, case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> CaseJob:
        """Create the job of a case that reports to `observer`."""
        job = Job.start(solver_request(case), model, observer, settings)
        return cls(job.request, model, job.clock, job.monitors, job.budget, settings, case=case)

    def with_case(self, case: Case) -> CaseJob:
        """Return the job with a changed case; warnings, clock and budget are shared."""
        return replace(self, case=case, request=solver_request(case))
