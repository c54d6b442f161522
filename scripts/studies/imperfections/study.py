"""Study of imperfections: which blocks of the 21-block wall are (a) and (b) of thesis 5.4? Every block tried."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from studies.imperfections import low_blocks, tables
from studies.imperfections.pictures import draw, walls
from studies.places import DOCS
from studies.study import StudyRunner


class ImperfectionStudy(StudyRunner):
    """One section: a row per wall."""

    def measure(self, section: str, options: argparse.Namespace) -> list[dict[str, Any]]:
        rows = []
        for row in low_blocks.runs():
            rows.append(row)
            print(tables.line(row), flush=True)
        return rows

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"no answer: {tables.line(row)}" for row in found if tables.gave_up(row)]


def draw_both(rows: Any, path: Path) -> None:
    """The picture of the page, and that of case_imperfections.md."""
    draw(rows, path)
    walls(DOCS / "case_imperfections.png")


STUDY = ImperfectionStudy(
    "imperfections",
    "The 21-block wall with one block too low",
    {"rows": low_blocks.runs},
    tables.values,
    {"": ("rows", draw_both)},
    machine=True,
)
