"""The tapered column of Dimitri, De Lorenzis and Zavarise: static load and overturning domains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from oracle import tapered_column as monolith

from studies.bisection import bisect_ratio
from studies.pulses import domain
from studies.rocking.single_block import solve

CASE = "dimitri_column"
ALL = (0.1, 0.15, 0.2, 0.25, 0.3, 0.31, 0.32, 0.33, 0.34, 0.35, 0.36, 0.37, 0.38, 0.39, 0.4, 0.45, 0.5, 0.6, 0.8, 1.0)
FEW = (0.1, 0.2, 0.3, 0.32, 0.33, 0.34, 0.36, 0.4, 0.6)  # of other dampings [s]
NEAR, FAR_BEYOND = (0.3, 0.37), 2.2  # durations at which it stands again above the least amplitude, tried up to there
LASTS, MARGIN = 5.0, 0.5
MAIN = "0.35 of critical"
FINE, FINE_AT = 0.15, (0.2, 0.3, 0.34, 0.4)  # margin and durations of a check of the time step
BELOW, SHORT = 0.8, 2.0  # scans begin at this part of the least amplitude of the rigid block; or there [g]
STATIC = {"kind": "pushover", "direction": [1.0, 0.0], "pattern": "mass", "resolution": 0.002, "limit": True}


def static(case: str = CASE, **joint: Any) -> dict[str, Any]:
    """Bracket of the explicit solver [g], and rigid-block limit analysis; joint: other keys of [joints.dry]."""
    made = domain.changed(domain.table_of(case), motion=None, damping=None, monitor=None) | {"analysis": STATIC}
    made["joints"] = {"dry": {**made["joints"]["dry"], **joint}}
    summary = solve(made).summary
    limit = summary["limit_analysis"]
    return {"bracket": [float(load) for load in summary["failure_load_bracket"]], "limit": limit}


def rigid() -> list[dict[str, Any]]:
    """The column as one rigid block."""
    return [domain.scanned(monolith.falls, tp, beyond=_beyond(tp)) for tp in ALL]


def main_domain() -> list[dict[str, Any]]:
    return _domain(MAIN, ALL)


def others() -> dict[str, list[dict[str, Any]]]:
    """Domains of the other dampings."""
    return {name: _domain(name, FEW) for name in domain.DAMPINGS if name != MAIN}


def _domain(name: str, durations: Sequence[float]) -> list[dict[str, Any]]:
    """Least amplitudes by duration, answers along the grid, the way of the fall."""
    case, damping, rows = domain.table_of(CASE), domain.DAMPINGS[name], []
    shaker = domain.Shaker(case, damping, LASTS, MARGIN)
    for tp in durations:
        least = domain.scanned(monolith.falls, tp, beyond=1.0)["least"]
        row = domain.scanned(shaker.falls, tp, BELOW * least if least else SHORT, _beyond(tp))
        row["fall"] = domain.way_of_falling(case, damping, row["least"], tp, MARGIN) if row["least"] else None
        rows.append(row)
        said = f"{row['least']:.4f} g" if row["least"] else "–"
        print(f"column, {name}: tp {tp:g} s, {said}, {row['fall']}, {shaker.runs} runs, {shaker.seconds:.0f} s of CPU")
    return rows


def fine() -> list[dict[str, Any]]:
    """Bounds with another time step, near those with MARGIN; None where farther away than a step of the grid."""
    coarse, made = (
        domain.Shaker(domain.table_of(CASE), domain.DAMPINGS[MAIN], LASTS, margin) for margin in (MARGIN, FINE)
    )
    rows = []
    for tp in FINE_AT:
        least = domain.scanned(monolith.falls, tp, beyond=1.0)["least"]
        first = domain.scanned(coarse.falls, tp, BELOW * least if least else SHORT, 1.0)["least"]
        low, high = first / domain.RATIO, first * domain.RATIO
        same = not made.falls(low, tp) and made.falls(high, tp)
        second = bisect_ratio(low, high, domain.TOLERANCE, lambda a, tp=tp: made.falls(a, tp))[1] if same else None
        rows.append({"tp": tp, "coarse": first, "fine": second})
        print(f"column: {rows[-1]}")
    return rows


def _beyond(tp: float) -> float:
    return FAR_BEYOND if NEAR[0] <= tp <= NEAR[1] else domain.BEYOND
