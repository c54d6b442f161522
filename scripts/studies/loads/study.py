"""Study of failure loads: every pushover case by limit analysis and by DEM, which must agree (criteria.py)."""

from __future__ import annotations

import argparse
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studies.loads import tables
from studies.loads.criteria import problems
from studies.loads.methods import CaseLoads, measure
from studies.places import CASES
from studies.study import StudyRunner

FOLDERS = (CASES / "verification", CASES / "gallery")


def pushovers() -> list[Path]:
    """Plane cases that look for a failure load with joints that limit analysis knows, and no gap that may close."""
    files = [file for folder in FOLDERS for file in sorted(folder.glob("*.toml"))]
    tables = {file: tomllib.loads(file.read_text(encoding="utf-8")) for file in files}
    kinds = {file: tables[file]["analysis"].get("kind", "pushover") for file in files}
    plane = [file for file in files if tables[file].get("dimension", 2) == 2]  # in space: the study of that name
    return [file for file in plane if kinds[file] == "pushover" and known(tables[file])]


def known(tables: dict[str, Any]) -> bool:
    """Whether all joints are Coulomb's and closed: limit analysis has no other law, and knows the drawing alone.

    Not where displacement is controlled: such cases are about their curves. The path knows no ties and bars.
    """
    if tables["analysis"].get("control") == "displacement":
        return False
    coulomb = all(joint.get("law", "coulomb") == "coulomb" for joint in tables["joints"].values())
    return coulomb and not {"imperfection", "tie", "reinforcement"} & set(tables)


def name_of(file: Path) -> str:
    """As in the table: folder and stem."""
    return f"{file.parent.name}/{file.stem}"


class LoadStudy(StudyRunner):
    """One section per case; DEM within 1 % of the zero-dilation path, none above the associated load by 0.5 %."""

    parts = "CASE"

    def measure(self, section: str, options: argparse.Namespace) -> dict[str, Any]:
        return asdict(measure(self.sections[section]))

    def said(self, section: str, found: Any) -> str:
        return " | ".join(tables.loads_of(CaseLoads.read(found)))

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"{section}: {text}" for text in problems(CaseLoads.read(found))]


STUDY = LoadStudy(
    "loads",
    "Failure loads by limit analysis and by DEM",
    {name_of(file): file for file in sorted(pushovers(), key=name_of)},
    tables.values,
    machine=True,
)
