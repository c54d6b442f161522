"""Study of paper 001: walls of three kinds, the statistics of coursed ones, the stone house."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from functools import partial
from typing import Any

from studies.paper001 import house, statistics, walls
from studies.study import StudyRunner


class PaperStudy(StudyRunner):
    """Sections that are measured one by one and shown together."""

    def said(self, section: str, found: Any) -> str:
        return f"{section}: {len(found)} runs"

    def measure(self, section: str, options: argparse.Namespace) -> Any:
        return self.sections[section]()


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    return walls.values(found) | statistics.values(found) | house.values(found)


STUDY = PaperStudy(
    "paper001",
    "Paper 001: walls of many patterns, a stone house",
    {kind: partial(walls.measure, kind) for kind in walls.FILES}
    | {"statistics": statistics.measure, "house": house.measure},
    values,
    pictures={"curves": ("", walls.draw_curves), "statistics": ("statistics", statistics.draw_statistics)},
    machine=True,
)
