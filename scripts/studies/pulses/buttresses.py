"""The arch on buttresses of Dimitri, De Lorenzis and Zavarise: static load, and our domain (none is published)."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.bisection import bisect_ratio
from studies.pulses import column, domain

CASE = "dimitri_arch"
DURATIONS = (0.5, 1.0, 2.0)
LASTS, MARGIN = 12.0, 0.5
LOWEST, RATIO, HIGHEST = 0.12, 1.1, 8.0  # g, -, g


def study() -> dict[str, Any]:
    """Static bracket and least amplitudes of two dampings."""
    case, rows = domain.table_of(CASE), []
    for name in ("0.35 of critical", "none"):
        shaker = domain.Shaker(case, domain.DAMPINGS[name], LASTS, MARGIN)
        for tp in DURATIONS:
            rows.append({"damping": name, "tp": tp, "least": _least(shaker, tp)})
            print(f"arch on buttresses, {name}: tp {tp:g} s, {rows[-1]['least']} g, {shaker.seconds:.0f} s of CPU")
    return {"static": column.static(CASE), "rows": rows}


def _least(shaker: domain.Shaker, tp: float) -> float | None:
    """Along a coarse grid from below, then bisected."""
    low = LOWEST
    for high in (LOWEST * RATIO ** np.arange(1, int(np.log(HIGHEST / LOWEST) / np.log(RATIO)))).tolist():
        if shaker.falls(high, tp):
            return bisect_ratio(low, high, domain.TOLERANCE, lambda a: shaker.falls(a, tp))[1]
        low = high
    return None
