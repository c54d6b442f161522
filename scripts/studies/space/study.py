"""Study of failure loads in space: known by hand, of planar twins, of walls that meet, of published walls."""

from __future__ import annotations

import argparse
from typing import Any

from studies.places import CASES
from studies.space import measure, published, tables
from studies.space.by_hand import BY_HAND
from studies.space.walls import WALLS
from studies.study import StudyRunner

STATIC = sorted((CASES / "verification").glob("*.toml"))


class SpaceStudy(StudyRunner):
    """Four sections."""

    def said(self, section: str, found: Any) -> str:
        return f"{section}: {len(found)} structures"

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"{section}, {row['name']}: {row['status']}" for row in found if row.get("status", "ok") != "ok"]

    def measure(self, section: str, options: argparse.Namespace) -> Any:
        return self.sections[section]()


STUDY = SpaceStudy(
    "space",
    "Failure loads in space",
    {
        "by_hand": lambda: measure.by_hand(BY_HAND),
        "walls": lambda: measure.compared(WALLS),
        "twins": lambda: measure.twins(STATIC),
        "published": published.measure,
    },
    tables.values,
    machine=True,
)
