"""Study of bounds: every case lies between its lower bound and its associated load, and above its least load."""

from __future__ import annotations

import argparse
from typing import Any

from studies.bounds import tables
from studies.bounds.measure import measure
from studies.places import CASES
from studies.study import StudyRunner

NAMES = (
    "sliding_block", "stepped_column", "column_14", "trilith", "portal", "arch_on_buttresses", "arch_21_mu040",
    "arch_segmental_mu050", "arch_coursed_buttresses_mu030", "arch_coursed_buttresses_mu050", "stack_bond_mu030",
    "stack_bond_mu060", "wall_21", "wall_21_mu065", "wall_21_mu075", "wall_with_door", "point_loads_mu060",
    "cohesion_block", "tension_block", "crushing_block", "crushing_toe",
)  # fmt: skip


class BoundStudy(StudyRunner):
    """One section per case."""

    parts = "CASE"

    def measure(self, section: str, options: argparse.Namespace) -> dict[str, Any]:
        return measure(self.sections[section])

    def said(self, section: str, found: Any) -> str:
        return " | ".join(tables.cells(found))

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"{section}: {text}" for text in tables.problems(found)]


STUDY = BoundStudy(
    "bounds",
    "Bounds of joints that do not dilate, beside DEM",
    {name: CASES / "verification" / f"{name}.toml" for name in NAMES},
    tables.values,
    machine=True,
)
