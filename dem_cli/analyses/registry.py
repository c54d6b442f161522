"""Registry of the analysis kinds. A new one is one file and one line here."""

from dem_cli.case.tables.analysis import (
    Analysis,
    CycleAnalysis,
    FragilityAnalysis,
    GravityAnalysis,
    ModesAnalysis,
    PushoverAnalysis,
    SettlementAnalysis,
    TimeHistoryAnalysis,
)
from dem_cli.case.tables.safety import SafetyAnalysis


def _gravity():
    from dem_cli.analyses.gravity import run

    return run


def _pushover():
    from dem_cli.analyses import capacity_curve, pushover

    ways = {"load": pushover.run, "displacement": capacity_curve.run}  # of analysis.control
    return lambda case, *others: ways[case.analysis.control](case, *others)


def _cycle():
    from dem_cli.analyses.cycle import run

    return run


def _settlement():
    from dem_cli.analyses.settlement import run

    return run


def _safety():
    from dem_cli.analyses.safety import run

    return run


def _modes():
    from dem_cli.analyses.modes import run

    return run


def _time_history():
    from dem_cli.analyses.time_history import run

    return run


def _fragility():
    from dem_cli.analyses.fragility import run

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
