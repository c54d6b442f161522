"""Case job: a job that knows its case as well, for analyses that read more of it than solvers are asked for."""

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
    """One run of a case."""

    LASTING: ClassVar[frozenset[str]] = Job.LASTING | {"case"}
    case: Case

    @classmethod
    def of_case(cls, case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> CaseJob:
        """A job that reports to `observer`."""
        job = Job.start(solver_request(case), model, observer, settings)
        return cls(job.request, model, job.clock, job.monitors, job.budget, settings, case=case)

    def with_case(self, case: Case) -> CaseJob:
        """The same of a changed case, with its warnings, clock and budget shared."""
        return replace(self, case=case, request=solver_request(case))
