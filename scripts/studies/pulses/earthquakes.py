"""The arch of 17 voussoirs under artificial earthquakes: which peaks to expect of one that fits Eurocode 8."""

from __future__ import annotations

from typing import Any

from dem_cli.case.tables.base_motion import ArtificialTable
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.synthetic import suite
from studies.pulses import voussoirs
from studies.pulses.domain import Shaker, changed, table_of

RECORDS, LENGTH, MARGIN = 7, 15.0, 0.5  # -, s, -
PEAKS = {"eq10": 0.10, "eq20": 0.20}  # g
GRAVITY = 10.0
SUITE = {
    "kind": "artificial", "spectrum": "EC8-2", "soil": "A", "ag": 1.7, "duration": LENGTH, "plateau": 10.0,
    "count": RECORDS,
}  # fmt: skip


def study() -> dict[str, Any]:
    """Peaks of the crown against the base [m], by record, strength and damping; None: it fell."""
    motions = [Motion(record) for record in suite(ArtificialTable(**SUITE).asked, 1)]
    found: dict[str, Any] = {}
    for series, damping in (("s5", None), ("mx5", voussoirs.MAXWELL)):
        case = table_of(voussoirs.CASE)
        shaker = Shaker(changed(case, output={"frames": 0}), damping or case["damping"], 0.0, MARGIN, case["monitor"])
        for name, peak in PEAKS.items():
            runs = [shaker.run([motion.scaled(peak * GRAVITY / motion.peak)]) for motion in motions]
            found[f"{name}_{series}"] = [None if run.collapsed else run.peaks[0] for run in runs]
            print(f"arch of 17, {name}_{series}: {found[f'{name}_{series}']}")
    return found
