"""A kind of analysis by the recipe: the weight of what stands, once it is at rest."""

from __future__ import annotations

from recipes import Recipe

TABLE = '''class WeightAnalysis(AnalysisBase):
    """[analysis] with kind = "weight": what do the blocks weigh that come to rest?"""

    kind: Literal["weight"] = "weight"


class LiveAnalysis(AnalysisBase):
'''

RUN = '''"""kind = "weight": what do the blocks weigh that come to rest?"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import FALLS
from dem_cli.core.statics.equilibrium import settle

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome with the weight of the free blocks [N]."""
    job = CaseJob.of_case(case, model, observer, settings)
    sim = job.first_simulation()
    track = job.track(sim)
    status = "ok" if settle(sim, track, job.budget).state == "equilibrium" else FALLS
    track.flush()
    return job.outcome([sim], {"status": status, "weight": -float(model.dead_loads[~model.fixed, 1].sum())})
'''

LOADER = """def _weight():
    from dem_cli.analyses.weight import run

    return run


ANALYSES: dict[str, Analysis] = {
"""

ANSWER = """def _weight(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    return ("weight", f"{summary['weight']:.4g} N", "at rest") if "weight" in summary else _status(summary)


def _limit(summary"""

ROWS = "    rows += [*curve_rows(summary), *safety_rows(summary)]\n"
LINE = """    rows += [("weight", f"{summary['weight']:.4g} N")] if "weight" in summary else []\n"""
REGISTRY, FIRST = "dem_cli/analyses/registry.py", "    for analysis in (\n"
FACTS = "dem_cli/results/report/facts.py"

RECIPE = Recipe(
    section="Add a kind of analysis",
    name="weight",
    files={"dem_cli/analyses/weight.py": RUN},
    lines=(
        ("dem_cli/case/tables/analysis.py", "class LiveAnalysis(AnalysisBase):\n", TABLE),
        (REGISTRY, "    TimeHistoryAnalysis,\n)", "    TimeHistoryAnalysis,\n    WeightAnalysis,\n)"),
        (REGISTRY, "ANALYSES: dict[str, Analysis] = {\n", LOADER),
        (REGISTRY, FIRST, f'{FIRST}        Analysis("weight", WeightAnalysis, _weight),\n'),
        ("dem_cli/app/cli/words/console.py", ROWS, ROWS + LINE),
        (
            "dem_cli/analysis_kinds.py",
            '    "safety": AnalysisKind(',
            '    "weight": AnalysisKind("Weight", rests=True),\n    "safety": AnalysisKind(',
        ),
        (FACTS, "_ANSWERS = {\n", '_ANSWERS = {\n    "weight": _weight,\n'),
        (FACTS, "def _limit(summary", ANSWER),
        ("dem_cli/results/output/summary.py", '    "vary",\n', '    "weight",\n    "vary",\n'),
        ("dem_cli/analyses/estimate_cost.py", "STEPS = {", 'STEPS = {"weight": (500, 50_000),'),
        ("dem_cli/case/explain.py", "DOC_PAGES = {", 'DOC_PAGES = {"analysis.weight": "docs/numerics.md",'),
        ("docs/glossary.md", "`gravity`, `cycle`,", "`gravity`, `weight`, `cycle`,"),
    ),
    commands=(("scripts/draw_tree",), ("scripts/docs", "--write")),
    tests=(
        "tests/house/test_imports.py::test_only_the_arrows_of_the_house[analyses.weight]", "tests/house/test_kinds.py",
    ),
    left_out=(
        "dem_cli/core/records/frames.py", "dem_cli/core/records/ports.py",
    ),
)  # fmt: skip
