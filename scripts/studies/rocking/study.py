"""Study of rocking: blocks that rock, slide and bounce, compared with exact motions (tests/oracle)."""

from __future__ import annotations

import argparse
from typing import Any

from studies.rocking import comparisons, pictures, tables
from studies.study import StudyRunner


class RockingStudy(StudyRunner):
    """One section per comparison."""

    def measure(self, section: str, options: argparse.Namespace) -> list[Any]:
        rows = []
        for row in self.sections[section]():
            rows.append(row)
            if section != "pairs":
                print(f"{section}: {row}", flush=True)
        return rows

    def said(self, section: str, found: Any) -> str:
        return f"{section}: {len(found)} rows"


STUDY = RockingStudy(
    "rocking",
    "Blocks that rock, slide and bounce, against exact motions",
    comparisons.PARTS,
    tables.values,
    {
        "free": ("free", pictures.draw_swings),
        "pulses": ("bounds", pictures.draw_bounds),
        "pairs": ("pairs", pictures.draw_pairs),
    },
    machine=True,
)
