"""All analysis kinds. A new one is one file and one line here."""

from dem_cli.solve.analysis import (
    Analysis,
    CycleAnalysis,
    FragilityAnalysis,
    GravityAnalysis,
    ModesAnalysis,
    PushoverAnalysis,
    SettlementAnalysis,
    TimeHistoryAnalysis,
)
from dem_cli.solve.safety_table import SafetyAnalysis


def _gravity():
    from dem_cli.solve.gravity import run

    return run


def _pushover():
    from dem_cli.solve.pushover import run

    return run


def _cycle():
    from dem_cli.solve.cycle import run

    return run


def _settlement():
    from dem_cli.solve.settlement import run

    return run


def _safety():
    from dem_cli.solve.safety import run

    return run


def _modes():
    from dem_cli.solve.modes import run

    return run


def _time_history():
    from dem_cli.solve.repeats import run

    return run


def _fragility():
    from dem_cli.solve.fragility import run

    return run


ANALYSES: dict[str, Analysis] = {
    analysis.kind: analysis
    for analysis in (
        Analysis("pushover", PushoverAnalysis, _pushover),
        Analysis("cycle", CycleAnalysis, _cycle),
        Analysis("gravity", GravityAnalysis, _gravity),
        Analysis("settlement", SettlementAnalysis, _settlement),
        Analysis("time-history", TimeHistoryAnalysis, _time_history),
        Analysis("fragility", FragilityAnalysis, _fragility),
        Analysis("modes", ModesAnalysis, _modes),
        Analysis("safety", SafetyAnalysis, _safety),
    )
}
