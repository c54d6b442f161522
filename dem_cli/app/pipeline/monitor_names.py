"""Names of monitors, and a check that each [reference] to one exists."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dem_cli.analysis_kinds import kind_of
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.case.schema import Case, Monitor


def monitor_names(monitors: Sequence[Monitor]) -> list[str]:
    """Return a unique name for each monitor, such as "top-right displacement x"."""
    from dem_cli.results.output.distinct_names import distinct

    def told(monitor: Monitor) -> str:
        words = (monitor.place, "absolute" if monitor.absolute else "", monitor.quantity, monitor.component)
        return monitor.name or " ".join(filter(None, words))

    return distinct(map(told, monitors))


def monitor_quantities(monitors: Sequence[Monitor]) -> list[str]:
    """Return the quantity of each monitor, a key of results/output/series.py: UNITS."""
    return [("absolute " if monitor.absolute else "") + monitor.quantity for monitor in monitors]


def check_quantities(case: Case, names: Sequence[str]) -> None:
    """Raise CaseError for a [reference] to a monitor that the case lacks: before a long run, not after.

    names: of the monitors. All other quantities are known only when there is a summary.
    """
    from dem_cli.case.wording import unknown_name
    from dem_cli.results.output.equilibrium_monitors import PARTS

    if kind_of(case.analysis.kind).timed:
        from dem_cli.results.output.series import Peak

        known = [f"peaks.{name}.{part}" for name in names for part in (*Peak._fields, "unit")]
    elif kind_of(case.analysis.kind).rests:
        known = [f"monitors.{name}.{part}" for name in names for part in PARTS]
    else:
        return
    asked = [(i, one.path) for i, one in enumerate(case.reference) if one.path.split(".")[0] in ("peaks", "monitors")]
    problems = [
        CaseProblem(("reference", i, "quantity"), unknown_name("quantity", path, known))
        for i, path in asked
        if path not in known
    ]
    if problems:
        raise CaseError(problems)
